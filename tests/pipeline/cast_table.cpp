#include "tests/pipeline/cast_table.h"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <utility>

#include "tests/pipeline/sway_and_twist.h"
#include "tests/pipeline/walk_steps.h"

namespace vivify::testing_support {
namespace {

constexpr double kNear = 0.2;       // of its width: how far from a place is there
constexpr double kStay = 0.5;       // s at the end in which it stays there
constexpr double kMostTilt = 45;    // °
constexpr double kMostAstray = 15;  // °, of a heading
constexpr double kAtRest = 0.1;     // m/s
constexpr double kHop = 0.1;        // s in the air

template <class... Values>
std::string words(const char* format, Values... values) {
  char text[200];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

// It looks ahead, and rounds the corners.
std::string sphere_misses(const SceneResult& run) {
  for (const Eigen::Vector3d& place : {Eigen::Vector3d(0.4, 0, -2.2), Eigen::Vector3d(-0.5, 0, -1)}) {
    double nearest = INFINITY;
    for (const std::size_t row : run.rows("sphere"))
      nearest = std::min(nearest, level_distance(run.centre(row), place));
    if (nearest > 0.3) return words("passes a way-point by %.2f m", nearest);
  }
  const double rise = run.end("sphere").y() - run.start("sphere").y();
  if (std::abs(rise - 2 * std::tan(10 * std::numbers::pi / 180)) > 0.08)
    return words("rises by %.2f m", rise);
  const double speed = run.velocity(run.rows("sphere").back()).norm();
  return speed > kAtRest ? words("ends at %.2f m/s", speed) : "";
}

std::string espresso_misses(const SceneResult& run) {
  const int espresso = flights_of(run, "espresso"), mug = flights_of(run, "mug");
  return espresso > mug ? "" : words("hops %d times, the mug %d times", espresso, mug);
}

// On the way he looks ahead; then he bows, and looks back at the end.
std::string ace_misses(const SceneResult& run) {
  const std::vector<RowMatrixXd> motion = run.motion("ace");
  const std::vector<std::size_t>& rows = run.rows("ace");
  const auto held = std::find_if(rows.begin(), rows.end(),
                                 [&](std::size_t row) { return run.steps().text("phase", row) == "hold"; });
  if (held == rows.end()) return "does not bow";
  const std::size_t shown = static_cast<std::size_t>(held - rows.begin()) * motion.size() / rows.size();
  Eigen::Index head;
  const double height = motion.front().col(1).maxCoeff(&head);
  const double bowed = height - motion[shown](head, 1);
  if (bowed < 0.08) return words("bows by %.2f m", bowed);
  const int bow = static_cast<int>(shown) + 1, last = static_cast<int>(motion.size());  // frames, from 1
  const double before = turn_deg(run, "ace", 1, bow), turn = turn_deg(run, "ace", 1, last);
  if (std::abs(before) > kMostAstray) return words("is turned by %.0f deg on the way", before);
  if (std::abs(std::abs(turn) - 180) > 30) return words("turns by %.0f deg in its trick", turn);
  return run.velocity(rows.back()).norm() > kAtRest ? "does not stand at the end" : "";
}

std::string dark_misses(const SceneResult& run) {
  const double dark = sway_deg(run, "dark"), light = sway_deg(run, "light");
  return dark >= 3 && dark >= 1.5 * light ? "" : words("sways by %.1f deg, light by %.1f deg", dark, light);
}

std::string light_misses(const SceneResult& run) {
  const double dark = twist_deg(run, "dark"), light = twist_deg(run, "light");
  return light >= 4 && light >= 1.5 * dark ? "" : words("twists by %.1f deg, dark by %.1f deg", light, dark);
}

Role racer(const char* name, double x, std::string (*missing)(const SceneResult&)) {
  return {.scene = "crusty_race",
          .body = name,
          .gait = Gait::hop,
          .height = 0.99,
          .width = 0.807,
          .place = Eigen::Vector3d(x, 0, 1.2),
          .distance = 2.2,
          .flights = 8,
          .missing = missing,
          .course = "behavior[1].hop",
          .besides = {"behavior[0].wait.for_s=0.1"}};
}

// The place of a letter in the word, by x. The last of its behaviours, counted from 0, brings it there;
// before, it waits, and hops.
Role letter(const char* name, double place, double width, int last = 1) {
  Role role = {.scene = "letters",
               .body = name,
               .gait = Gait::hop,
               .height = 1,
               .width = width,
               .in_plane = true,
               .place = Eigen::Vector3d(place, 0, 0),
               .distance = 9,
               .flights = 8,
               .course = "behavior[" + std::to_string(last) + "].hop"};
  const std::vector<std::string> before = {"behavior[0].wait.for_s=0.2", "behavior[1].hop.to=[0.1, 0, 0]"};
  role.besides.assign(before.begin(), before.begin() + last);
  return role;
}

// One that hops onto the stage, and walks to its place.
Role walking_letter(const char* name, double place, double width) {
  constexpr int kWalk = 2;
  Role role = letter(name, place, width, kWalk);
  role.gait = Gait::walk;
  role.steps = 4;
  role.course = "behavior[" + std::to_string(kWalk) + "].walk";
  return role;
}

// Hops to the left in a style of its own.
Role figure3(const char* scene, double distance) {
  return {.scene = scene,
          .body = "letter",
          .gait = Gait::hop,
          .height = 1,
          .width = 0.56,
          .in_plane = true,
          .heading_deg = -90,
          .distance = distance,
          .flights = 4,
          .course = "controller"};
}

// It rolls on for 20 of its diameters; the board may stop it then.
Role grape(const char* name) {
  return {.scene = "cheesy",
          .body = name,
          .gait = Gait::roll,
          .height = 0.25,
          .width = 0.22,
          .distance = 20 * 0.22};
}

std::vector<Role> make_roles() {
  std::vector<Role> roles = {{.scene = "sphere",
                              .body = "sphere",
                              .gait = Gait::roll,
                              .height = 0.6,
                              .width = 0.6,
                              .place = Eigen::Vector3d(0, 0, 2),
                              .distance = 5 * 0.6,
                              .missing = sphere_misses},
                             {.scene = "tea_cups",
                              .body = "cup",
                              .gait = Gait::hop,
                              .height = 0.9,
                              .width = 1.2,
                              .place = Eigen::Vector3d(-1.1, 0, 0.2),
                              .flights = 4,
                              .course = "behavior[0].hop"},
                             {.scene = "tea_cups",
                              .body = "mug",
                              .gait = Gait::hop,
                              .height = 1.24,
                              .width = 1.2,
                              .place = Eigen::Vector3d(0.5, 0, -1.3),
                              .flights = 4,
                              .course = "behavior[1].hop"},
                             {.scene = "tea_cups",
                              .body = "espresso",
                              .gait = Gait::hop,
                              .height = 0.66,
                              .width = 1,
                              .place = Eigen::Vector3d(-2, 0, 1.7),
                              .flights = 4,
                              .missing = espresso_misses,
                              .course = "behavior[0].hop"},
                             {.scene = "cross",
                              .body = "cross",
                              .gait = Gait::hop,
                              .height = 0.993,
                              .width = 1.14,
                              .place = Eigen::Vector3d(3.9, 0, 0),
                              .distance = 6 * 0.993,
                              .flights = 10,
                              .course = "controller"},
                             {.scene = "cheesy",
                              .body = "cheesy",
                              .gait = Gait::hop,
                              .height = 0.985,
                              .width = 1.04,
                              .distance = 5 * 1.04,
                              .flights = 8,
                              .course = "behavior[0].hop",
                              .of_scene = {"colliders.board.position=[0, 0, -9]", "colliders.table.scale=2"}},
                             grape("grape1"),
                             grape("grape2"),
                             grape("grape3"),
                             grape("grape4"),
                             grape("grape5"),
                             grape("grape6"),
                             racer("dark", 0.6, dark_misses),
                             racer("light", -0.6, light_misses),
                             {.scene = "ace_cage",
                              .body = "ace",
                              .gait = Gait::walk,
                              .height = 1,
                              .width = 0.52,
                              .distance = 0.7,
                              .flights = 1,
                              .steps = 6,
                              .missing = ace_misses,
                              .course = "behavior[1].walk"},
                             {.scene = "ace_examples",
                              .body = "ace",
                              .gait = Gait::walk,
                              .height = 1,
                              .width = 0.52,
                              .distance = 0.6,
                              .flights = 3,
                              .steps = 6,
                              .missing = ace_misses,
                              .course = "behavior[1].walk"},
                             {.scene = "castle_solid",
                              .body = "castle",
                              .gait = Gait::walk,
                              .height = 1,
                              .width = 0.84,
                              .in_plane = true,
                              .place = Eigen::Vector3d(1.4, 0, 0),
                              .steps = 8,
                              .course = "controller"},
                             {.scene = "castle_rod",
                              .body = "castle",
                              .gait = Gait::walk,
                              .height = 1,
                              .width = 0.8,
                              .in_plane = true,
                              .place = Eigen::Vector3d(0.9, 0, 0),
                              .steps = 8,
                              .course = "behavior[0].walk"},
                             {.scene = "pirate",
                              .body = "pirate",
                              .gait = Gait::walk,
                              .height = 1,
                              .width = 0.76,
                              .in_plane = true,
                              .place = Eigen::Vector3d(1.2, 0, 0),
                              .steps = 10,
                              .course = "controller"},
                             letter("S", -3.93, 0.79, 0),
                             letter("I", -3.11, 0.51),
                             letter("G", -2.24, 0.97),
                             letter("G2", -1.11, 0.97),
                             walking_letter("R", 0.06, 1.08),
                             walking_letter("A", 1.38, 1.09),
                             letter("P", 2.48, 0.93),
                             walking_letter("H", 3.73, 1.17),
                             figure3("figure3_full", 1.5),
                             figure3("figure3_cage", 1.5),
                             figure3("figure3_bent", 1.2),
                             figure3("figure3_compressed", 0.5)};
  return roles;
}

}  // namespace

const std::vector<Role>& cast_roles() {
  static const std::vector<Role> roles = make_roles();
  return roles;
}

std::vector<Role> roles_in(const std::string& scene) {
  std::vector<Role> roles;
  std::copy_if(cast_roles().begin(), cast_roles().end(), std::back_inserter(roles),
               [&](const Role& role) { return scene == role.scene; });
  return roles;
}

std::vector<Errand> errands(const Role& role) {
  std::vector<Errand> list;
  if (role.course.empty()) return list;
  const auto of_body = [](const Role& whose, const std::string& setting) {
    return "bodies." + std::string(whose.body) + "." + setting;
  };
  const auto add = [&](const std::string& name, const std::string& course, double seconds, Role wanted) {
    Errand errand{name, {}, std::move(wanted)};
    const auto set = [&](const std::string& assignment) {
      errand.options.insert(errand.options.end(), {"--set", assignment});
    };
    set("frames.duration_s=" + words("%g", seconds));
    set(of_body(role, "position=[0, 0.001, 0]"));
    for (const std::string& besides : role.besides) set(of_body(role, besides));
    for (const std::string& besides : role.of_scene) set(besides);
    for (const char* other : {"heading_deg", "to", "path", "chase", "flee"})
      set(of_body(role, role.course + "." + other + "=null"));
    set(of_body(role, role.course + "." + course));
    for (const Role& other : roles_in(role.scene)) {
      if (std::string(other.body) != role.body) set(of_body(other, "spawn_s=1000"));
    }
    list.push_back(std::move(errand));
  };
  Role wanted = {.scene = role.scene,
                 .body = role.body,
                 .gait = role.gait,
                 .height = role.height,
                 .width = role.width,
                 .in_plane = role.in_plane};
  wanted.distance = 0.5 * role.height;
  const std::vector<double> all = {0, 45, 90, 135, 180, -135, -90, -45}, plane = {90, -90};
  for (const double heading : role.in_plane ? plane : all) {
    wanted.heading_deg = heading;
    add(words("heading %g", heading), words("heading_deg=%g", heading), 8, wanted);
  }
  wanted.heading_deg = {};
  wanted.distance = 0;
  const std::vector<Eigen::Vector3d> level = {{1.4, 0, 0.9}, {-1.1, 0, 1.6}, {-1.7, 0, -0.5}, {0.6, 0, -1.3}},
                                     line = {{1.1, 0, 0}, {0.7, 0, 0}, {-0.8, 0, 0}, {-1.2, 0, 0}};
  for (const Eigen::Vector3d& place : role.in_plane ? line : level) {
    wanted.place = place;
    add(words("to (%g, %g)", place.x(), place.z()), words("to=[%g, 0, %g]", place.x(), place.z()), 16,
        wanted);
  }
  return list;
}

namespace {

// Towards `side`, while the body stays on the ground: hops are no steps.
int steps_of(const SceneResult& run, const Role& role, int side) {
  const std::vector<std::size_t>& rows = run.rows(role.body);
  const std::vector<RowMatrixXd> frames = run.motion(role.body);
  const Foot left = foot_of(frames.front(), true), right = foot_of(frames.front(), false);
  const auto frame_of = [&](std::size_t i) {
    return frames.begin() + static_cast<std::ptrdiff_t>(i * frames.size() / rows.size());
  };
  int steps = 0;
  double in_air = 0;
  std::size_t landed = 0;
  for (std::size_t i = 0; i <= rows.size(); ++i) {
    const bool flies = i < rows.size() && run.steps()("contacts", rows[i]) == 0;
    in_air = flies ? in_air + run.time_step(role.body) : 0;
    if (in_air < kHop && i < rows.size()) continue;
    if (frame_of(i) > frame_of(landed)) {
      const std::vector<RowMatrixXd> between(frame_of(landed), frame_of(i));
      steps += count_steps(between, left, role.height, side) + count_steps(between, right, role.height, side);
    }
    landed = i;
  }
  return steps;
}

}  // namespace

std::vector<std::string> shortcomings(const SceneResult& run, const Role& role) {
  std::vector<std::string> list;
  const Eigen::Vector3d start = run.start(role.body), end = run.end(role.body);
  if (role.gait != Gait::roll && run.most(role.body, "tilt_deg") > kMostTilt)
    list.push_back(words("falls (%.0f deg)", run.most(role.body, "tilt_deg")));
  if (role.place) {
    const double last = run.at(role.body, "t_s", 1);
    double away = 0;
    for (const std::size_t row : run.rows(role.body)) {
      if (run.steps()("t_s", row) >= last - kStay)
        away = std::max(away, level_distance(run.centre(row), *role.place));
    }
    if (away > kNear * role.width) list.push_back(words("ends %.2f m from its place", away));
  }
  if (role.heading_deg) {
    const double angle = *role.heading_deg * std::numbers::pi / 180;
    const Eigen::Vector3d along(std::sin(angle), 0, std::cos(angle)), way = end - start;
    const double off = std::atan2(along.cross(way).y(), along.dot(way)) * 180 / std::numbers::pi;
    if (std::abs(off) > kMostAstray) list.push_back(words("goes %.0f deg astray", off));
  }
  if (const double way = level_distance(start, end); way < role.distance)
    list.push_back(words("gets %.2f m far, not %.2f m", way, role.distance));
  if (const int flights = role.flights > 0 ? flights_of(run, role.body) : 0; flights < role.flights)
    list.push_back(words("hops %d times, not %d times", flights, role.flights));
  if (role.steps > 0) {
    const int steps = steps_of(run, role, end.x() > start.x() ? 1 : -1);
    if (steps < role.steps) list.push_back(words("takes %d steps, not %d", steps, role.steps));
  }
  if (role.missing != nullptr) {
    if (const std::string text = role.missing(run); !text.empty()) list.push_back(text);
  }
  return list;
}

}  // namespace vivify::testing_support

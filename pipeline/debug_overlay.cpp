#include "pipeline/debug_overlay.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "common/config.h"
#include "common/error.h"
#include "common/hdf5_file.h"
#include "meshing/skin.h"
#include "pipeline/body_settings.h"
#include "pipeline/body_shape.h"
#include "pipeline/camera_path.h"
#include "pipeline/handle_settings.h"
#include "pipeline/scene_file.h"
#include "pipeline/stages/stages.h"
#include "render/lens.h"
#include "sim/body.h"

namespace vivify::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr Colour kSticks = {60, 220, 130}, kSlips = {255, 90, 30}, kForce = {255, 225, 60},
                 kGoal = {255, 110, 220}, kRestShape = {90, 200, 255}, kHeld = {185, 140, 255},
                 kBody = {170, 170, 170}, kShade = {0, 0, 0};
constexpr double kShadeOpacity = 0.5;
constexpr double kForceLength = 0.5;   // of the body's height: the arrow of a force as large as its weight
constexpr double kLeastForce = 1e-3;   // of the weight that is drawn
constexpr double kVelocityTime = 0.1;  // s that the arrow of a wanted velocity takes
constexpr double kTurnTime = 0.5;      // s that the arc of a wanted turn takes
constexpr double kTurnRadius = 0.3;    // of the body's height
constexpr double kLeastTurn = 0.05, kLargestTurn = 5;  // rad that are drawn
constexpr int kArcParts = 24;
constexpr double kUnitWidth = 360;  // of a picture whose thin lines are one pixel wide

// Each on a dark shade, so that they are seen on any picture.
void draw_arrow(Canvas& canvas, const Pixel& from, const Pixel& to, double thickness, const Colour& colour) {
  canvas.line(from, from + std::max(0.0, 1 - 2 * thickness / (to - from).norm()) * (to - from),
              thickness + 1.5, kShade, kShadeOpacity);
  canvas.arrow(from, to, thickness, colour);
}
void draw_disc(Canvas& canvas, const Pixel& centre, double radius, const Colour& colour) {
  canvas.disc(centre, radius + 1, kShade, kShadeOpacity);
  canvas.disc(centre, radius, colour);
}
void draw_target(Canvas& canvas, const Pixel& centre, double unit) {
  canvas.ring(centre, 4 * unit, 1.5 * unit + 1.5, kShade, kShadeOpacity);
  canvas.ring(centre, 4 * unit, 1.5 * unit, kGoal);
}
void draw_thin(Canvas& canvas, const Pixel& from, const Pixel& to, double unit, const Colour& colour) {
  canvas.line(from, to, unit + 1, kShade, 0.35);
  canvas.line(from, to, unit, colour);
}

void draw_cross(Canvas& canvas, const Pixel& centre, double unit) {
  const Pixel falling(3 * unit, 3 * unit), rising(3 * unit, -3 * unit);
  for (const Pixel& arm : {falling, rising})
    canvas.line(centre - arm, centre + arm, unit + 1.5, kShade, kShadeOpacity);
  for (const Pixel& arm : {falling, rising}) canvas.line(centre - arm, centre + arm, unit, kHeld);
}

// A line through pixels with an arrow's head at its end.
void draw_arc(Canvas& canvas, const std::vector<Pixel>& arc, double unit) {
  for (std::size_t i = 2; i < arc.size(); ++i) draw_thin(canvas, arc[i - 2], arc[i - 1], unit, kGoal);
  const Pixel &last = arc.back(), before = arc[arc.size() - 2];
  if (last != before) canvas.arrow(last - 5 * unit * (last - before).normalized(), last, 1.5 * unit, kGoal);
}

// A triangle surface that is carried by a simulation mesh, with its edges; vertices in the same place count
// as one.
class Outline {
 public:
  Outline(meshing::Skin skin, const Points& rest, const Triangles& F) : skin_(std::move(skin)), F_(F) {
    std::map<std::array<double, 3>, int> known;
    std::vector<int> first;
    for (int i = 0; i < rest.rows(); ++i)
      first.push_back(known.try_emplace({rest(i, 0), rest(i, 1), rest(i, 2)}, i).first->second);
    for (int f = 0; f < F.rows(); ++f) {
      for (int k = 0; k < 3; ++k) {
        const auto [a, b] = std::minmax({first[F(f, k)], first[F(f, (k + 1) % 3)]});
        edges_[{a, b}].push_back(f);
      }
    }
  }

  // Draws the edges between what faces the eye and what does not, for vertices x of the mesh with elements E.
  void draw(const RowMatrixXd& x, const RowMatrixXi& E, const render::Lens& lens, const Eigen::Vector3d& eye,
            const Colour& colour, double unit, Canvas& canvas) const {
    const Points V = meshing::draw(skin_, E, x);
    std::vector<bool> front(static_cast<std::size_t>(F_.rows()));
    for (Eigen::Index f = 0; f < F_.rows(); ++f) {
      const Eigen::Vector3d a = V.row(F_(f, 0)), b = V.row(F_(f, 1)), c = V.row(F_(f, 2));
      front[static_cast<std::size_t>(f)] = (b - a).cross(c - a).dot(eye - a) > 0;
    }
    for (const auto& [edge, faces] : edges_) {
      const bool seen = faces.size() == 1 || front[faces[0]] != front[faces[1]];
      const auto from = lens.project(V.row(edge.first)), to = lens.project(V.row(edge.second));
      if (seen && from && to) draw_thin(canvas, {from->x, from->y}, {to->x, to->y}, unit, colour);
    }
  }

 private:
  meshing::Skin skin_;
  Triangles F_;
  std::map<std::pair<int, int>, std::vector<int>> edges_;  // and the faces on both sides
};

// Solids of space are outlined with the coarse surface that touches other bodies, others as they are drawn.
Outline load_outline(const Hdf5Reader& mesh, const Value& body) {
  if (body_kind(body) != BodyKind::solid || !mesh.has("/contact"))
    return {load_skin(mesh), mesh.matrix("/surface/V"), mesh.int_matrix("/surface/F")};
  meshing::Skin skin;
  skin.embedding = {mesh.int_vector("/contact/element"), mesh.matrix("/contact/weights")};
  return {std::move(skin), mesh.matrix("/contact/V"), mesh.int_matrix("/contact/F")};
}

Value load_resolved(const fs::path& folder) {
  const fs::path file = folder / "scene.resolved.yaml";
  std::vector<Error> errors;
  const ConfigNode root = parse_yaml(read_text_file(file), file.string(), errors);
  Value scene = errors.empty() ? resolve(scene_schema(), root, errors) : Value();
  if (!errors.empty()) throw errors.front();
  return scene;
}

}  // namespace

struct DebugOverlay::Scene {
  struct Drawn {
    std::unique_ptr<sim::Body> body;
    Outline outline;
  };
  // A frame with its lens, and where it is drawn.
  struct View {
    const Hdf5Reader& state;
    render::Lens lens;
    Eigen::Vector3d eye;
    double unit;
    Canvas& canvas;

    std::optional<Pixel> pixel(const Eigen::Vector3d& point) const {
      const auto seen = lens.project(point);
      if (!seen) return std::nullopt;
      return Pixel(seen->x, seen->y);
    }
    void arrow(const Eigen::Vector3d& from, const Eigen::Vector3d& way, double thickness,
               const Colour& colour) {
      const auto a = pixel(from), b = pixel(from + way);
      if (a && b) draw_arrow(canvas, *a, *b, thickness * unit, colour);
    }
  };

  fs::path folder;
  Value settings;
  double h = 0;  // of a step, s
  int frames = 0;
  std::vector<Drawn> bodies;
  std::vector<render::Camera> cameras;

  explicit Scene(const fs::path& run) : folder(run), settings(load_resolved(run)) {
    while (fs::is_regular_file(folder / simulation_file(frames + 1))) ++frames;
    if (frames == 0) {
      throw Error(ErrorKind::io, "there are no simulated frames in " + (folder / "sim").string(),
                  "make them with `vivify simulate`");
    }
    h = 1 / (settings["frames"]["fps"].as_number() *
             static_cast<double>(settings["frames"]["steps_per_frame"].as_integer()));
    const sim::WorldSettings world{settings["gravity"].as_vector3(), h};
    for (const Value& body : settings["bodies"].items()) {
      sim::BodyInput input = simulated_body(folder, body);
      input.handles = make_handles(body, "bodies[" + std::to_string(bodies.size()) + "]");
      bodies.push_back({std::make_unique<sim::Body>(input, world),
                        load_outline(Hdf5Reader(folder / mesh_file(body)), body)});
    }
    cameras = frame_cameras(settings, folder, frames);
  }

  RowMatrixXd vertices(const sim::Body& body) const {
    const int d = body.model().dimension();
    return Eigen::Map<const RowMatrixXd>(body.x().data(), body.x().size() / d, d);
  }

  // The rest shape is where the body would be if nothing but its elasticity acted on it.
  void draw_shapes(View& view, bool has_picture) {
    for (Drawn& drawn : bodies) {
      sim::Body& body = *drawn.body;
      if (!view.state.has(group_of(body) + "/x")) continue;  // it has not appeared yet
      body.restore(view.state, group_of(body));
      const RowMatrixXi& E = body.model().mesh.E;
      if (!has_picture)
        drawn.outline.draw(vertices(body), E, view.lens, view.eye, kBody, view.unit, view.canvas);
      sim::StepRecord ignored;
      if (!body.settle(body.state().q, ignored)) continue;
      drawn.outline.draw(vertices(body), E, view.lens, view.eye, kRestShape, view.unit, view.canvas);
    }
  }

  static std::string group_of(const sim::Body& body) { return "/bodies/" + body.model().name; }

  // A force on a body, N.
  static void draw_force(View& view, const sim::Body& body, const Eigen::Vector3d& at,
                         const Eigen::Vector3d& force, double thickness) {
    const sim::BodyModel& model = body.model();
    if (force.norm() < kLeastForce * model.weight) return;
    view.arrow(at, kForceLength * model.height / model.weight * force, thickness, kForce);
  }

  // The sum of forces, where on the whole they act.
  struct Push {
    Eigen::Vector3d force = Eigen::Vector3d::Zero(), place = Eigen::Vector3d::Zero();
    double pressure = 0;

    void add(const Eigen::Vector3d& at, const Eigen::Vector3d& normal, const Eigen::Vector3d& friction) {
      force += normal + friction;
      place += normal.norm() * at;
      pressure += normal.norm();
    }
  };
  using Pushes = std::map<std::pair<int, int>, Push>;  // on a body, by something

  // Draws the contacts of a group, and adds what they do to the body numbered `body`, or for contacts between
  // bodies to both, to the sums.
  void draw_contacts(View& view, const std::string& group, std::optional<int> body, Pushes& pushes) {
    if (!view.state.has(group)) return;
    const Points position = view.state.matrix(group + "/position"),
                 normal = view.state.matrix(group + "/normal_force"),
                 friction = view.state.matrix(group + "/friction_force");
    const Eigen::VectorXd slip = view.state.vector(group + "/slip");
    const Eigen::VectorXi by = view.state.int_vector(group + (body ? "/collider" : "/body_b"));
    const Eigen::VectorXi on =
        body ? Eigen::VectorXi::Constant(by.size(), *body) : view.state.int_vector(group + "/body_a");
    for (Eigen::Index i = 0; i < position.rows(); ++i) {
      const Eigen::Vector3d at = position.row(i), pressing = normal.row(i), dragging = friction.row(i);
      const int other = body ? by[i] : -1 - by[i];  // colliders and bodies are numbered alike
      pushes[{on[i], other}].add(at, pressing, dragging);
      draw_force(view, *bodies[on[i]].body, at, pressing + dragging, 1);
      if (!body) {
        pushes[{by[i], -1 - on[i]}].add(at, -pressing, -dragging);
        draw_force(view, *bodies[by[i]].body, at, -pressing - dragging, 1);
      }
    }
    for (Eigen::Index i = 0; i < position.rows(); ++i) {
      const auto at = view.pixel(position.row(i));
      if (at) draw_disc(view.canvas, *at, 1.5 * view.unit, slip[i] > 0 ? kSlips : kSticks);
    }
  }

  void draw_goals(View& view, const sim::Body& body) {
    const std::string group = group_of(body) + "/goals";
    if (!view.state.has(group)) return;
    const auto numbers = [&](const std::string& name) { return view.state.vector(group + "/" + name); };
    const Points place = view.state.matrix(group + "/place"), axis = view.state.matrix(group + "/axis");
    const Eigen::VectorXi turns = view.state.int_vector(group + "/turns");
    const Eigen::VectorXd value = numbers("value"), value_target = numbers("value_target"),
                          value_weight = numbers("value_weight"), rate_target = numbers("rate_target"),
                          rate_weight = numbers("rate_weight");
    // Goals of one place for several directions are one goal in space.
    struct Wanted {
      Eigen::Vector3d place;
      bool turns;
      bool somewhere = false;
      Eigen::Vector3d way = Eigen::Vector3d::Zero(), velocity = Eigen::Vector3d::Zero();
    };
    std::vector<Wanted> all;
    for (Eigen::Index i = 0; i < place.rows(); ++i) {
      const Eigen::Vector3d at = place.row(i), along = axis.row(i);
      const double near = 1e-6 * body.model().height;
      auto wanted = std::find_if(all.begin(), all.end(), [&](const Wanted& one) {
        return one.turns == (turns[i] != 0) && (one.place - at).norm() < near;
      });
      if (wanted == all.end()) wanted = all.insert(all.end(), {at, turns[i] != 0});
      if (value_weight[i] > 0) {
        wanted->somewhere = true;
        wanted->way += (value_target[i] - value[i]) * along;
      }
      if (rate_weight[i] > 0) wanted->velocity += rate_target[i] * along;
    }
    for (const Wanted& wanted : all) {
      if (wanted.turns) {
        draw_turn(view, wanted.place, wanted.velocity, kTurnRadius * body.model().height);
        continue;
      }
      const Eigen::Vector3d target = wanted.place + wanted.way;
      const auto at = view.pixel(wanted.place), to = view.pixel(target);
      if (at && to && wanted.somewhere) {
        draw_thin(view.canvas, *at, *to, view.unit, kGoal);
        draw_target(view.canvas, *to, view.unit);
      }
      view.arrow(target, kVelocityTime * wanted.velocity, 2, kGoal);
    }
  }

  // Where the handles of a body that is there want its vertices, and the way to them.
  static void draw_handles(View& view, const sim::Body& body, double h) {
    if (!view.state.has(group_of(body) + "/x")) return;
    const RowMatrixXd x = view.state.matrix(group_of(body) + "/x");
    const sim::Hold hold = body.handles().at(view.state.scalar("/t"), h);
    for (const sim::Hold::Spring& spring : hold.springs()) {
      Eigen::Vector3d place = Eigen::Vector3d::Zero();
      place.head(x.cols()) = x.row(spring.vertex);
      const auto at = view.pixel(place), to = view.pixel(spring.place);
      if (!at || !to) continue;
      draw_thin(view.canvas, *at, *to, view.unit, kHeld);
      draw_cross(view.canvas, *to, view.unit);
    }
  }

  // An arc about the axis of a wanted turn (rad/s).
  static void draw_turn(View& view, const Eigen::Vector3d& centre, const Eigen::Vector3d& turn,
                        double radius) {
    const double angle = std::min(kTurnTime * turn.norm(), kLargestTurn);
    if (!(angle > kLeastTurn)) return;
    const Eigen::Vector3d axis = turn.normalized(), start = radius * axis.unitOrthogonal();
    std::vector<Pixel> arc;
    for (int i = 0; i <= kArcParts; ++i) {
      const auto at = view.pixel(centre + Eigen::AngleAxisd(angle * i / kArcParts, axis) * start);
      if (!at) return;
      arc.push_back(*at);
    }
    draw_arc(view.canvas, arc, view.unit);
  }
};

DebugOverlay::DebugOverlay(const fs::path& folder) : scene_(std::make_unique<Scene>(folder)) {}
DebugOverlay::~DebugOverlay() = default;

int DebugOverlay::frames() const { return scene_->frames; }

double DebugOverlay::aspect() const {
  const render::RenderSettings settings = render::make_settings(scene_->settings["render"]);
  return static_cast<double>(settings.width) / settings.height;
}

void DebugOverlay::draw(int frame, bool has_picture, Canvas& canvas) {
  const Hdf5Reader state(scene_->folder / simulation_file(frame));
  const render::Camera& camera = scene_->cameras.at(static_cast<std::size_t>(frame - 1));
  Scene::View view = {state, render::Lens(camera, canvas.width(), canvas.height()), camera.position,
                      std::max(1.0, canvas.width() / kUnitWidth), canvas};
  scene_->draw_shapes(view, has_picture);
  Scene::Pushes pushes;
  for (std::size_t b = 0; b < scene_->bodies.size(); ++b) {
    const sim::Body& body = *scene_->bodies[b].body;
    scene_->draw_contacts(view, Scene::group_of(body) + "/contacts", static_cast<int>(b), pushes);
  }
  scene_->draw_contacts(view, "/contacts", std::nullopt, pushes);
  for (const auto& [who, push] : pushes) {
    if (push.pressure == 0) continue;
    Scene::draw_force(view, *scene_->bodies[static_cast<std::size_t>(who.first)].body,
                      push.place / push.pressure, push.force, 2.5);
  }
  for (const Scene::Drawn& drawn : scene_->bodies) {
    Scene::draw_handles(view, *drawn.body, scene_->h);
    scene_->draw_goals(view, *drawn.body);
  }
}

std::vector<DebugOverlay::Sign> DebugOverlay::legend() {
  return {
      {"sticks",
       [](Canvas& canvas, const Pixel& at, double unit) { draw_disc(canvas, at, 3 * unit, kSticks); }},
      {"slips",
       [](Canvas& canvas, const Pixel& at, double unit) { draw_disc(canvas, at, 3 * unit, kSlips); }},
      {"force (weight: half the height)",
       [](Canvas& canvas, const Pixel& at, double unit) {
         draw_arrow(canvas, at + Pixel(0, 7 * unit), at - Pixel(0, 7 * unit), 2.5 * unit, kForce);
       }},
      {"wanted place", [](Canvas& canvas, const Pixel& at, double unit) { draw_target(canvas, at, unit); }},
      {"wanted velocity (way in 0.1 s)",
       [](Canvas& canvas, const Pixel& at, double unit) {
         draw_arrow(canvas, at - Pixel(8 * unit, 0), at + Pixel(8 * unit, 0), 2 * unit, kGoal);
       }},
      {"wanted turn (in 0.5 s)",
       [](Canvas& canvas, const Pixel& at, double unit) {
         std::vector<Pixel> arc;
         for (int i = 0; i <= kArcParts; ++i) {
           const double angle = kLargestTurn * i / kArcParts;
           arc.push_back(at + 6 * unit * Pixel(std::cos(angle), std::sin(angle)));
         }
         draw_arc(canvas, arc, unit);
       }},
      {"held here", [](Canvas& canvas, const Pixel& at, double unit) { draw_cross(canvas, at, unit); }},
      {"rest shape",
       [](Canvas& canvas, const Pixel& at, double unit) {
         draw_thin(canvas, at - Pixel(8 * unit, 0), at + Pixel(8 * unit, 0), unit, kRestShape);
       }},
  };
}

}  // namespace vivify::pipeline

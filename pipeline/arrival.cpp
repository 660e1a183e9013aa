#include "pipeline/arrival.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/text.h"
#include "pipeline/body_settings.h"

namespace vivify::pipeline {
namespace {

constexpr double kNear = 0.2;       // of its width: how far from a place is there
constexpr double kFallen = 60;      // °: who is tilted so much has fallen
constexpr double kSunken = 0.15;    // of its height: how far who stands no more has sunk
constexpr double kDropped = 1;      // of its height: who is so much lower has left the ground it began on
constexpr double kNoHold = 0.15;    // of its weight: a level force that moves nobody
constexpr double kOnItsWay = 0.05;  // of its height, in the last second

template <class... Values>
std::string words(const char* format, Values... values) {
  char text[200];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

// The columns that tell what happened to a body.
struct Track {
  std::vector<double> t, x, y, z, vx, vz, contacts, tilt;

  Track(const StepTable& steps, const std::string& body)
      : t(steps.column("t_s", body)),
        x(steps.column("com_x_m", body)),
        y(steps.column("com_y_m", body)),
        z(steps.column("com_z_m", body)),
        vx(steps.column("vel_x_m_s", body)),
        vz(steps.column("vel_z_m_s", body)),
        contacts(steps.column("contacts", body)),
        tilt(steps.column("tilt_deg", body)) {}

  double level_distance(std::size_t i, const Eigen::Vector3d& place, bool planar) const {
    return planar ? std::abs(x[i] - place.x()) : std::hypot(x[i] - place.x(), z[i] - place.z());
  }
  // Largest force along the ground over the weight.
  double grip(double gravity) const {
    double most = 0;
    for (std::size_t i = 1; i < t.size(); ++i)
      most = std::max(most, std::hypot(vx[i] - vx[i - 1], vz[i] - vz[i - 1]) / (t[i] - t[i - 1]) / gravity);
    return most;
  }
};

std::string travels_by(const Value& body) {
  for (const auto& [path, settings] : behaviors_of(body)) {
    for (const std::string gait : {"hop", "walk", "roll"}) {
      const bool controller = settings.has("type") && settings["type"].as_string() == gait;
      if (controller || path.ends_with("." + gait)) return gait;
    }
  }
  return {};
}

}  // namespace

std::optional<Eigen::Vector3d> destination(const Value& body) {
  const auto behaviors = behaviors_of(body);
  for (auto behavior = behaviors.rbegin(); behavior != behaviors.rend(); ++behavior) {
    const Value& settings = behavior->second;
    if (settings.has("to")) return settings["to"].as_vector3();
    if (settings.has("path")) return settings["path"].items().back().as_vector3();
    for (const char* endless : {"heading_deg", "chase", "flee"}) {
      if (settings.has(endless)) return std::nullopt;
    }
  }
  return std::nullopt;
}

Arrival judge_arrival(const Value& body, const Eigen::Vector3d& place, const StepTable& steps, double gravity,
                      const RowMatrixXd& rest, const RowMatrixXd& last) {
  const Track track(steps, body["name"].as_string());
  const bool planar = rest.cols() == 2;
  const Eigen::RowVectorXd size = rest.colwise().maxCoeff() - rest.colwise().minCoeff();
  const double height = size[1], width = planar ? size[0] : std::max(size[0], size[2]);
  Arrival arrival{place, 0, false, {}};
  if (track.t.empty()) return arrival;
  const std::size_t end = track.t.size() - 1;
  arrival.missing = track.level_distance(end, place, planar);
  const bool near = arrival.missing <= kNear * width;
  const double above = place.y() - last.col(1).maxCoeff();
  arrival.arrived = near && above <= 0;
  if (arrival.arrived) return arrival;

  std::vector<std::string>& reasons = arrival.reasons;
  const double sunken = track.y.front() - track.y[end];
  const bool on_ground = track.contacts[end] > 0;
  if (!on_ground && sunken > kDropped * height) {
    reasons.push_back(words("it fell off what it stood on, by %.1f m", sunken));
    return arrival;
  }
  if (above > 0) {
    reasons.push_back(words("the place is %.2f m above its head, and it travels on the ground", above));
  }
  if (near) return arrival;
  const std::string gait = travels_by(body);
  const auto fallen =
      std::find_if(track.tilt.begin(), track.tilt.end(), [](double tilt) { return tilt > kFallen; });
  if (gait != "roll" && fallen != track.tilt.end()) {
    const auto step = static_cast<std::size_t>(fallen - track.tilt.begin());
    reasons.push_back(words("it fell over at %.1f s", track.t[step]));
  }
  const bool touched =
      std::any_of(track.contacts.begin(), track.contacts.end(), [](double c) { return c > 0; });
  if (!touched) {
    reasons.emplace_back("it touched no ground");
  } else if (on_ground && sunken > kSunken * height) {
    reasons.push_back(
        words("its centre of mass sank by %.0f %% of its height: its material is too soft to hold it up",
              100 * sunken / height));
  } else if (const double grip = track.grip(gravity); grip < kNoHold) {
    reasons.push_back(words(
        "the ground gave it no hold: the level force on it was at most %.1f %% of its weight, as without "
        "friction",
        100 * grip));
  }
  if (gait == "hop" &&
      std::all_of(track.contacts.begin(), track.contacts.end(), [](double c) { return c > 0; }))
    reasons.emplace_back("it never left the ground");
  if (!reasons.empty()) return arrival;

  std::size_t before = end;
  while (before > 0 && track.t[end] - track.t[before] < 1) --before;
  const double speed = (track.level_distance(before, place, planar) - arrival.missing) /
                       std::max(track.t[end] - track.t[before], 1e-9);
  reasons.push_back(speed > kOnItsWay * height
                        ? words("the clip ended while it was on its way, at %.2f m/s", speed)
                        : "it came no nearer in the last second");
  return arrival;
}

std::string describe(const std::string& body, const Arrival& arrival) {
  std::string text = body + ": did not arrive at [" + number_text(arrival.place.x()) + ", " +
                     number_text(arrival.place.y()) + ", " + number_text(arrival.place.z()) +
                     "]: " + words("%.2f m short", arrival.missing);
  for (const std::string& reason : arrival.reasons) text += "; " + reason;
  return text;
}

}  // namespace vivify::pipeline

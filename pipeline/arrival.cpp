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
constexpr double kDropped = 1;      // of its height: who is so much lower has left what it stood on
constexpr double kNoHold = 0.15;    // of its weight: a level force that moves nobody
constexpr double kOnItsWay = 0.05;  // of its height, in the last second

template <class... Values>
std::string words(const char* format, Values... values) {
  char text[200];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

// The columns that tell what happened to a body from a behaviour of its script on.
struct Track {
  std::vector<double> t, x, y, z, vx, vz, contacts, tilt;

  Track(const StepTable& steps, const std::string& body, int behavior)
      : t(steps.column("t_s", body)),
        x(steps.column("com_x_m", body)),
        y(steps.column("com_y_m", body)),
        z(steps.column("com_z_m", body)),
        vx(steps.column("vel_x_m_s", body)),
        vz(steps.column("vel_z_m_s", body)),
        contacts(steps.column("contacts", body)),
        tilt(steps.column("tilt_deg", body)) {
    const std::vector<double> behaviors = steps.column("behavior", body);
    const auto before = std::lower_bound(behaviors.begin(), behaviors.end(), behavior) - behaviors.begin();
    for (std::vector<double>* values : {&t, &x, &y, &z, &vx, &vz, &contacts, &tilt})
      values->erase(values->begin(), values->begin() + before);
  }

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

// Of the middle of its vertices over the lowest one, m.
double rise(const RowMatrixXd& V) { return V.col(1).mean() - V.col(1).minCoeff(); }

// "hop" of "behavior[2].hop", and of a controller its type.
std::string name_of(const std::pair<std::string, Value>& behavior) {
  const auto& [path, settings] = behavior;
  return settings.has("type") ? settings["type"].as_string() : path.substr(path.rfind('.') + 1);
}

// Without end along the heading that it has by itself.
bool goes_on(const Value& travel) {
  for (const char* speed : {"pace", "speed"}) {
    if (travel.has(speed) && travel[speed].as_number() > 0) return true;
  }
  return false;
}

}  // namespace

std::optional<Destination> destination(const Value& body) {
  const auto behaviors = behaviors_of(body);
  for (std::size_t i = behaviors.size(); i-- > 0;) {
    const Value& settings = behaviors[i].second;
    if (settings.has("to")) return Destination{settings["to"].as_vector3(), static_cast<int>(i)};
    if (settings.has("path"))
      return Destination{settings["path"].items().back().as_vector3(), static_cast<int>(i)};
    if (settings.has("heading_deg") || settings.has("chase") || settings.has("flee") || goes_on(settings))
      return std::nullopt;
  }
  return std::nullopt;
}

Arrival judge_arrival(const Value& body, const Destination& destination, const StepTable& steps,
                      double gravity, const RowMatrixXd& rest, const RowMatrixXd& last) {
  const std::string& name = body["name"].as_string();
  const Eigen::Vector3d& place = destination.place;
  const bool planar = rest.cols() == 2;
  const Eigen::RowVectorXd size = rest.colwise().maxCoeff() - rest.colwise().minCoeff();
  const double height = size[1], width = planar ? size[0] : std::max(size[0], size[2]);
  Arrival arrival{place, 0, false, {}};
  const Track whole(steps, name, 0);
  if (whole.t.empty()) return arrival;
  arrival.missing = whole.level_distance(whole.t.size() - 1, place, planar);

  std::vector<std::string>& reasons = arrival.reasons;
  const auto behaviors = behaviors_of(body);
  const Track track(steps, name, destination.behavior);
  if (track.t.empty()) {
    reasons.push_back("the clip ended before it set out, at " + progression(body, steps).at);
    return arrival;
  }
  const std::size_t end = track.t.size() - 1;
  const bool near = arrival.missing <= kNear * width;
  // On the way down a place may be above its head that was not so at first.
  const double above = place.y() - std::max(last.col(1).maxCoeff(), rest.col(1).maxCoeff());
  arrival.arrived = near && above <= 0;
  if (arrival.arrived) return arrival;

  const auto stands = [](double contacts) { return contacts > 0; };
  const auto stood = std::find_if(whole.contacts.rbegin(), whole.contacts.rend(), stands);
  if (stood == whole.contacts.rend()) {
    reasons.emplace_back("it touched no ground");
    return arrival;
  }
  const double fallen_by =
      whole.y[static_cast<std::size_t>(whole.contacts.rend() - stood) - 1] - whole.y.back();
  if (fallen_by > kDropped * height) {
    reasons.push_back(words("it fell off what it stood on, by %.1f m", fallen_by));
    return arrival;
  }
  if (above > 0) {
    reasons.push_back(words("the place is %.2f m above its head, and it travels on the ground", above));
  }
  if (near) return arrival;
  const std::string gait = name_of(behaviors.at(static_cast<std::size_t>(destination.behavior)));
  const auto fallen =
      std::find_if(track.tilt.begin(), track.tilt.end(), [](double tilt) { return tilt > kFallen; });
  const double sunken = rise(rest) - rise(last);
  if (gait != "roll" && fallen != track.tilt.end()) {
    const auto step = static_cast<std::size_t>(fallen - track.tilt.begin());
    reasons.push_back(words("it fell over at %.1f s", track.t[step]));
  } else if (stands(track.contacts[end]) && sunken > kSunken * height) {
    reasons.push_back(
        words("its centre sank by %.0f %% of its height: its material is too soft to hold it up",
              100 * sunken / height));
  } else if (const double grip = track.grip(gravity); grip < kNoHold) {
    reasons.push_back(words(
        "the ground gave it no hold: the level force on it was at most %.1f %% of its weight, as without "
        "friction",
        100 * grip));
  }
  if (gait == "hop" && std::all_of(track.contacts.begin(), track.contacts.end(), stands))
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

Progression progression(const Value& body, const StepTable& steps) {
  const auto behaviors = behaviors_of(body);
  const std::vector<double> reached = steps.column("behavior", body["name"].as_string());
  const auto last =
      static_cast<std::size_t>(reached.empty() ? 0 : reached.back());  // empty: it appeared just now
  const auto& [path, settings] = behaviors.at(last);
  Progression progression{path, {}};
  if (settings.has("until")) progression.at += " until " + settings["until"].as_string();
  for (std::size_t i = last + 1; i < behaviors.size(); ++i)
    progression.never_began.push_back(behaviors[i].first);
  return progression;
}

std::string describe(const std::string& body, const Progression& progression) {
  return body + ": the clip ended at " + progression.at + "; " + join_words(progression.never_began) +
         " never began";
}

}  // namespace vivify::pipeline

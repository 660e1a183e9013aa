#include "sim/contact/rigid_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/text.h"

namespace vivify::sim {
namespace {

// Velocity at the key between two intervals of length h and slope d: the weighted harmonic mean.
double velocity_between(double h0, double d0, double h1, double d1) {
  if (!(d0 * d1 > 0)) return 0;
  const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
  return (w0 + w1) / (w0 / d0 + w1 / d1);
}

std::string rounded(double value) { return number_text(std::round(1e4 * value) / 1e4); }

}  // namespace

RigidPath::RigidPath(std::vector<RigidKey> keys, bool repeats, const std::string& name)
    : keys_(std::move(keys)), repeats_(repeats) {
  check(name);
  const std::size_t last = keys_.empty() ? 0 : keys_.size() - 1;
  std::vector<double> duration;
  std::vector<Coordinates> slope;
  for (std::size_t i = 0; i < last; ++i) {
    duration.push_back(keys_[i + 1].t - keys_[i].t);
    slope.emplace_back((coordinates(keys_[i + 1]) - coordinates(keys_[i])) / duration.back());
  }
  velocity_.assign(keys_.size(), Coordinates::Zero());
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    const bool end = i == 0 || i == last;
    if (end && !repeats_) continue;
    const std::size_t before = i == 0 ? last - 1 : i - 1, after = i == last ? 0 : i;
    for (int k = 0; k < 6; ++k) {
      velocity_[i][k] =
          velocity_between(duration[before], slope[before][k], duration[after], slope[after][k]);
    }
  }
}

RigidPath::Coordinates RigidPath::coordinates(const RigidKey& key) {
  Coordinates all;
  all << key.position, key.turns_deg;
  return all;
}

void RigidPath::check(const std::string& name) const {
  const auto fail = [&](std::size_t key, const std::string& message, const std::string& hint) {
    throw Error(ErrorKind::usage, name + "[" + std::to_string(key) + "]" + message, hint, keys_[key].where);
  };
  for (std::size_t i = 1; i < keys_.size(); ++i) {
    const RigidKey &from = keys_[i - 1], &to = keys_[i];
    const double duration = to.t - from.t;
    if (!(duration > 0)) {
      fail(
          i,
          ".t_s = " + number_text(to.t) + " s is not after the key before it (" + number_text(from.t) + " s)",
          duration == 0 ? "it cannot jump: give it time to get there"
                        : "put the keys in the order of time");
    }
    const double travel = (to.position - from.position).norm();
    if (!(travel <= kFastestTravel * duration)) {
      fail(
          i,
          " jumps: " + rounded(travel) + " m from the key before it, " + number_text(duration) + " s earlier",
          "motions go at " + number_text(kFastestTravel) + " m/s at most");
    }
    const double turn = (to.turns_deg - from.turns_deg).norm();
    if (!(turn <= kFastestTurn * duration)) {
      fail(i,
           " jumps: " + rounded(turn) + "° from the key before it, " + number_text(duration) + " s earlier",
           "motions turn by " + number_text(kFastestTurn) + "° per second at most");
    }
  }
  if (!repeats_) return;
  if (keys_.size() < 2) {
    throw Error(ErrorKind::usage, name + " needs two keys to be repeated", "",
                keys_.empty() ? Location() : keys_.front().where);
  }
  const RigidKey &first = keys_.front(), &last = keys_.back();
  const Eigen::Vector3d turns = (last.turns_deg - first.turns_deg) / 360;
  if (last.position != first.position || (turns.array() != turns.array().round()).any()) {
    fail(keys_.size() - 1, " jumps back to the first key when the motion is repeated",
         "end it with the position of the first key, and its rotation or whole turns more");
  }
}

RigidPath::Coordinates RigidPath::at(double t) const {
  if (repeats_) {
    const double begin = keys_.front().t, period = keys_.back().t - begin;
    t = begin + std::fmod(t - begin, period);
    if (t < begin) t += period;
  }
  const auto next = std::upper_bound(keys_.begin(), keys_.end(), t,
                                     [](double time, const RigidKey& key) { return time < key.t; });
  if (next == keys_.begin()) return coordinates(keys_.front());
  if (next == keys_.end()) return coordinates(keys_.back());
  const auto i = static_cast<std::size_t>(next - keys_.begin()) - 1;
  const double h = keys_[i + 1].t - keys_[i].t, s = (t - keys_[i].t) / h, s2 = s * s, s3 = s2 * s;
  return (2 * s3 - 3 * s2 + 1) * coordinates(keys_[i]) + h * (s3 - 2 * s2 + s) * velocity_[i] +
         (3 * s2 - 2 * s3) * coordinates(keys_[i + 1]) + h * (s3 - s2) * velocity_[i + 1];
}

Eigen::Isometry3d RigidPath::pose(double t) const {
  if (keys_.empty()) return Eigen::Isometry3d::Identity();
  const Coordinates now = at(t);
  const Eigen::Vector3d angles = now.tail<3>() * (std::numbers::pi / 180);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = (Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  pose.translation() = now.head<3>();
  return pose;
}

}  // namespace vivify::sim

// What happened in a simulated scene, body by body.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "common/hdf5_file.h"
#include "tests/pipeline/simulated_run.h"

namespace vivify::testing_support {

class SceneResult {
 public:
  // From an output folder.
  explicit SceneResult(std::filesystem::path out) : out_(std::move(out)), steps_(out_ / "sim/steps.csv") {
    for (std::size_t i = 0; i < steps_.size(); ++i) rows_[steps_.text("body", i)].push_back(i);
  }
  const Steps& steps() const { return steps_; }
  // The rows of steps.csv of a body.
  const std::vector<std::size_t>& rows(const std::string& body) const { return rows_.at(body); }
  double at(const std::string& body, const std::string& column, double share) const {
    const std::vector<std::size_t>& rows = rows_.at(body);
    return steps_(column, rows[static_cast<std::size_t>(share * static_cast<double>(rows.size() - 1))]);
  }
  double least(const std::string& body, const std::string& column) const {
    double value = INFINITY;
    for (const std::size_t row : rows_.at(body)) value = std::min(value, steps_(column, row));
    return value;
  }
  double most(const std::string& body, const std::string& column) const {
    double value = -INFINITY;
    for (const std::size_t row : rows_.at(body)) value = std::max(value, steps_(column, row));
    return value;
  }
  // Centre of mass after the step of a row.
  Eigen::Vector3d centre(std::size_t row) const {
    return {steps_("com_x_m", row), steps_("com_y_m", row), steps_("com_z_m", row)};
  }
  Eigen::Vector3d start(const std::string& body) const { return centre(rows(body).front()); }
  Eigen::Vector3d end(const std::string& body) const { return centre(rows(body).back()); }
  Eigen::Vector3d velocity(std::size_t row) const {
    return {steps_("vel_x_m_s", row), steps_("vel_y_m_s", row), steps_("vel_z_m_s", row)};
  }
  double time_step(const std::string& body) const {
    return steps_("t_s", rows(body)[1]) - steps_("t_s", rows(body)[0]);
  }
  // Vertices of a body in a frame, counted from 1 (#V by d).
  RowMatrixXd vertices(const std::string& body, int frame) const {
    return Hdf5Reader(frame_file(frame)).matrix("/bodies/" + body + "/x");
  }
  // In every frame.
  std::vector<RowMatrixXd> motion(const std::string& body) const {
    std::vector<RowMatrixXd> frames;
    for (int frame = 1; std::filesystem::exists(frame_file(frame)); ++frame)
      frames.push_back(vertices(body, frame));
    return frames;
  }

 private:
  std::filesystem::path frame_file(int frame) const {
    char name[16];
    std::snprintf(name, sizeof name, "%04d.h5", frame);
    return out_ / "sim/frames" / name;
  }

  std::filesystem::path out_;
  Steps steps_;
  std::map<std::string, std::vector<std::size_t>> rows_;
};

inline double level_distance(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::hypot(a.x() - b.x(), a.z() - b.z());
}

// How many times a body left the ground for so long (s).
inline int flights_of(const SceneResult& run, const std::string& body, double at_least = 0.1) {
  const double h = run.time_step(body);
  int flights = 0;
  double in_air = 0;
  for (const std::size_t row : run.rows(body)) {
    const double before = in_air;
    in_air = run.steps()("contacts", row) == 0 ? in_air + h : 0;
    flights += before < at_least && in_air >= at_least;
  }
  return flights;
}

// How far a body of space has turned about the vertical from one frame to another, by its widest line at the
// first.
inline double turn_deg(const SceneResult& run, const std::string& body, int from, int to) {
  const RowMatrixXd a = run.vertices(body, from), b = run.vertices(body, to);
  Eigen::Index left = 0, right = 0;
  a.col(0).minCoeff(&left);
  a.col(0).maxCoeff(&right);
  const Eigen::RowVector3d before = a.row(right) - a.row(left), after = b.row(right) - b.row(left);
  return std::atan2(before.z() * after.x() - before.x() * after.z(),
                    before.x() * after.x() + before.z() * after.z()) *
         180 / std::numbers::pi;
}

}  // namespace vivify::testing_support

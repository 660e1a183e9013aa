// A scene of configs/ that was simulated, for tests of what happens in it.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/hdf5_file.h"
#include "tests/common/temporary_folder.h"
#include "tests/pipeline/program.h"
#include "tests/pipeline/simulated_run.h"

namespace vivify::testing_support {

// The rows of steps.csv of each body.
class SceneRun {
 public:
  explicit SceneRun(const std::string& scene, const std::vector<std::string>& options = {}) {
    std::vector<std::string> arguments = {"simulate",
                                          VIVIFY_SOURCE_DIR "/configs/" + scene,
                                          "-o",
                                          (folder_ / "out").string(),
                                          "--progress=none",
                                          "-q"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = vivify(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    steps_.emplace(folder_ / "out/sim/steps.csv");
    for (std::size_t i = 0; i < steps_->size(); ++i) rows_[steps_->text("body", i)].push_back(i);
  }
  const Steps& steps() const { return *steps_; }
  const std::vector<std::size_t>& rows(const std::string& body) const { return rows_.at(body); }
  double at(const std::string& body, const std::string& column, double share) const {
    const std::vector<std::size_t>& rows = rows_.at(body);
    return (*steps_)(column, rows[static_cast<std::size_t>(share * static_cast<double>(rows.size() - 1))]);
  }
  double least(const std::string& body, const std::string& column) const {
    double value = INFINITY;
    for (const std::size_t row : rows_.at(body)) value = std::min(value, (*steps_)(column, row));
    return value;
  }
  double most(const std::string& body, const std::string& column) const {
    double value = -INFINITY;
    for (const std::size_t row : rows_.at(body)) value = std::max(value, (*steps_)(column, row));
    return value;
  }
  // Centre of mass after the step of a row.
  Eigen::Vector3d centre(std::size_t row) const {
    return {(*steps_)("com_x_m", row), (*steps_)("com_y_m", row), (*steps_)("com_z_m", row)};
  }
  Eigen::Vector3d velocity(std::size_t row) const {
    return {(*steps_)("vel_x_m_s", row), (*steps_)("vel_y_m_s", row), (*steps_)("vel_z_m_s", row)};
  }
  // Vertices of a body in a frame, counted from 1 (#V by d).
  Eigen::MatrixXd vertices(const std::string& body, int frame) const {
    char name[16];
    std::snprintf(name, sizeof name, "%04d.h5", frame);
    return Hdf5Reader(folder_ / "out/sim/frames" / name).matrix("/bodies/" + body + "/x");
  }

 private:
  TemporaryFolder folder_;
  std::optional<Steps> steps_;
  std::map<std::string, std::vector<std::size_t>> rows_;
};

}  // namespace vivify::testing_support

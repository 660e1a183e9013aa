// configs/teacup.yaml as it is shipped: the cup does what the scene says, and obeys the laws of physics while
// it does.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/file.h"
#include "common/hdf5_file.h"
#include "tests/common/temporary_folder.h"
#include "tests/pipeline/program.h"
#include "tests/pipeline/simulated_run.h"

namespace vivify::pipeline {
namespace {

constexpr double kGravity = 9.81;

using testing_support::Flight;
using testing_support::Steps;

class TeacupScene : public testing::TestWithParam<int> {};

TEST_P(TeacupScene, HopsAlongItsHeadingAndObeysTheLaws) {
  const int heading_deg = GetParam();
  const testing_support::TemporaryFolder folder;
  const std::filesystem::path out = folder / "out";
  const testing_support::Outcome outcome = testing_support::vivify(
      {"simulate", VIVIFY_SOURCE_DIR "/configs/teacup.yaml", "-o", out.string(), "--progress=none", "-q",
       "--set", "bodies.cup.controller.heading_deg=" + std::to_string(heading_deg)});
  ASSERT_EQ(outcome.code, 0) << outcome.err;

  const auto summary = nlohmann::json::parse(read_text_file(out / "sim/summary.json"));
  const auto& cup = summary["bodies"]["cup"];
  EXPECT_EQ(summary["frames"], 96);
  EXPECT_GE(cup["dofs"], 228);
  EXPECT_LE(cup["dofs"], 375);
  EXPECT_EQ(cup["params"], 24);
  const double h = summary["h_s"];
  EXPECT_LE(h, 1.0 / 48 + 1e-12);

  const Hdf5Reader mesh(out / "mesh/cup.h5");
  const RowMatrixXd drawn = mesh.matrix("/surface/V");
  EXPECT_GE(mesh.int_matrix("/surface/F").rows(), 20000);
  const double height = drawn.col(1).maxCoeff() - drawn.col(1).minCoeff();
  const double weight = mesh.vector("/mass").sum() * kGravity;

  const Steps steps(out / "sim/steps.csv");
  const std::vector<Flight> hops = flights(steps, h);
  EXPECT_GE(hops.size(), 3u);
  for (const Flight& hop : hops) {
    EXPECT_GE(hop.duration, 0.2);
    EXPECT_GE(hop.clearance, 0.1 * height);
  }

  // Travel in the asked direction, and little beside it.
  const std::size_t end = steps.size() - 1;
  const double dx = steps("com_x_m", end) - steps("com_x_m", 0),
               dz = steps("com_z_m", end) - steps("com_z_m", 0);
  const double heading = heading_deg * M_PI / 180;
  EXPECT_GE(dx * std::sin(heading) + dz * std::cos(heading), 2 * height);
  EXPECT_LE(std::abs(dx * std::cos(heading) - dz * std::sin(heading)), 0.25 * height);

  EXPECT_LE(steps.largest("tilt_deg"), 45);
  EXPECT_LE(steps.largest("max_penetration_m"), 0.01 * height);
  EXPECT_LE(steps.largest("residual_rel"), 1e-8);
  EXPECT_LE(steps.largest("internal_force_sum_n"), 1e-9 * weight);
  EXPECT_LE(steps.largest("internal_torque_sum_nm"), 1e-9 * weight * height);

  // The drawn cup, every vertex of it, never sinks visibly into the table.
  const Eigen::VectorXi tet = mesh.int_vector("/embedding/element");
  const RowMatrixXd weights = mesh.matrix("/embedding/weights");
  const RowMatrixXi elements = mesh.int_matrix("/elements");
  double lowest = 0;
  for (int frame = 1; frame <= 96; ++frame) {
    const std::string number = std::to_string(10000 + frame).substr(1);
    const RowMatrixXd x = Hdf5Reader(out / ("sim/frames/" + number + ".h5")).matrix("/bodies/cup/x");
    for (Eigen::Index i = 0; i < tet.size(); ++i) {
      double y = 0;
      for (int k = 0; k < 4; ++k) y += weights(i, k) * x(elements(tet[i], k), 1);
      lowest = std::min(lowest, y);
    }
  }
  EXPECT_GE(lowest, -0.01 * height);

  // In flight the centre of mass follows the parabola of implicit Euler, whatever the rest shape does.
  for (const Flight& hop : hops) {
    for (std::size_t i = hop.first; i <= hop.last; ++i) {
      const double n = static_cast<double>(i - hop.first);
      const auto along = [&](const char* position, const char* velocity) {
        return steps(position, i) - steps(position, hop.first) - n * h * steps(velocity, hop.first);
      };
      EXPECT_NEAR(along("com_x_m", "vel_x_m_s"), 0, 1e-8);
      EXPECT_NEAR(along("com_y_m", "vel_y_m_s"), -kGravity * h * h * n * (n + 1) / 2, 1e-8);
      EXPECT_NEAR(along("com_z_m", "vel_z_m_s"), 0, 1e-8);
    }
  }

  int fallbacks = 0, in_a_row = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    in_a_row = steps("fallback", i) != 0 ? in_a_row + 1 : 0;
    fallbacks += in_a_row > 0;
    EXPECT_LT(in_a_row, 3) << "step " << i + 1;
  }
  EXPECT_LE(fallbacks, 0.01 * static_cast<double>(steps.size()));
  EXPECT_EQ(cup["fallback_steps"], fallbacks);
}

INSTANTIATE_TEST_SUITE_P(Headings, TeacupScene, testing::Values(0, 90));

// Angle about the vertical from one set of points to the other.
double turned_deg(const RowMatrixXd& from, const RowMatrixXd& to) {
  const RowMatrixXd a = from.rowwise() - from.colwise().mean(), b = to.rowwise() - to.colwise().mean();
  const double along = a.col(0).dot(b.col(0)) + a.col(2).dot(b.col(2));
  const double across = b.col(0).dot(a.col(2)) - b.col(2).dot(a.col(0));
  return std::atan2(across, along) * 180 / M_PI;
}

TEST(TeacupTurn, LooksBehindItself) {
  const testing_support::TemporaryFolder folder;
  const std::filesystem::path out = folder / "out";
  const testing_support::Outcome outcome =
      testing_support::vivify({"simulate", VIVIFY_SOURCE_DIR "/configs/teacup.yaml", "-o", out.string(),
                               "--progress=none", "-q", "--set", "bodies.cup.heading_deg=-60", "--set",
                               "bodies.cup.controller={type: turn, per_hop_deg: 45, by_deg: 180}"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const RowMatrixXd end = Hdf5Reader(out / "sim/frames/0096.h5").matrix("/bodies/cup/x");
  const double turned = turned_deg(Hdf5Reader(out / "mesh/cup.h5").matrix("/X0"), end);
  EXPECT_NEAR(std::remainder(turned - 180, 360), 0, 5);
  const Steps steps(out / "sim/steps.csv");
  EXPECT_LE(steps.largest("tilt_deg"), 15);
  EXPECT_LE(steps.largest("residual_rel"), 1e-8);
  const std::size_t last = steps.size() - 1;
  EXPECT_LE(std::hypot(steps("com_x_m", last), steps("com_z_m", last)), 0.25) << "on the spot";
}

}  // namespace
}  // namespace vivify::pipeline

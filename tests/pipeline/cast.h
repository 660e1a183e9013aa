// What every character of the cast obeys, whatever it does.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/pipeline/cast_table.h"
#include "tests/pipeline/scene_run.h"

namespace vivify::testing_support {

// The laws of physics in every step: residual, internal force and torque, penetration, elements that keep
// their orientation; in steps without contact, the parabola of the centre of mass. And a rest shape that
// stays sane.
inline void expect_laws(const SceneResult& run, const std::string& body, double height) {
  constexpr double kGravity = 9.81;
  const Steps& steps = run.steps();
  const std::vector<std::size_t>& rows = run.rows(body);
  ASSERT_GT(rows.size(), 10U);
  const double h = run.time_step(body);
  EXPECT_LE(run.most(body, "residual_rel"), 1e-8);
  EXPECT_LE(run.most(body, "internal_force_sum_n"), 1e-6);
  EXPECT_LE(run.most(body, "internal_torque_sum_nm"), 1e-6);
  EXPECT_LE(run.most(body, "max_penetration_m"), 0.01 * height);
  EXPECT_GT(run.least(body, "min_element_ratio"), 0);
  EXPECT_GE(run.least(body, "min_rest_element_ratio"), 0.2);
  EXPECT_GE(run.least(body, "rest_volume_ratio"), 0.7);
  EXPECT_LE(run.most(body, "rest_volume_ratio"), 1.3);
  EXPECT_LT(run.most(body, "rest_rate_per_s"), 12);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    // Steps in parts follow parabolas of their own.
    if (steps("contacts", rows[i]) != 0 || steps("contacts", rows[i - 1]) != 0 ||
        steps("substeps", rows[i]) > 1)
      continue;
    const Eigen::Vector3d change = run.velocity(rows[i]) - run.velocity(rows[i - 1]);
    EXPECT_NEAR((change + Eigen::Vector3d(0, h * kGravity, 0)).norm(), 0, 1e-6)
        << body << " in the air at " << steps("t_s", rows[i]) << " s";
  }
}

// Every character of a scene does what its role asks for, by these laws.
inline void expect_played(const SceneResult& run, const std::string& scene) {
  const std::vector<Role> roles = roles_in(scene);
  EXPECT_FALSE(roles.empty()) << scene;
  for (const Role& role : roles) {
    SCOPED_TRACE(role.body);
    expect_laws(run, role.body, role.height);
    EXPECT_THAT(shortcomings(run, role), ::testing::IsEmpty());
  }
}

}  // namespace vivify::testing_support

// What every character of the cast obeys, whatever it does.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tests/pipeline/scene_run.h"

namespace vivify::testing_support {

struct Character {
  std::string body;
  double height;              // m
  double gravity = 9.81;      // m/s²
  double most_tilt_deg = 45;  // 360 for those that roll
};

// The laws of physics in every step: residual, internal force and torque, penetration, elements that keep
// their orientation; in steps without contact, the parabola of the centre of mass.
inline void expect_laws(const SceneRun& run, const Character& character) {
  const Steps& steps = run.steps();
  const std::vector<std::size_t>& rows = run.rows(character.body);
  ASSERT_GT(rows.size(), 10U);
  const double h = steps("t_s", rows[1]) - steps("t_s", rows[0]);
  EXPECT_LE(run.most(character.body, "residual_rel"), 1e-8);
  EXPECT_LE(run.most(character.body, "internal_force_sum_n"), 1e-6);
  EXPECT_LE(run.most(character.body, "internal_torque_sum_nm"), 1e-6);
  EXPECT_LE(run.most(character.body, "max_penetration_m"), 0.01 * character.height);
  EXPECT_LE(run.most(character.body, "tilt_deg"), character.most_tilt_deg);
  EXPECT_GT(run.least(character.body, "min_element_ratio"), 0);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    // Steps in parts follow parabolas of their own.
    if (steps("contacts", rows[i]) != 0 || steps("contacts", rows[i - 1]) != 0 ||
        steps("substeps", rows[i]) > 1)
      continue;
    const Eigen::Vector3d change = run.velocity(rows[i]) - run.velocity(rows[i - 1]);
    EXPECT_NEAR((change + Eigen::Vector3d(0, h * character.gravity, 0)).norm(), 0, 1e-6)
        << character.body << " in the air at " << steps("t_s", rows[i]) << " s";
  }
}

// How many times it left the ground, in flights of a tenth of a second or more.
inline int flights_of(const SceneRun& run, const std::string& body) {
  const Steps& steps = run.steps();
  const std::vector<std::size_t>& rows = run.rows(body);
  const double h = steps("t_s", rows[1]) - steps("t_s", rows[0]);
  int flights = 0;
  double in_air = 0;
  for (const std::size_t row : rows) {
    const double before = in_air;
    in_air = steps("contacts", row) == 0 ? in_air + h : 0;
    flights += before < 0.1 && in_air >= 0.1;
  }
  return flights;
}

}  // namespace vivify::testing_support

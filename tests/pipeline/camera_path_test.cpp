#include "pipeline/camera_path.h"

#include <gtest/gtest.h>

namespace vivify::pipeline {
namespace {

Points straight_path(int frames) {
  Points path(frames, 3);
  for (int i = 0; i < frames; ++i) path.row(i) << 1 + 0.5 * i, 2 - 0.25 * i, 3;
  return path;
}

// Total variation of the second difference of x: how shaky a path is.
double shake(const Points& path) {
  double sum = 0;
  for (Eigen::Index i = 1; i + 1 < path.rows(); ++i) {
    sum += (path.row(i - 1) - 2 * path.row(i) + path.row(i + 1)).norm();
  }
  return sum;
}

TEST(CameraPath, FollowsSteadyMotionExactlyUpToBothEnds) {
  const Points path = straight_path(20);
  const Points moved = camera_displacements(path, 9, true);
  EXPECT_LT((moved - (path.rowwise() - path.row(0))).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(CameraPath, BeginsAtRest) {
  Points path = straight_path(30);
  for (Eigen::Index i = 0; i < 30; ++i) path(i, 0) += std::sin(static_cast<double>(i * i));
  EXPECT_LT(camera_displacements(path, 12, true).row(0).norm(), 1e-12);
}

TEST(CameraPath, SmoothsHops) {
  Points path = straight_path(60);
  for (Eigen::Index i = 0; i < 60; ++i) path(i, 0) += 0.3 * std::abs(std::sin(0.5 * static_cast<double>(i)));
  EXPECT_LT(shake(camera_displacements(path, 24, true)), 0.2 * shake(path));
}

TEST(CameraPath, WithoutWindowIsThePathItself) {
  Points path = straight_path(10);
  path(4, 2) = 7;
  EXPECT_LT((camera_displacements(path, 0, true) - (path.rowwise() - path.row(0))).norm(), 1e-12);
}

TEST(CameraPath, LeavesTheHeightAloneUnlessAsked) {
  EXPECT_EQ(camera_displacements(straight_path(10), 5, false).col(1).norm(), 0);
}

TEST(CameraPath, TakesAWindowLongerThanThePath) {
  EXPECT_TRUE(camera_displacements(straight_path(3), 50, true).allFinite());
  EXPECT_LT(camera_displacements(straight_path(1), 50, true).norm(), 1e-12);
}

}  // namespace
}  // namespace vivify::pipeline

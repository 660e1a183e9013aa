// The crawl controller: long bodies get where they are sent, in a plane and in space.
#include "sim/control/controllers/crawl.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/file.h"
#include "sim/control/behavior.h"
#include "sim/control/body_goals.h"
#include "sim/control/rigid_motion.h"
#include "tests/common/temporary_folder.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

using testing::HasSubstr;

// A bar of 1 m × 0.2 m in the plane, or as deep in space along z.
SimMesh bar(int dimension) {
  if (dimension == 3) return sim_mesh(box_mesh({1, 1, 9}, {0.2, 0.2, 1}, {-0.1, 1e-4, -0.5}));
  constexpr int kCells = 8;
  SimMesh mesh{RowMatrixXd(2 * (kCells + 1), 2), RowMatrixXi(2 * kCells, 3)};
  for (int i = 0; i <= kCells; ++i) {
    const double x = static_cast<double>(i) / kCells - 0.5;
    mesh.V.row(2 * i) << x, 1e-4;
    mesh.V.row(2 * i + 1) << x, 0.2;
    if (i == kCells) break;
    mesh.E.row(2 * i) << 2 * i, 2 * i + 2, 2 * i + 3;
    mesh.E.row(2 * i + 1) << 2 * i, 2 * i + 3, 2 * i + 1;
  }
  return mesh;
}

BodyInput crawler(int dimension, const std::string& settings) {
  const ModelEntry& model = model_entry(
      vivify::sim::settings(model_schema(), dimension == 2 ? "{type: solid2d}" : "{type: solid3d}"));
  return body_input({model, rest_space_entry("full"), {"bar", bar(dimension)}},
                    {.model = "density: 100, stiffness: 20000, volume_stiffness: 20000, damping_s: 0.01",
                     .controller = "{type: crawl, " + settings + "}"});
}

struct Journey {
  Eigen::Vector3d end;
  bool arrived = false;
  double time = 0, yaw_deg = 0;
};

Journey crawl(int dimension, const std::string& settings, double longest) {
  World world({crawler(dimension, settings)}, one(plane(1)), {});
  const Body& body = world.body(0);
  while (world.time() < longest && !body.controller().arrived()) {
    world.step();
    const StepRecord& r = world.records().back();
    EXPECT_LE(r.residual_rel, 1e-8);
    EXPECT_LT(r.tilt_deg, 20) << settings << " at " << world.time();
  }
  const Eigen::Matrix3d R = best_rotation(body.model().mass, flat(body.model().mesh.V), body.x());
  return {centre_of_mass(body.model().mass, body.x()), body.controller().arrived(), world.time(),
          yaw_of(R) * 180 / std::numbers::pi};
}

TEST(Crawl, ABodyOfThePlaneArrivesOnEitherSide) {
  for (const double place : {2.0, -2.0}) {
    const Journey journey = crawl(2, "to: [" + std::to_string(place) + ", 0, 0]", 25);
    EXPECT_TRUE(journey.arrived);
    EXPECT_NEAR(journey.end.x(), place, 0.2) << "of its length, 1 m";
    EXPECT_GT(2 / journey.time, 0.08) << "m/s";
  }
}

TEST(Crawl, ABodyOfSpaceTurnsToItsPlace) {
  const Journey journey = crawl(3, "to: [0.5, 0, 0.4]", 10);
  EXPECT_TRUE(journey.arrived);
  EXPECT_NEAR(journey.end.x(), 0.5, 0.2);
  EXPECT_NEAR(journey.end.z(), 0.4, 0.2);
  EXPECT_GT(journey.yaw_deg, 20);
}

// The end that is nearer to the course leads: backwards it does not turn round.
TEST(Crawl, ABodyOfSpaceGoesBackwards) {
  const Journey journey = crawl(3, "heading_deg: 180", 4);
  EXPECT_LT(journey.end.z(), -0.3);
  EXPECT_NEAR(journey.end.x(), 0, 0.15);
  EXPECT_NEAR(journey.yaw_deg, 0, 15);
}

TEST(Crawl, GoesOnFromASavedFrame) {
  const testing_support::TemporaryFolder folder;
  const BodyInput input = crawler(2, "heading_deg: 90");
  World whole({input}, one(plane(1)), {});
  for (int i = 0; i < 60; ++i) whole.step();
  Hdf5Writer file;
  whole.save(file);
  write_file_atomic(folder / "frame.h5", file.image());
  World later({input}, one(plane(1)), {});
  later.restore(Hdf5Reader(folder / "frame.h5"));
  for (int i = 0; i < 45; ++i) {
    whole.step();
    later.step();
    ASSERT_EQ(whole.body(0).x(), later.body(0).x()) << i;
  }
}

TEST(Crawl, WantsVerticesInEverySegment) {
  try {
    World({crawler(2, "segments: 18")}, one(plane(1)), {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_THAT(error.what(), HasSubstr("18 segments are more than the simulation mesh has"));
  }
}

}  // namespace
}  // namespace vivify::sim

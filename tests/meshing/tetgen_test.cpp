#include "meshing/backends/tetgen.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <chrono>
#include <cstring>

#include "common/error.h"
#include "meshing/quality.h"
#include "tests/meshing/solids.h"

namespace vivify::meshing {
namespace {

TetgenInput input_of(const TriangleMesh& mesh) { return {mesh.V, mesh.F}; }

// The message of the Error(geometry) that TetGen is expected to end in.
std::string refusal(const TetgenInput& input, const std::string& switches, const ProcessLimits& limits = {}) {
  try {
    run_tetgen(input, switches, limits);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::geometry);
    return error.what();
  }
  ADD_FAILURE() << "TetGen accepted the surface";
  return {};
}

TEST(Tetgen, FillsABoxExactly) {
  const TetgenOutput output = run_tetgen(input_of(shapes::unit_box()), "pYq1.414");
  EXPECT_NEAR(tet_volumes(output.mesh).sum(), 1, 1e-12);
  EXPECT_GT(tet_volumes(output.mesh).minCoeff(), 0);
  EXPECT_EQ(output.boundary.rows(), 12);
}

TEST(Tetgen, KeepsTheBitsOfTheInputPoints) {
  const TriangleMesh sphere = shapes::scaled(shapes::sphere({0.1, 0.2, 0.3}, 1.0 / 3), 7.3, {1e3, -2e3, 0.7});
  const TetgenOutput output = run_tetgen(input_of(sphere), "pYq1.414a0.001");
  ASSERT_GE(output.mesh.V.rows(), sphere.V.rows());
  EXPECT_EQ(std::memcmp(output.mesh.V.data(), sphere.V.data(),
                        sizeof(double) * static_cast<std::size_t>(sphere.V.size())),
            0);
  EXPECT_NEAR(tet_volumes(output.mesh).sum() / signed_volume(sphere), 1, 1e-9);
}

TEST(Tetgen, BoundaryTrianglesLieOnTheirFacets) {
  const TriangleMesh box = shapes::scaled(shapes::unit_box(), 2, {5, 6, 7});
  const TetgenOutput output = run_tetgen(input_of(box), "pq1.414a0.0005");  // splits the boundary
  ASSERT_GT(output.boundary.rows(), 100);
  EXPECT_TRUE(is_closed_oriented(output.boundary));
  EXPECT_NEAR(signed_volume({output.mesh.V, output.boundary, {}, {}, {}}), 8, 1e-9);  // outward
  Eigen::VectorXd area = Eigen::VectorXd::Zero(box.F.rows());
  const auto corner = [](const Points& V, const Triangles& F, Eigen::Index f, int k) {
    return Eigen::Vector3d(V.row(F(f, k)));
  };
  for (Eigen::Index f = 0; f < output.boundary.rows(); ++f) {
    const int facet = output.boundary_facet[f];
    ASSERT_GE(facet, 0);
    ASSERT_LT(facet, box.F.rows());
    const Eigen::Vector3d o = corner(box.V, box.F, facet, 0);
    const Eigen::Vector3d normal =
        (corner(box.V, box.F, facet, 1) - o).cross(corner(box.V, box.F, facet, 2) - o).normalized();
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(normal.dot(corner(output.mesh.V, output.boundary, f, k) - o), 0, 1e-12);
    const Eigen::Vector3d p = corner(output.mesh.V, output.boundary, f, 0);
    area[facet] += 0.5 * (corner(output.mesh.V, output.boundary, f, 1) - p)
                             .cross(corner(output.mesh.V, output.boundary, f, 2) - p)
                             .dot(normal);
  }
  EXPECT_LT((area.array() - 2).abs().maxCoeff(), 1e-9);  // each facet is covered once
}

TEST(Tetgen, ExtraPointsBecomeNodes) {
  TetgenInput input = input_of(shapes::unit_box());
  const Points inside = shapes::random_points(20, {0.1, 0.1, 0.1}, {0.9, 0.9, 0.9}, 1);
  Points all(28, 3);
  all << input.points, inside;
  input.points = all;
  TetMesh mesh = run_tetgen(input, "pY").mesh;
  EXPECT_EQ(mesh.V, all);
  drop_unused_vertices(mesh);
  EXPECT_EQ(mesh.V.rows(), 28);
}

TEST(Tetgen, SmallAndLargeScalesGiveTheSameMesh) {
  const TriangleMesh sphere = shapes::sphere({0, 0, 0}, 1);
  const TetgenOutput reference = run_tetgen(input_of(sphere), "pYq1.414a0.01");
  for (const double factor : {0x1p-30, 0x1p30}) {
    const TetgenOutput output = run_tetgen(input_of(shapes::scaled(sphere, factor)), "pYq1.414a0.01");
    EXPECT_EQ(output.mesh.T, reference.mesh.T);
    EXPECT_EQ(output.mesh.V, reference.mesh.V * factor);
  }
}

TEST(Tetgen, IsDeterministic) {
  const TetgenInput input = input_of(shapes::torus(1, 0.3));
  const TetgenOutput a = run_tetgen(input, "pYq1.414a0.001"), b = run_tetgen(input, "pYq1.414a0.001");
  EXPECT_EQ(a.mesh.V, b.mesh.V);
  EXPECT_EQ(a.mesh.T, b.mesh.T);
  EXPECT_EQ(a.boundary_facet, b.boundary_facet);
}

TEST(Tetgen, SelfIntersectionIsAnError) {
  const TriangleMesh crossing =
      shapes::joined(shapes::unit_box(), shapes::scaled(shapes::unit_box(), 1, {0.3, 0.4, 0.5}));
  EXPECT_THAT(refusal(input_of(crossing), "pYq1.414"), testing::HasSubstr("intersect"));
}

TEST(Tetgen, OpenSurfaceIsAnError) {
  EXPECT_THAT(refusal(input_of(shapes::open_box()), "pYq1.414"), testing::HasSubstr("open"));
}

TEST(Tetgen, PlanarSurfaceIsAnErrorAndDoesNotEndTheProgram) {
  TriangleMesh flat = shapes::unit_box();
  flat.V.col(2).setZero();
  EXPECT_THAT(refusal(input_of(flat), "pY"), testing::HasSubstr("TetGen"));
}

TEST(Tetgen, DegenerateInputsAreErrors) {
  EXPECT_THAT(refusal(input_of(shapes::single_triangle()), "pY"), testing::HasSubstr("no volume"));
  TetgenInput input = input_of(shapes::unit_box());
  input.points(5, 1) = std::nan("");
  EXPECT_THAT(refusal(input, "pY"), testing::HasSubstr("point 5"));
  input = input_of(shapes::unit_box());
  input.facets(2, 1) = 99;
  EXPECT_THAT(refusal(input, "pY"), testing::HasSubstr("does not exist"));
  input = input_of(shapes::unit_box());
  input.points.setConstant(3);
  EXPECT_THAT(refusal(input, "pY"), testing::HasSubstr("coincide"));
}

TEST(Tetgen, TimeLimitIsKept) {
  const auto start = std::chrono::steady_clock::now();
  const std::string message = refusal(input_of(shapes::unit_box()), "pq1.1a1e-8", {0.3, 4096});
  EXPECT_THAT(message, testing::HasSubstr("0.3 s"));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(Tetgen, MemoryLimitIsKept) {
  EXPECT_THAT(refusal(input_of(shapes::unit_box()), "pq1.1a1e-8", {60, 60}), testing::HasSubstr("memory"));
}
#endif

}  // namespace
}  // namespace vivify::meshing

#include "meshing/quality.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/meshing/solids.h"

namespace vivify::meshing {
namespace {

TEST(Quality, DihedralAnglesOfARegularTetrahedron) {
  const double expected = std::acos(1.0 / 3) * 180 / std::numbers::pi;
  for (const double angle : dihedral_angles({1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1})) {
    EXPECT_NEAR(angle, expected, 1e-12);
  }
}

TEST(Quality, DihedralAnglesOfACornerTetrahedron) {
  // Three right angles at the edges of the corner, atan(√2) at the edges of the slanted face.
  const auto angles = dihedral_angles({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  for (int e = 0; e < 3; ++e) EXPECT_NEAR(angles[static_cast<std::size_t>(e)], 90, 1e-12);
  for (int e = 3; e < 6; ++e) {
    EXPECT_NEAR(angles[static_cast<std::size_t>(e)], std::atan(std::sqrt(2.0)) * 180 / std::numbers::pi,
                1e-12);
  }
}

TEST(Quality, RangeOfTheKuhnCube) {
  const AngleRange range = dihedral_range(shapes::cube_tets(2));
  EXPECT_NEAR(range.min, 45, 1e-9);
  EXPECT_NEAR(range.max, 90, 1e-9);
}

TEST(Quality, ClosednessAndManifoldness) {
  const TriangleMesh box = shapes::unit_box();
  EXPECT_TRUE(is_closed_oriented(box.F));
  EXPECT_TRUE(is_manifold(box.F));
  EXPECT_FALSE(is_closed_oriented(shapes::open_box().F));
  EXPECT_TRUE(is_manifold(shapes::open_box().F));
  TriangleMesh flipped = box;
  std::swap(flipped.F(3, 0), flipped.F(3, 1));
  EXPECT_FALSE(is_closed_oriented(flipped.F));
  EXPECT_FALSE(is_closed_oriented(shapes::moebius().F));
  EXPECT_TRUE(is_manifold(shapes::moebius().F));
  EXPECT_FALSE(is_closed_oriented(Triangles(0, 3)));

  Triangles fins(3, 3);  // three triangles at one edge
  fins << 0, 1, 2, 0, 1, 3, 0, 1, 4;
  EXPECT_FALSE(is_manifold(fins));
  Triangles bow_tie(2, 3);  // two triangles that share a vertex only
  bow_tie << 0, 1, 2, 0, 3, 4;
  EXPECT_FALSE(is_manifold(bow_tie));
}

TEST(Quality, ComponentsAndEulerCharacteristic) {
  const TriangleMesh torus = shapes::torus(1, 0.3);
  EXPECT_EQ(euler_characteristic(torus.F), 0);
  EXPECT_EQ(component_count(torus.F), 1);
  const TriangleMesh both = shapes::joined(torus, shapes::unit_box());
  EXPECT_EQ(euler_characteristic(both.F), 2);
  EXPECT_EQ(component_count(both.F), 2);
  EXPECT_EQ(component_count(shapes::cube_tets(3).T), 1);
  EXPECT_EQ(component_count(Tetrahedra(0, 4)), 0);
}

TEST(Quality, UnusedVerticesAreDropped) {
  TriangleMesh mesh = shapes::joined(shapes::unit_box(), shapes::octahedron());
  const Triangles kept = mesh.F.bottomRows(8);
  mesh.F = kept;
  drop_unused_vertices(mesh);
  EXPECT_EQ(mesh.V, shapes::octahedron().V);
  EXPECT_EQ(mesh.F, shapes::octahedron().F);
}

}  // namespace
}  // namespace vivify::meshing

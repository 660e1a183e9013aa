#include "meshing/extrude.h"

#include <gtest/gtest.h>

#include <numbers>

#include "common/error.h"
#include "meshing/planar_mesh.h"
#include "meshing/quality.h"
#include "meshing/surface_checks.h"
#include "tests/meshing/plane_shapes.h"

namespace vivify::meshing {
namespace {

using shapes::glyph;
using shapes::outline_of;

// Closed, manifold, outward, free of self-intersections, between the two planes, in named parts.
void expect_solid(const TriangleMesh& mesh, const Outline& outline, double depth) {
  EXPECT_EQ(topology_problem(mesh), "");
  EXPECT_TRUE(is_closed_oriented(mesh.F));
  EXPECT_TRUE(self_intersections(mesh).empty());
  EXPECT_GT(signed_volume(mesh), 0.6 * outline.area() * depth);
  EXPECT_LE(signed_volume(mesh), outline.area() * depth * (1 + 1e-9));
  const Box box = bounding_box(mesh.V);
  EXPECT_EQ(box.min.z(), -depth / 2);
  EXPECT_EQ(box.max.z(), depth / 2);
  const Eigen::AlignedBox2d flat = box_of(outline.loops);
  EXPECT_NEAR((box.min.head<2>() - flat.min()).norm(), 0, 1e-9);
  EXPECT_NEAR((box.max.head<2>() - flat.max()).norm(), 0, 1e-9);
  int genus_twice = 0;  // 2 - 2 (holes) for each part
  for (const Points2& loop : outline.loops) genus_twice += signed_area(loop) > 0 ? 2 : -2;
  EXPECT_EQ(euler_characteristic(mesh.F), genus_twice);
  ASSERT_EQ(mesh.part_names, (std::vector<std::string>{"front", "side", "back"}));
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const auto z = [&](int k) { return mesh.V(mesh.F(f, k), 2); };
    const bool front = z(0) == depth / 2 && z(1) == depth / 2 && z(2) == depth / 2;
    const bool back = z(0) == -depth / 2 && z(1) == -depth / 2 && z(2) == -depth / 2;
    EXPECT_EQ(mesh.face_part[f], front ? 0 : back ? 2 : 1);
    const Eigen::Vector3d a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)),
                          c = mesh.V.row(mesh.F(f, 2));
    const double up = (b - a).cross(c - a).z();
    EXPECT_TRUE(front ? up > 0 : !back || up < 0) << "face " << f;
  }
}

TEST(Extrude, LettersAreClosedSolids) {
  for (const char* text : {"I", "o", "S", "8", "&", "A", "i", "W"}) {
    SCOPED_TRACE(text);
    const Outline outline = glyph(text);
    expect_solid(extrude(outline, 0.3, 0.03), outline, 0.3);
    expect_solid(extrude(outline, 0.2, 0), outline, 0.2);
  }
}

TEST(Extrude, VolumeOfABevelledBox) {
  const Outline outline = outline_of({shapes::rectangle({0, 0}, {2, 3})});
  EXPECT_NEAR(signed_volume(extrude(outline, 0.5, 0)), 3, 1e-12);
  const double depth = 0.5, r = 0.1;
  // Exactly rounded: the section at each height is the rectangle inset by r (1 - cos): integrals of (2 -
  // 2i)(3 - 2i).
  const double integral_i = r * (1 - std::numbers::pi / 4),
               integral_ii = r * (5.0 / 3 - std::numbers::pi / 2);
  const double exact = 6 * (depth - 2 * r) + 2 * (6 * r - 10 * r * integral_i + 4 * r * r * integral_ii);
  EXPECT_NEAR(signed_volume(extrude(outline, depth, r)), exact, 0.02);
}

// The lower left corner of the box around the outline is that of a picture; so for the upper right one.
TEST(Extrude, APictureFillsTheBoxAroundTheOutline) {
  const Outline outline = outline_of({shapes::letter_i()});
  const TriangleMesh mesh = extrude(outline, 0.1, 0.01);
  const Eigen::AlignedBox2d box = box_of(outline.loops);
  ASSERT_EQ(mesh.UV.rows(), mesh.V.rows());
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
    const Eigen::Vector2d at =
        box.min() + Eigen::Vector2d(mesh.UV.row(i).transpose()).cwiseProduct(box.sizes());
    EXPECT_NEAR((at - mesh.V.row(i).head<2>().transpose()).norm(), 0, 1e-12);
  }
}

// Edges of the flat faces and along the sides are short against the letter, and there are no slivers.
TEST(Extrude, BendsSmoothly) {
  const Outline outline = outline_of({shapes::letter_i()});
  const TriangleMesh mesh = extrude(outline, 0.1, 0.01);
  double longest = 0;
  Points2 flat(mesh.V.rows(), 2);
  flat = mesh.V.leftCols(2);
  Triangles front(0, 3);
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest, (mesh.V.row(mesh.F(f, k)) - mesh.V.row(mesh.F(f, (k + 1) % 3))).norm());
    }
    if (mesh.face_part[f] != 0) continue;
    front.conservativeResize(front.rows() + 1, 3);
    front.row(front.rows() - 1) = mesh.F.row(f);
  }
  EXPECT_LT(longest, 0.5 * 0.1 * 1.5);
  EXPECT_GT(min_angle(flat, front), 20);
}

TEST(Extrude, BevelShrinksWhereStrokesAreThin) {
  const Outline thin = outline_of({shapes::rectangle({0, 0}, {0.05, 1})});
  const TriangleMesh mesh = extrude(thin, 0.4, 0.1);
  expect_solid(mesh, thin, 0.4);
  EXPECT_GT(signed_volume(mesh), 0.8 * thin.area() * 0.4);
}

TEST(Extrude, PartsThatTouch) {
  const Outline touching = outline_of({shapes::rectangle({0, 0}, {1, 1}), shapes::rectangle({1, 1}, {2, 2})});
  EXPECT_EQ(topology_problem(extrude(touching, 0.3, 0.05)), "");
  EXPECT_THROW(extrude(touching, 0.3, 0), Error);
}

TEST(Extrude, BevelMustFitTheDepth) {
  const Outline outline = outline_of({shapes::rectangle({0, 0}, {1, 1})});
  EXPECT_THROW(extrude(outline, 0.2, 0.1), Error);
  EXPECT_THROW(extrude(outline, 0, 0), Error);
  EXPECT_THROW(extrude(outline, 0.2, -0.01), Error);
}

}  // namespace
}  // namespace vivify::meshing

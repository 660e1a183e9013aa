#include "meshing/repair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <vector>

#include "common/error.h"
#include "meshing/coarsen.h"
#include "meshing/quality.h"
#include "tests/meshing/solids.h"

namespace vivify::meshing {
namespace {

using testing::Contains;
using testing::HasSubstr;

// Repairs, and checks what repair_surface promises for any input.
RepairedSurface repaired(const TriangleMesh& input) {
  RepairedSurface surface = repair_surface(input);
  EXPECT_TRUE(is_closed_oriented(surface.mesh.F));
  EXPECT_TRUE(is_manifold(surface.mesh.F));
  EXPECT_FALSE(intersects_itself(surface.mesh));
  EXPECT_GT(signed_volume(surface.mesh), 0);
  return surface;
}

TEST(Repair, KeepsAGoodSurfaceBitByBit) {
  for (const TriangleMesh& good :
       {shapes::sphere({1, 2, 3}, 0.7), shapes::unit_box(), shapes::torus(1, 0.3)}) {
    const RepairedSurface surface = repaired(good);
    EXPECT_EQ(surface.route, "kept");
    EXPECT_TRUE(surface.notes.empty());
    EXPECT_EQ(surface.mesh.F.rows(), good.F.rows());
    const auto sorted = [](const Points& V) {
      std::vector<std::array<double, 3>> rows;
      for (Eigen::Index v = 0; v < V.rows(); ++v) rows.push_back({V(v, 0), V(v, 1), V(v, 2)});
      std::sort(rows.begin(), rows.end());
      return rows;
    };
    EXPECT_EQ(sorted(good.V), sorted(surface.mesh.V));
    EXPECT_NEAR(signed_volume(surface.mesh) / signed_volume(good), 1, 1e-12);
  }
}

TEST(Repair, FillsTheHoleOfABox) {
  const RepairedSurface surface = repaired(shapes::open_box());
  EXPECT_EQ(surface.route, "repaired");
  EXPECT_NEAR(signed_volume(surface.mesh), 1, 1e-12);
  EXPECT_THAT(surface.notes, Contains(HasSubstr("filled 1 hole with 2 triangles")));
}

TEST(Repair, TurnsTrianglesRound) {
  TriangleMesh mesh = shapes::sphere({0, 0, 0}, 1);
  const double volume = signed_volume(mesh);
  for (int f = 0; f < 40; ++f) std::swap(mesh.F(f, 0), mesh.F(f, 1));
  RepairedSurface surface = repaired(mesh);
  EXPECT_EQ(surface.route, "repaired");
  EXPECT_NEAR(signed_volume(surface.mesh), volume, 1e-12);
  EXPECT_THAT(surface.notes, Contains("turned round 40 triangles"));

  surface = repaired(shapes::turned(shapes::unit_box()));
  EXPECT_NEAR(signed_volume(surface.mesh), 1, 1e-12);
  EXPECT_THAT(surface.notes, Contains(HasSubstr("inside out")));
}

TEST(Repair, JoinsTrianglesThatShareNoVertex) {
  const TriangleMesh sphere = shapes::sphere({0, 0, 0}, 1);
  TriangleMesh soup;
  soup.V.resize(3 * sphere.F.rows(), 3);
  soup.F.resize(sphere.F.rows(), 3);
  for (Eigen::Index f = 0; f < sphere.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      soup.F(f, k) = static_cast<int>(3 * f + k);
      soup.V.row(3 * f + k) = sphere.V.row(sphere.F(f, k));
    }
  }
  const RepairedSurface surface = repaired(soup);
  EXPECT_EQ(surface.route, "kept");
  EXPECT_EQ(surface.mesh.V.rows(), sphere.V.rows());
  EXPECT_THAT(surface.notes, Contains(HasSubstr("duplicate vertices")));
}

TEST(Repair, DropsADoubledSurface) {
  const TriangleMesh sphere = shapes::sphere({0, 0, 0}, 1);
  for (const TriangleMesh& twin : {sphere, shapes::turned(sphere)}) {
    const RepairedSurface surface = repaired(shapes::joined(sphere, twin));
    EXPECT_EQ(surface.route, "repaired");
    EXPECT_NEAR(signed_volume(surface.mesh), signed_volume(sphere), 1e-12);
    EXPECT_THAT(surface.notes, Contains("dropped 512 duplicate triangles"));
  }
}

TEST(Repair, DropsASliver) {
  TriangleMesh mesh = shapes::unit_box();  // one triangle with its corners on one edge
  const Triangles F = mesh.F;
  mesh.V.conservativeResize(9, 3);
  mesh.V.row(8) = 0.5 * (mesh.V.row(0) + mesh.V.row(1));
  mesh.F.resize(F.rows() + 1, 3);
  mesh.F << F, Eigen::RowVector3i(0, 1, 8);
  const RepairedSurface surface = repaired(mesh);
  EXPECT_NEAR(signed_volume(surface.mesh), 1, 0.05);
  EXPECT_FALSE(surface.notes.empty());
}

TEST(Repair, WrapsWhatIntersectsItself) {
  const TriangleMesh crossing = shapes::joined(shapes::sphere({0, 0, 0}, 1), shapes::sphere({1, 0, 0}, 1));
  const RepairedSurface surface = repaired(crossing);
  EXPECT_EQ(surface.route, "wrapped");
  EXPECT_THAT(surface.notes, Contains(HasSubstr("intersect one another")));
  EXPECT_EQ(component_count(surface.mesh.F), 1);
  // Union of two unit balls at distance 1: 8π/3 − 5π/12 = 9π/4.
  EXPECT_NEAR(signed_volume(surface.mesh) / (2.25 * std::numbers::pi), 1, 0.05);
}

TEST(Repair, FillsHolesBeforeItWraps) {
  // A box without its top, pierced by another: wrapped as it is, it would become a hollow shell.
  const TriangleMesh mesh =
      shapes::joined(shapes::open_box(), shapes::scaled(shapes::unit_box(), 0.3, {0.8, 0.3, 0.3}));
  const RepairedSurface surface = repaired(mesh);
  EXPECT_EQ(surface.route, "wrapped");
  EXPECT_GT(signed_volume(surface.mesh), 1);
  EXPECT_LT(signed_volume(surface.mesh), 1.1);
}

TEST(Repair, SeparatePartsStaySeparate) {
  const TriangleMesh two = shapes::joined(shapes::sphere({0, 0, 0}, 1), shapes::sphere({3, 0, 0}, 1));
  const RepairedSurface surface = repaired(two);
  EXPECT_EQ(surface.route, "kept");
  EXPECT_EQ(component_count(surface.mesh.F), 2);
}

TEST(Repair, NamesAHiddenCavity) {
  const TriangleMesh outer = shapes::sphere({0, 0, 0}, 1), inner = shapes::sphere({0, 0, 0}, 0.8);
  const double volume = signed_volume(outer) - signed_volume(inner);
  RepairedSurface surface = repaired(shapes::joined(outer, shapes::turned(inner)));
  EXPECT_EQ(surface.route, "kept");
  EXPECT_NEAR(signed_volume(surface.mesh), volume, 1e-12);
  EXPECT_THAT(surface.notes, Contains(HasSubstr("1 hidden cavity")));

  surface = repaired(shapes::joined(outer, inner));
  EXPECT_EQ(surface.route, "repaired");
  EXPECT_NEAR(signed_volume(surface.mesh), volume, 1e-12);
  EXPECT_THAT(surface.notes, Contains(HasSubstr("inner shell")));
}

TEST(Repair, MakesASolidOfASheet) {
  for (const TriangleMesh& sheet : {shapes::single_triangle(), shapes::moebius()}) {
    const RepairedSurface surface = repaired(sheet);
    EXPECT_EQ(surface.route, "wrapped");
    EXPECT_FALSE(surface.notes.empty());
  }
}

TEST(Repair, ScaleAndPlaceDoNotMatter) {
  const TriangleMesh sphere = shapes::sphere({0, 0, 0}, 1);
  const TriangleMesh crossing = shapes::joined(sphere, shapes::sphere({1, 0, 0}, 1));
  const double volume = signed_volume(repair_surface(crossing).mesh);
  for (const double factor : {1e-9, 1e9}) {
    EXPECT_EQ(repaired(shapes::scaled(sphere, factor)).route, "kept");
    const RepairedSurface surface = repaired(shapes::scaled(crossing, factor));
    EXPECT_EQ(surface.route, "wrapped");
    EXPECT_NEAR(signed_volume(surface.mesh) / (volume * factor * factor * factor), 1, 0.01);
  }
  const Eigen::RowVector3d far(1e6, -1e6, 1e6);
  EXPECT_EQ(repaired(shapes::scaled(sphere, 1, far)).route, "kept");
  EXPECT_NEAR(signed_volume(repaired(shapes::scaled(crossing, 1, far)).mesh) / volume, 1, 0.01);
}

TEST(Repair, IsDeterministic) {
  const TriangleMesh crossing = shapes::joined(shapes::sphere({0, 0, 0}, 1), shapes::sphere({1, 0, 0}, 1));
  const RepairedSurface a = repair_surface(crossing), b = repair_surface(crossing);
  EXPECT_EQ(a.mesh.V, b.mesh.V);
  EXPECT_EQ(a.mesh.F, b.mesh.F);
}

void expect_refusal(const TriangleMesh& mesh, const std::string& part) {
  try {
    repair_surface(mesh);
    FAIL() << "the mesh was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::geometry);
    EXPECT_THAT(error.what(), HasSubstr(part));
  }
}

TEST(Repair, RefusesWhatIsNoSurface) {
  expect_refusal({}, "no triangles");
  TriangleMesh mesh = shapes::unit_box();
  mesh.V(6, 2) = std::numeric_limits<double>::infinity();
  expect_refusal(mesh, "vertex 6");
  mesh = shapes::single_triangle();
  mesh.V.row(2) << 2, 0, 0;
  expect_refusal(mesh, "zero area");
  mesh.F(0, 0) = 7;
  expect_refusal(mesh, "does not exist");
}

TEST(Repair, LimitsAreKept) {
  const TriangleMesh crossing =
      shapes::joined(shapes::sphere({0, 0, 0}, 1, 6), shapes::sphere({1, 0, 0}, 1, 6));
  EXPECT_THROW(repair_surface(crossing, {0.02, 6000}), Error);
}

}  // namespace
}  // namespace vivify::meshing

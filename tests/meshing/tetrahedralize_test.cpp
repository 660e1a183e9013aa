#include "meshing/tetrahedralize.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config.h"
#include "common/error.h"
#include "meshing/quality.h"
#include "meshing/repair.h"
#include "tests/meshing/solids.h"

namespace vivify::meshing {
namespace {

TetrahedralizeSettings wanted(const std::string& backend, int vertices) {
  TetrahedralizeSettings settings;
  settings.backend = backend;
  settings.vertices = vertices;
  return settings;
}

// Tetrahedralizes, and checks what is promised for any surface.
TetrahedralizeResult checked(const TriangleMesh& surface, const TetrahedralizeSettings& settings) {
  TetrahedralizeResult result = tetrahedralize(surface, settings);
  const TetMesh& mesh = result.mesh;
  EXPECT_NEAR(static_cast<double>(mesh.V.rows()), settings.vertices, 0.15 * settings.vertices);
  EXPECT_GT(tet_volumes(mesh).minCoeff(), 0);
  const Triangles boundary = boundary_faces(mesh);
  EXPECT_TRUE(is_closed_oriented(boundary));
  EXPECT_TRUE(is_manifold(boundary));
  EXPECT_EQ(component_count(mesh.T), result.components);
  EXPECT_NEAR(tet_volumes(mesh).sum() / signed_volume(surface), result.volume_ratio, 1e-12);
  const AngleRange angles = dihedral_range(mesh);
  EXPECT_EQ(angles.min, result.min_dihedral);
  EXPECT_EQ(angles.max, result.max_dihedral);
  EXPECT_GE(angles.min, 10);
  TetMesh used = mesh;
  drop_unused_vertices(used);
  EXPECT_EQ(used.V.rows(), mesh.V.rows());
  return result;
}

TEST(Tetrahedralize, KeepsABoxExactly) {
  for (const int vertices : {30, 100, 1000}) {
    const TetrahedralizeResult result = checked(shapes::unit_box(), wanted("tetgen", vertices));
    EXPECT_NEAR(result.volume_ratio, 1, 1e-9) << vertices;
    EXPECT_LT(result.distance, 1e-9) << vertices;
  }
}

TEST(Tetrahedralize, ApproachesASphere) {
  const TriangleMesh sphere = shapes::sphere({0, 0, 0}, 1, 5);
  double distance = 1;
  for (const int vertices : {60, 240, 1920}) {
    const TetrahedralizeResult result = checked(sphere, wanted("tetgen", vertices));
    EXPECT_LT(result.distance, 0.7 * distance) << vertices;
    distance = result.distance;
  }
  EXPECT_LT(distance, 0.03);
}

TEST(Tetrahedralize, ReachesTenThousandVertices) {
  const TetrahedralizeResult result = checked(shapes::sphere({0, 0, 0}, 1, 4), wanted("tetgen", 10000));
  EXPECT_NEAR(result.volume_ratio, 1, 0.02);
}

TEST(Tetrahedralize, CupStandsOnItsFoot) {
  const TriangleMesh cup = shapes::cup();
  for (const int vertices : {76, 100, 125}) {
    const TetrahedralizeResult result = checked(cup, wanted("tetgen", vertices));
    const double floor = result.mesh.V.col(1).minCoeff();
    EXPECT_NEAR(floor, 0, 1e-9);
    EXPECT_GE((result.mesh.V.col(1).array() < floor + 1e-9).count(), 5) << vertices;
    EXPECT_NEAR(result.volume_ratio, 1, 0.15) << vertices;
    EXPECT_EQ(result.components, 1);
  }
}

TEST(Tetrahedralize, TorusKeepsItsHole) {
  const TetrahedralizeResult result = checked(shapes::torus(1, 0.35), wanted("tetgen", 150));
  EXPECT_EQ(euler_characteristic(boundary_faces(result.mesh)), 0);
}

TEST(Tetrahedralize, GapIsClosedOnRequest) {
  TetrahedralizeSettings settings = wanted("tetgen", 150);
  settings.gap = 0.45;  // the hole is 0.7 wide, the torus 3.1 in diagonal
  const TetrahedralizeResult result = checked(shapes::torus(1, 0.65, 48, 32), settings);
  EXPECT_EQ(euler_characteristic(boundary_faces(result.mesh)), 2);
  EXPECT_THAT(result.notes, testing::Contains(testing::HasSubstr("closed 1 of 1 holes")));
}

TEST(Tetrahedralize, SeparatePartsStaySeparate) {
  const TriangleMesh two = shapes::joined(shapes::sphere({0, 0, 0}, 1), shapes::sphere({3, 0, 0}, 1));
  EXPECT_EQ(checked(two, wanted("tetgen", 120)).components, 2);
  EXPECT_EQ(checked(two, wanted("cgal", 300)).components, 2);
}

TEST(Tetrahedralize, CgalFillsRoundBodies) {
  const TetrahedralizeResult sphere = checked(shapes::sphere({0, 0, 0}, 1, 4), wanted("cgal", 120));
  EXPECT_NEAR(sphere.volume_ratio, 1, 0.1);
  const TetrahedralizeResult box = checked(shapes::unit_box(), wanted("cgal", 400));
  EXPECT_NEAR(box.volume_ratio, 1, 0.1);
}

TEST(Tetrahedralize, CgalDoesNotLoseAThinWallSilently) {
  try {  // the wall is far too thin for 40 vertices of Delaunay refinement
    tetrahedralize(shapes::cup(48), wanted("cgal", 40));
    FAIL() << "a mesh that cannot resolve the wall was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::geometry);
    EXPECT_THAT(error.hint(), testing::HasSubstr("tetgen"));
  }
}

TEST(Tetrahedralize, IsDeterministic) {
  for (const std::string backend : {"tetgen", "cgal"}) {
    const TriangleMesh surface = backend == "cgal" ? shapes::sphere({0, 0, 0}, 1) : shapes::cup();
    const TetrahedralizeResult a = tetrahedralize(surface, wanted(backend, 100));
    const TetrahedralizeResult b = tetrahedralize(surface, wanted(backend, 100));
    EXPECT_EQ(a.mesh.V, b.mesh.V);
    EXPECT_EQ(a.mesh.T, b.mesh.T);
  }
}

TEST(Tetrahedralize, ScaleAndPlaceDoNotMatter) {
  const TriangleMesh sphere = shapes::sphere({0, 0, 0}, 1);
  for (const double factor : {1e-6, 1e6}) checked(shapes::scaled(sphere, factor), wanted("tetgen", 100));
  checked(shapes::scaled(sphere, 1, {1e5, 1e5, -1e5}), wanted("tetgen", 100));
}

TEST(Tetrahedralize, WorksOnARepairedSoup) {
  const TriangleMesh crossing = shapes::joined(shapes::sphere({0, 0, 0}, 1), shapes::sphere({1, 0, 0}, 1));
  const TetrahedralizeResult result = checked(repair_surface(crossing).mesh, wanted("tetgen", 100));
  EXPECT_EQ(result.components, 1);
}

TEST(Tetrahedralize, OpenSurfaceIsAnError) {
  for (const TriangleMesh& mesh : {shapes::open_box(), shapes::turned(shapes::unit_box())}) {
    EXPECT_THROW(tetrahedralize(mesh, wanted("tetgen", 100)), Error);
  }
}

TEST(Tetrahedralize, ImpossibleLimitsAreAnError) {
  TetrahedralizeSettings settings = wanted("tetgen", 100);
  settings.limits.seconds = 1e-3;
  try {
    tetrahedralize(shapes::sphere({0, 0, 0}, 1, 5), settings);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::geometry);
    EXPECT_THAT(error.what(), testing::HasSubstr("0.001 s"));
  }
}

TEST(TetrahedraSchema, ReadsSettings) {
  std::vector<Error> errors;
  const ConfigNode node = parse_yaml("{backend: cgal, vertices: 250, gap: 0.1}", "scene.yaml", errors);
  const Value value = resolve(tetrahedra_schema(), node, errors);
  ASSERT_TRUE(errors.empty());
  const TetrahedralizeSettings settings = tetrahedra_settings(value);
  EXPECT_EQ(settings.backend, "cgal");
  EXPECT_EQ(settings.vertices, 250);
  EXPECT_EQ(settings.gap, 0.1);
  EXPECT_EQ(settings.limits.seconds, 60);

  const ConfigNode wrong = parse_yaml("{backend: tetegn, vertices: 3}", "scene.yaml", errors);
  resolve(tetrahedra_schema(), wrong, errors);
  EXPECT_EQ(errors.size(), 2u);
}

}  // namespace
}  // namespace vivify::meshing

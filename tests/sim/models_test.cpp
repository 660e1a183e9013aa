// The models of Appendix A against their printed formulas, patch tests, and constants of the material.
#include "sim/elastic/models.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

constexpr double kEdge = 70000, kVolume = 50000;
const char* const kMaterial = "{type: solid3d, stiffness: 70000, volume_stiffness: 50000}";

Vector point(const Vector& x, int i) { return x.segment<3>(3 * i); }

double tet_volume(const Vector& x, const Eigen::Matrix<int, 1, 4>& t) {
  Eigen::Matrix3d edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = point(x, t[k + 1]) - point(x, t[0]);
  return edges.determinant() / 6;
}

// W_Solid3D as printed: Σ_e Σ_j k_l/12 (l² − L²)² V̄/L̄⁴ + ½ k_v (v − V)² / V̄, with X̄ the vertices of the mesh.
double printed_energy(const TetMesh& mesh, const Vector& X, const Vector& x) {
  const Vector reference = flat(mesh.V);
  double sum = 0;
  for (Eigen::Index e = 0; e < mesh.T.rows(); ++e) {
    const Eigen::Matrix<int, 1, 4> t = mesh.T.row(e);
    const double barred = tet_volume(reference, t);
    for (int a = 0; a < 4; ++a) {
      for (int b = a + 1; b < 4; ++b) {
        const double l = (point(x, t[a]) - point(x, t[b])).norm(),
                     L = (point(X, t[a]) - point(X, t[b])).norm();
        const double Lbar = (point(reference, t[a]) - point(reference, t[b])).norm();
        sum += kEdge / 12 * std::pow(l * l - L * L, 2) * barred / std::pow(Lbar, 4);
      }
    }
    sum += 0.5 * kVolume * std::pow(tet_volume(x, t) - tet_volume(X, t), 2) / barred;
  }
  return sum;
}

struct Energy {
  explicit Energy(const TetMesh& mesh, RestLayout layout = RestLayout::compatible)
      : model(build_model(sim_mesh(mesh), layout, settings(model_schema(), kMaterial)).families) {}

  double value(const Vector& X, const Vector& x) const {
    double sum = 0;
    for (const auto& family : model) {
      Vector s, S;
      family->values(Side::deformed, x, s);
      family->values(Side::rest, X, S);
      sum += family->law().energy({family->coefficients(), s, S});
    }
    return sum;
  }
  Vector gradient(const Vector& X, const Vector& x) const {
    Vector sum = Vector::Zero(x.size());
    for (const auto& family : model) {
      Vector s, S, g;
      family->gradients(Side::deformed, x, s, g);
      family->values(Side::rest, X, S);
      family->scatter(Side::deformed, g, family->law().stress({family->coefficients(), s, S}), sum);
    }
    return sum;
  }
  ElasticFamilies model;
};

TetMesh rough_box(std::uint64_t seed) {
  TetMesh mesh = small_box();
  CounterRng rng(seed);
  mesh.V += rows(random_vector(mesh.V.size(), 0.02, rng));
  return mesh;
}

TEST(Solid3d, IsThePrintedEnergy) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const TetMesh mesh = rough_box(seed);
    CounterRng rng(100 + seed);
    const Vector X = flat(mesh.V) + random_vector(mesh.V.size(), 0.02, rng);
    const Vector x = flat(mesh.V) + random_vector(mesh.V.size(), 0.05, rng);
    const double printed = printed_energy(mesh, X, x);
    EXPECT_GT(printed, 1);
    EXPECT_NEAR(Energy(mesh).value(X, x), printed, 1e-12 * printed);
  }
}

// Patch test: an affine map of a lattice leaves no force on inner vertices, and its energy is the closed form
// Σ V̄ (k_l/12 Σ_j (ê·(FᵀF − 1) ê)² + ½ k_v (det F − 1)²) with the unit edge vectors ê.
TEST(Solid3d, PatchTest) {
  const TetMesh mesh = box_mesh({3, 3, 3}, {0.6, 0.6, 0.6}, {0, 0, 0});
  const Triangles faces = boundary_faces(mesh);
  const Vector X = flat(mesh.V);
  const Energy energy(mesh);
  CounterRng rng(11);
  for (int trial = 0; trial < 5; ++trial) {
    Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
    for (int k = 0; k < 9; ++k) F(k) += rng.uniform(-0.2, 0.2);
    const Vector x = rigid(F, random_vector(3, 1, rng), X);
    const Vector g = energy.gradient(X, x);
    std::vector<bool> inner(static_cast<std::size_t>(mesh.V.rows()), true);
    for (Eigen::Index k = 0; k < faces.size(); ++k) inner[static_cast<std::size_t>(faces.data()[k])] = false;
    int count = 0;
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
      if (!inner[static_cast<std::size_t>(i)]) continue;
      ++count;
      EXPECT_LE(g.segment<3>(3 * i).lpNorm<Eigen::Infinity>(), 1e-12 * kEdge);
    }
    EXPECT_EQ(count, 8);
    EXPECT_GT(g.lpNorm<Eigen::Infinity>(), 1e-3 * kEdge);  // on the boundary

    const Eigen::Matrix3d strain = F.transpose() * F - Eigen::Matrix3d::Identity();
    double closed = 0;
    for (Eigen::Index e = 0; e < mesh.T.rows(); ++e) {
      double density = 0.5 * kVolume * std::pow(F.determinant() - 1, 2);
      for (int a = 0; a < 4; ++a) {
        for (int b = a + 1; b < 4; ++b) {
          const Eigen::Vector3d edge = (mesh.V.row(mesh.T(e, a)) - mesh.V.row(mesh.T(e, b))).normalized();
          density += kEdge / 12 * std::pow(edge.dot(strain * edge), 2);
        }
      }
      closed += density * tet_volume(X, mesh.T.row(e));
    }
    EXPECT_NEAR(energy.value(X, x), closed, 1e-12 * closed);
  }
}

TEST(Solid3d, EdgesSharedByElementsAreOneTerm) {
  const TetMesh mesh = small_box();
  const Energy energy(mesh);
  std::set<std::pair<int, int>> edges;
  for (Eigen::Index e = 0; e < mesh.T.rows(); ++e) {
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        if (mesh.T(e, a) < mesh.T(e, b)) edges.emplace(mesh.T(e, a), mesh.T(e, b));
      }
    }
  }
  EXPECT_EQ(energy.model[0]->size(), static_cast<int>(edges.size()));
  EXPECT_EQ(energy.model[1]->size(), mesh.T.rows());
}

}  // namespace
}  // namespace vivify::sim

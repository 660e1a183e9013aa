// The models of Appendix A against their printed formulas, evaluated element by element; patch tests; and the
// constants of the material. What all models share is in model_conformance_test.cpp.
#include "sim/elastic/models.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <map>
#include <numbers>
#include <set>

#include "sim/elastic/materials.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

constexpr double kPi = std::numbers::pi;

Value material(const std::string& yaml) { return settings(model_schema(), yaml); }

double energy(const ElasticModel& model, const Vector& X, const Vector& x) {
  double sum = 0;
  for (const auto& family : model.families) {
    Vector s, S;
    family->values(Side::deformed, x, s);
    family->values(Side::rest, X, S);
    sum += family->law().energy({family->coefficients(), s, S});
  }
  return sum;
}
double energy(const SimMesh& mesh, const std::string& yaml, const Vector& X, const Vector& x) {
  return energy(build_model(mesh, RestLayout::compatible, material(yaml)), X, x);
}
Vector gradient(const ElasticModel& model, const Vector& X, const Vector& x) {
  Vector sum = Vector::Zero(x.size());
  for (const auto& family : model.families) {
    Vector s, S, g;
    family->gradients(Side::deformed, x, s, g);
    family->values(Side::rest, X, S);
    family->scatter(Side::deformed, g, family->law().stress({family->coefficients(), s, S}), sum);
  }
  return sum;
}

// The printed formulas, with k_l = 70, k_a = k_v = 50 and k_b = 3; X̄ are the vertices of the mesh.
constexpr double kStretch = 70, kSize = 50, kBend = 3;

struct Shapes {
  const SimMesh& mesh;
  Vector bar, X, x;  // X̄, X, x
  Vector at(const Vector& shape, int vertex) const {
    return shape.segment(mesh.dimension() * vertex, mesh.dimension());
  }
  double length(const Vector& shape, int a, int b) const { return (at(shape, b) - at(shape, a)).norm(); }
  // Edges of an element from its first point, a column each.
  Matrix edges(const Vector& shape, Eigen::Index e) const {
    Matrix D(mesh.dimension(), mesh.element_points() - 1);
    for (int k = 0; k < D.cols(); ++k) D.col(k) = at(shape, mesh.E(e, k + 1)) - at(shape, mesh.E(e, 0));
    return D;
  }
};

double solid3d_energy(const Shapes& s) {
  double sum = 0;
  for (Eigen::Index e = 0; e < s.mesh.E.rows(); ++e) {
    const double bar = s.edges(s.bar, e).determinant() / 6, v = s.edges(s.x, e).determinant() / 6,
                 V = s.edges(s.X, e).determinant() / 6;
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < i; ++j) {
        const int a = s.mesh.E(e, i), b = s.mesh.E(e, j);
        sum += kStretch / 12 *
               std::pow(std::pow(s.length(s.x, a, b), 2) - std::pow(s.length(s.X, a, b), 2), 2) * bar /
               std::pow(s.length(s.bar, a, b), 4);
      }
    }
    sum += 0.5 * kSize * std::pow(v - V, 2) / bar;
  }
  return sum;
}

// ½ k_l ‖E‖² Ā + ½ k_a (a − A)²/Ā with E = ½ (D̄⁻ᵀ (DᵀD − D_XᵀD_X) D̄⁻¹), or with F = D D_X⁻¹ as printed.
double green_energy(const Shapes& s, bool printed) {
  double sum = 0;
  const double factorial = s.mesh.dimension() == 2 ? 2 : 6;
  for (Eigen::Index e = 0; e < s.mesh.E.rows(); ++e) {
    const Matrix bar = s.edges(s.bar, e), D = s.edges(s.x, e), R = s.edges(s.X, e);
    const double size = bar.determinant() / factorial;
    const Matrix inverse = bar.inverse(), F = D * R.inverse();
    const Matrix E =
        printed ? Matrix(0.5 * (F.transpose() * F - Matrix::Identity(F.rows(), F.rows())))
                : Matrix(0.5 * inverse.transpose() * (D.transpose() * D - R.transpose() * R) * inverse);
    sum += 0.5 * kStretch * size * E.squaredNorm() +
           0.5 * kSize * std::pow((D.determinant() - R.determinant()) / factorial, 2) / size;
  }
  return sum;
}

double rod_energy(const Shapes& s, bool printed) {
  double sum = 0;
  std::map<int, int> next;
  for (Eigen::Index e = 0; e < s.mesh.E.rows(); ++e) next[s.mesh.E(e, 0)] = s.mesh.E(e, 1);
  const auto angle = [&](const Vector& shape, int a, int b, int c) {
    const Vector u = s.at(shape, b) - s.at(shape, a), v = s.at(shape, c) - s.at(shape, b);
    return std::remainder(std::atan2(v[1], v[0]) - std::atan2(u[1], u[0]), 2 * kPi);
  };
  for (const auto& [a, b] : next) {
    const double l = s.length(s.x, a, b), L = s.length(s.X, a, b), bar = s.length(s.bar, a, b);
    sum += 0.5 * kStretch * std::pow(l * l - L * L, 2) / std::pow(bar, 3);
    if (next.count(b) == 0) continue;
    const double T = 0.5 * (bar + s.length(s.bar, b, next[b]));
    sum += 0.5 * kBend * std::pow(angle(s.x, a, b, next[b]) - angle(s.X, a, b, next[b]), 2) *
           (printed ? T : 1 / T);
  }
  return sum;
}

double shell_energy(const Shapes& s, bool printed) {
  double sum = 0;
  std::map<std::pair<int, int>, int> opposite;  // directed edge -> third vertex
  const auto area = [&](int a, int b, int c) {
    const Eigen::Vector3d u = s.at(s.bar, b) - s.at(s.bar, a), v = s.at(s.bar, c) - s.at(s.bar, a);
    return 0.5 * u.cross(v).norm();
  };
  for (Eigen::Index t = 0; t < s.mesh.E.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = s.mesh.E(t, k), b = s.mesh.E(t, (k + 1) % 3), c = s.mesh.E(t, (k + 2) % 3);
      opposite[{a, b}] = c;
      sum += kStretch / 6 * std::pow(std::pow(s.length(s.x, a, b), 2) - std::pow(s.length(s.X, a, b), 2), 2) *
             area(a, b, c) / std::pow(s.length(s.bar, a, b), 4);
    }
  }
  // The angle between the normals, by its cosine, with the sign of a valley or a ridge.
  const auto angle = [&](const Vector& shape, int a, int b, int c, int d) {
    const Eigen::Vector3d e = s.at(shape, b) - s.at(shape, a), u = s.at(shape, c) - s.at(shape, a),
                          v = s.at(shape, d) - s.at(shape, a);
    const Eigen::Vector3d n = e.cross(u).normalized(), m = v.cross(e).normalized();
    return std::copysign(std::acos(n.dot(m)), n.cross(m).dot(e));
  };
  for (const auto& [edge, c] : opposite) {
    const auto [a, b] = edge;
    if (a > b || opposite.count({b, a}) == 0) continue;
    const int d = opposite[{b, a}];
    const double length = s.length(s.bar, a, b), both = area(a, b, c) + area(b, a, d);
    const double weight = printed ? both / 3 : 3 * length * length / both;
    sum += 0.5 * kBend * weight * std::pow(angle(s.x, a, b, c, d) - angle(s.X, a, b, c, d), 2);
  }
  return sum;
}

TEST(Models, ArePrintedEnergies) {
  using Printed = double (*)(const Shapes&);
  const std::string size = "stiffness: 70, volume_stiffness: 50",
                    bend = "stiffness: 70, bending_stiffness: 3";
  const std::vector<std::tuple<std::string, std::string, Printed>> models = {
      {"solid3d", size, [](const Shapes& s) { return solid3d_energy(s); }},
      {"solid3d_stvk", size, [](const Shapes& s) { return green_energy(s, false); }},
      {"solid2d", size, [](const Shapes& s) { return green_energy(s, false); }},
      {"solid2d_printed", size, [](const Shapes& s) { return green_energy(s, true); }},
      {"rod2d", bend, [](const Shapes& s) { return rod_energy(s, false); }},
      {"rod2d", bend + ", bending_scaling: paper", [](const Shapes& s) { return rod_energy(s, true); }},
      {"shell3d", bend, [](const Shapes& s) { return shell_energy(s, false); }},
      {"shell3d", bend + ", bending_scaling: paper", [](const Shapes& s) { return shell_energy(s, true); }}};
  std::set<std::string> tested;
  for (const auto& [name, keys, printed] : models) {
    const std::string yaml = "{type: " + name + ", " + keys + "}";
    const ModelEntry& entry = model_entry(material(yaml));
    for (const NamedMesh& named : small_meshes(entry.dimension, entry.element_points)) {
      for (std::uint64_t seed = 0; seed < 5; ++seed) {
        CounterRng rng(seed);
        const Vector bar = flat(named.mesh.V);
        const Shapes shapes{named.mesh, bar, bar + random_vector(bar.size(), 0.02, rng),
                            bar + random_vector(bar.size(), 0.03, rng)};
        const double expected = printed(shapes);
        EXPECT_GT(expected, 1e-3);
        EXPECT_NEAR(energy(named.mesh, yaml, shapes.X, shapes.x), expected, 1e-10 * expected)
            << yaml << named.name;
      }
    }
    tested.insert(name);
  }
  EXPECT_EQ(tested.size(), elastic_models().size()) << "every model has its formula here";
}

// Joints and hinges that pass through ±π from the rest shape to the deformed one have turned by little.
TEST(Models, FoldsPassThroughAStraightAngle) {
  for (const double sign : {1.0, -1.0}) {
    const auto rod = [&](double angle) {
      RowMatrixXd V(3, 2);
      V << 0, 0, 0.2, 0, 0.2 + 0.2 * std::cos(angle), 0.2 * std::sin(angle);
      return V;
    };
    const SimMesh mesh{rod(sign * (kPi - 0.05)), (RowMatrixXi(2, 2) << 0, 1, 1, 2).finished()};
    const ElasticModel model =
        build_model(mesh, RestLayout::compatible, material("{type: rod2d, bending_stiffness: 3}"));
    const Vector X = flat(mesh.V), x = flat(rod(sign * (0.03 - kPi)));
    EXPECT_NEAR(energy(model, X, x), 0.5 * 3 * 0.08 * 0.08 / 0.2, 1e-12);
    const auto value = [&](const Vector& y) { return Vector::Constant(1, energy(model, X, y)); };
    EXPECT_LE(relative(gradient(model, X, x).transpose(), differences(value, x, 1e-7)), 1e-6);

    const auto hinge = [&](double angle) {
      RowMatrixXd V(4, 3);
      V << 0, 0, 0, 0.3, 0, 0, 0.1, 0.2, 0, 0.1, -0.2 * std::cos(angle), -0.2 * std::sin(angle);
      return V;
    };
    const SimMesh wings{hinge(sign * (kPi - 0.05)), (RowMatrixXi(2, 3) << 0, 1, 2, 1, 0, 3).finished()};
    const ElasticModel shell =
        build_model(wings, RestLayout::compatible, material("{type: shell3d, bending_stiffness: 3}"));
    EXPECT_NEAR(energy(shell, flat(wings.V), flat(hinge(sign * (0.03 - kPi)))),
                0.5 * 3 * (3 * 0.09 / 0.06) * 0.08 * 0.08, 1e-12);
  }
}

// Patch test: an affine map of a lattice leaves no force on inner vertices. (On other meshes edges alone give
// no homogeneous stress; Green strain and area or volume do.)
TEST(Models, PatchTests) {
  const SimMesh lattice = sim_mesh(box_mesh({3, 3, 3}, {0.6, 0.6, 0.6}, {0, 0, 0}));
  SimMesh rough = lattice, sheet = small_meshes(2, 3).front().mesh;
  CounterRng rng(11);
  rough.V += random_vector(rough.V.size(), 0.03, rng).reshaped(rough.V.rows(), 3);
  const std::vector<std::pair<std::string, SimMesh>> patches = {
      {"solid3d", lattice}, {"solid3d_stvk", rough}, {"solid2d", sheet}, {"solid2d_printed", sheet}};
  for (const auto& [name, mesh] : patches) {
    const int d = mesh.dimension();
    const ElasticModel model = build_model(mesh, RestLayout::compatible, material("{type: " + name + "}"));
    const Vector X = flat(mesh.V);
    const Eigen::RowVectorXd low = lattice.V.colwise().minCoeff(), high = lattice.V.colwise().maxCoeff();
    for (int trial = 0; trial < 3; ++trial) {
      const Matrix F = Matrix::Identity(d, d) + random_vector(d * d, 0.2, rng).reshaped(d, d);
      const Vector g = gradient(model, X, moved(F, random_vector(d, 1, rng), X));
      int inner = 0;
      for (int v = 0; v < mesh.V.rows(); ++v) {
        const bool inside =
            d == 2 ? v == 4
                   : (lattice.V.row(v) - low).minCoeff() > 0.1 && (high - lattice.V.row(v)).minCoeff() > 0.1;
        if (!inside) continue;
        ++inner;
        EXPECT_LE(g.segment(d * v, d).norm(), 1e-12 * g.norm()) << name << ", vertex " << v;
      }
      EXPECT_EQ(inner, d == 2 ? 1 : 8);
      EXPECT_GT(g.norm(), 1);
    }
  }
}

TEST(Solid3d, EdgesSharedByElementsAreOneTerm) {
  const SimMesh mesh = sim_mesh(small_box());
  const ElasticModel model = build_model(mesh, RestLayout::compatible, material("{type: solid3d}"));
  std::set<std::pair<int, int>> edges;
  for (Eigen::Index e = 0; e < mesh.E.rows(); ++e) {
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        if (mesh.E(e, a) < mesh.E(e, b)) edges.emplace(mesh.E(e, a), mesh.E(e, b));
      }
    }
  }
  EXPECT_EQ(model.families[0]->size(), static_cast<int>(edges.size()));
  EXPECT_EQ(model.families[1]->size(), mesh.E.rows());
}

// Mean over all directions of a function that is a polynomial of degree 4 in them: over rotations about y, z,
// y at the nodes of an exact rule.
template <class F>
double mean_over_rotations(int d, const F& f) {
  const double nodes[] = {-std::sqrt(0.6), 0, std::sqrt(0.6)}, weights[] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  double sum = 0;
  for (int i = 0; i < 5; ++i) {
    const double a = 2 * kPi * i / 5;
    if (d == 2) {
      sum += f(Eigen::Rotation2Dd(a).toRotationMatrix()) / 5;
      continue;
    }
    for (int j = 0; j < 5; ++j) {
      for (int n = 0; n < 3; ++n) {
        const Eigen::AngleAxisd first(a, Eigen::Vector3d::UnitY()),
            second(std::acos(nodes[n]), Eigen::Vector3d::UnitZ()),
            third(2 * kPi * j / 5, Eigen::Vector3d::UnitY());
        sum += weights[n] / 25 * f((first * second * third).toRotationMatrix());
      }
    }
  }
  return sum;
}

// Small strains cost what linear elasticity says, μ ε:ε + λ/2 (tr ε)²: for the simplified tetrahedron, whose
// edges have directions, in the mean over them.
TEST(Materials, YoungAndPoissonAreThoseOfLinearElasticity) {
  const double young = 5e4, poisson = 0.35, mu = young / (2 * (1 + poisson));
  const double lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson)),
               plane_stress = young * poisson / (1 - poisson * poisson);
  for (const auto& [name, expected] : {std::pair<std::string, double>{"solid2d", plane_stress},
                                       {"solid2d_printed", plane_stress},
                                       {"solid3d", lambda},
                                       {"solid3d_stvk", lambda}}) {
    const std::string yaml = "{type: " + name + ", young: 50000, poisson: 0.35}";
    const ModelEntry& entry = model_entry(material(yaml));
    const SimMesh mesh = small_meshes(entry.dimension, entry.element_points).front().mesh;
    const ElasticModel model = build_model(mesh, RestLayout::compatible, material(yaml));
    const int d = entry.dimension;
    const Vector X = flat(mesh.V);
    CounterRng rng(4);
    for (int trial = 0; trial < 3; ++trial) {
      Matrix strain = random_vector(d * d, 1, rng).reshaped(d, d);
      strain = (0.5 * (strain + strain.transpose())).eval();
      const double density = mu * strain.squaredNorm() + 0.5 * expected * std::pow(strain.trace(), 2);
      const double measured = mean_over_rotations(d, [&](const Matrix& R) {
        const double tiny = 1e-5;
        const auto of = [&](double size) {
          const Matrix F = Matrix::Identity(d, d) + size * R * strain * R.transpose();
          return energy(model, X, moved(F, Vector::Zero(d), X));
        };
        return (of(tiny) + of(-tiny)) / (2 * tiny * tiny);
      });
      EXPECT_NEAR(measured / element_sizes(mesh).sum(), density, 1e-4 * density) << name;
    }
  }
}

// A rod of rectangular section stretches with EA = Y t and bends with EI = Y t³/12; a shell is a sheet of
// Poisson's ratio 1/3 of the thickness t.
TEST(Materials, ThicknessGivesTheStiffnessOfASection) {
  const double young = 2e6, t = 0.03;
  const std::string keys = ", young: 2000000, thickness: 0.03}";
  const int n = 40;
  SimMesh rod{RowMatrixXd::Zero(n + 1, 2), RowMatrixXi(n, 2)};
  for (int i = 0; i <= n; ++i) rod.V(i, 0) = 1.0 * i / n;
  for (int i = 0; i < n; ++i) rod.E.row(i) << i, i + 1;
  const ElasticModel model = build_model(rod, RestLayout::compatible, material("{type: rod2d" + keys));
  const double tiny = 1e-5;
  EXPECT_NEAR(energy(model, flat(rod.V), (1 + tiny) * flat(rod.V)), 0.5 * young * t * tiny * tiny,
              1e-4 * 0.5 * young * t * tiny * tiny);
  const double curvature = 0.5;
  RowMatrixXd arc = rod.V;
  double angle = 0;
  for (int i = 1; i <= n; ++i, angle += curvature / n) {
    arc.row(i) = arc.row(i - 1) + Eigen::RowVector2d(std::cos(angle), std::sin(angle)) / n;
  }
  const double bending = 0.5 * young * std::pow(t, 3) / 12 * curvature * curvature * (n - 1) / n;
  EXPECT_NEAR(energy(model, flat(rod.V), flat(arc)), bending, 1e-9 * bending);

  SimMesh sheet = small_meshes(2, 3).front().mesh;
  sheet.V.conservativeResize(Eigen::NoChange, 3);
  sheet.V.col(2).setZero();
  const ElasticModel shell = build_model(sheet, RestLayout::compatible, material("{type: shell3d" + keys));
  const double poisson = 1.0 / 3, mu = young * t / (2 * (1 + poisson)),
               lambda = young * t * poisson / (1 - poisson * poisson);
  Eigen::Matrix2d strain;
  strain << 0.7, 0.2, 0.2, -0.4;
  const double density = mu * strain.squaredNorm() + 0.5 * lambda * std::pow(strain.trace(), 2);
  const double measured = mean_over_rotations(2, [&](const Matrix& R) {
    Matrix F = Matrix::Identity(3, 3);
    F.topLeftCorner(2, 2) += tiny * R * strain * R.transpose();
    return energy(shell, flat(sheet.V), moved(F, Vector::Zero(3), flat(sheet.V))) / (tiny * tiny);
  });
  EXPECT_NEAR(measured / element_sizes(sheet).sum(), density, 1e-3 * density);
}

TEST(Materials, RatiosThatTheModelCannotHaveAreRefused) {
  const SimMesh mesh = small_meshes(3, 4).front().mesh;
  EXPECT_THROW(
      build_model(mesh, RestLayout::compatible, material("{type: solid3d, young: 1000, poisson: 0.2}")),
      Error);
  EXPECT_NO_THROW(
      build_model(mesh, RestLayout::compatible, material("{type: solid3d_stvk, young: 1000, poisson: 0.2}")));
}

TEST(Materials, WarningsNameTheRegion) {
  const auto warnings = [](const std::string& yaml) { return model_warnings(material(yaml)); };
  EXPECT_TRUE(warnings("{type: solid2d}").empty());
  EXPECT_EQ(warnings("{type: solid2d, stiffness: 100, volume_stiffness: 10}").size(), 1u);
  const auto both = warnings(
      "{type: solid3d, stiffness: 100, volume_stiffness: 1, regions: [{}, {stiffness: 100, volume_stiffness: "
      "2}]}");
  ASSERT_EQ(both.size(), 2u);
  EXPECT_EQ(both[0].rfind("model: ", 0), 0u) << both[0];
  EXPECT_EQ(both[1].rfind("model.regions[1]: ", 0), 0u) << both[1];
}

}  // namespace
}  // namespace vivify::sim

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>

#include "bench/validation/bodies.h"
#include "bench/validation/lattice.h"
#include "bench/validation/problem.h"

namespace vivify::validation {
namespace {

constexpr double kStretch = 1e4, kSize = 8e3;

struct Patch {
  std::string model;
  SimMesh lattice;
  bool any_mesh;  // passes on rough meshes too
};

std::vector<Patch> patches() {
  return {{"rod2d", chain(8, 0, 1), false},
          {"solid2d", rectangle(6, 5, 1.2, 1), true},
          {"solid2d_printed", rectangle(6, 5, 1.2, 1), true},
          {"shell3d", equilateral_strip(6, 1, 0, 1.2), false},
          {"solid3d", box(4, 3, 4, 1, 0.9, 1.1), false},
          {"solid3d_stvk", box(4, 3, 4, 1, 0.9, 1.1), true}};
}

sim::BodyModel patch_body(const std::string& model, const SimMesh& mesh) {
  const bool thin = model == "rod2d" || model == "shell3d";
  return body(mesh, "{type: " + model + ", stiffness: " + std::to_string(kStretch) + ", " +
                        (thin ? "bending_stiffness: 10" : "volume_stiffness: " + std::to_string(kSize)) +
                        "}");
}

Matrix random_matrix(int d, CounterRng& rng) { return random_vector(d * d, 1, rng).reshaped(d, d); }

Vector mapped(const RowMatrixXd& V, const Matrix& F, const Vector& b) {
  RowMatrixXd image = V * F.transpose();
  image.rowwise() += b.transpose();
  return flat(image);
}

// Largest force on an inner vertex over the stiffness k: the largest entry of the stiffness matrix times the
// shortest edge.
double inner_force(const sim::BodyModel& body, const Vector& x) {
  const int d = body.dimension();
  const std::vector<bool> boundary = boundary_vertices(body.mesh);
  const Vector g = gradient(body, body.S0, x);
  sim::SymmetricMatrix D(*body.pattern);
  stiffness(body, body.S0, flat(body.mesh.V), D);
  const double k = D.lower().diagonal().maxCoeff() * shortest_edge(body.mesh);
  Largest force;
  for (Eigen::Index i = 0; i < g.size(); i += d) {
    if (!boundary[static_cast<std::size_t>(i / d)]) force.add(g.segment(i, d).norm() / k);
  }
  return force.value;
}

}  // namespace

Result patch(Effort) {
  Result result;
  result.title = "Patch test, rigid motions, rotated copies";
  result.text =
      "An affine map x = F X + b must leave no force on inner vertices, to 1e-12 of k, the largest entry of "
      "the "
      "stiffness matrix times the shortest edge. The Green-strain solids pass on any mesh; models of edges "
      "(`rod2d`, "
      "`shell3d`, `solid3d`) on lattices that are point symmetric about their vertices, where the forces of "
      "opposite "
      "edges cancel, and not on rough meshes (the plot has both: the price of the simplified tetrahedron). "
      "The energy of "
      "Green-strain solids is the closed form V (½ k_l ‖½ (FᵀF − 1)‖² + ½ k (det F − 1)²). Rigid motions of "
      "any mesh "
      "give no force at all, and a rotated copy of a deformed body has the rotated forces.";
  Plot plot{"patch", "Patch test: force on inner vertices", "size of the affine strain", "force over k", true,
            true};
  for (const Patch& patch : patches()) {
    const int d = patch.lattice.dimension();
    const SimMesh rough = roughened(patch.lattice, 0.15, 3);
    const sim::BodyModel regular = patch_body(patch.model, patch.lattice),
                         irregular = patch_body(patch.model, rough);
    CounterRng rng(17);
    Largest lattice_force, rough_force, rigid, copies, closed_form;
    Curve on_lattice{patch.model + ", lattice"}, on_rough{patch.model + ", rough"};
    for (const double size : {0.003, 0.01, 0.03, 0.1, 0.3}) {
      Matrix stretch = random_matrix(d, rng);
      // Thin bodies: maps within their line or plane.
      if (patch.model == "rod2d") stretch.col(1).setZero();
      if (patch.model == "shell3d") stretch.row(1).setZero(), stretch.col(1).setZero();
      const Matrix F = Matrix::Identity(d, d) + size * stretch / stretch.norm();
      const Vector b = random_vector(d, 1, rng);
      const double a = inner_force(regular, mapped(patch.lattice.V, F, b)),
                   c = inner_force(irregular, mapped(rough.V, F, b));
      on_lattice.add(size, a);
      on_rough.add(size, c);
      lattice_force.add(a);
      rough_force.add(c);
      if (patch.any_mesh) {
        const double J = F.determinant();
        const double green = (0.5 * (F.transpose() * F - Matrix::Identity(d, d))).squaredNorm();
        const double W =
            element_sizes(rough).sum() * (0.5 * kStretch * green + 0.5 * kSize * (J - 1) * (J - 1));
        closed_form.add(std::abs(energy(irregular, irregular.S0, mapped(rough.V, F, b)) - W) / W);
      }
      Matrix R = Eigen::HouseholderQR<Matrix>(random_matrix(d, rng)).householderQ();
      if (R.determinant() < 0) R.col(0) *= -1;
      sim::SymmetricMatrix D(*irregular.pattern);
      const Vector X = flat(rough.V);
      stiffness(irregular, irregular.S0, X, D);
      rigid.add(gradient(irregular, irregular.S0, mapped(rough.V, R, b)).lpNorm<Eigen::Infinity>() /
                (D.lower().diagonal().maxCoeff() * shortest_edge(rough)));
      const Vector x = X + random_vector(X.size(), 0.1 * shortest_edge(rough), rng);
      const RowMatrixXd deformed = x.reshaped<Eigen::RowMajor>(x.size() / d, d),
                        force =
                            gradient(irregular, irregular.S0, x).reshaped<Eigen::RowMajor>(x.size() / d, d);
      const Vector turned = gradient(irregular, irregular.S0, mapped(deformed, R, b));
      copies.add((turned - mapped(force, R, Vector::Zero(d))).norm() / turned.norm());
    }
    result.figure(patch.model + ": force on inner vertices of a lattice over k", lattice_force.value, 0,
                  1e-12);
    if (patch.any_mesh) {
      result.figure(patch.model + ": force on inner vertices of a rough mesh over k", rough_force.value, 0,
                    1e-12);
      result.figure(patch.model + ": energy beside the closed form, relative difference", closed_form.value,
                    0, 1e-10);
    }
    result.figure(patch.model + ": force of a rigid motion over k", rigid.value, 0, 1e-12);
    result.figure(patch.model + ": forces of rotated copies, relative difference", copies.value, 0, 1e-11);
    plot.curves.push_back(std::move(on_lattice));
    plot.curves.push_back(std::move(on_rough));
  }
  Curve tolerance{"tolerance", {}, {}, true};
  for (const double size : {0.003, 0.3}) tolerance.add(size, 1e-12);
  plot.curves.push_back(std::move(tolerance));
  result.plots.push_back(std::move(plot));
  return result;
}

}  // namespace vivify::validation

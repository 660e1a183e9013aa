#include "bench/validation/beam.h"

#include <Eigen/LU>
#include <cmath>
#include <cstdio>

#include "bench/validation/lattice.h"

namespace vivify::validation {

using namespace sim;

namespace {

constexpr double kYoung = 1.2e6;  // Pa, or N/m in the plane
constexpr double kPoisson = 0.3;
constexpr double kDensity = 100;
constexpr double kShearShare = 5.0 / 6;  // shear coefficient of a rectangular section

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

Beam held_where(Beam beam, const std::vector<int>& vertices) {
  beam.held.assign(static_cast<std::size_t>(beam.body.mesh.V.rows()), false);
  for (const int v : vertices) beam.held[static_cast<std::size_t>(v)] = true;
  beam.X = flat(beam.body.mesh.V);
  return beam;
}

// The first joint turns by the curvature over a whole edge, half of it before the joint: a clamp at x = 0
// lies in the middle of the held edge.
Beam rod(int edges, double slenderness, const std::string& scaling) {
  Beam beam;
  beam.length = 1;
  const double edge = beam.length / (edges - 0.5), thickness = beam.length / slenderness;
  beam.EI = kYoung * std::pow(thickness, 3) / 12;
  beam.EA = kYoung * thickness;
  beam.GA = INFINITY;
  beam.line_density = kDensity;
  beam.body = body(chain(edges, -edge / 2, beam.length),
                   "{type: rod2d, density: " + number(kDensity) + ", young: " + number(kYoung) +
                       ", thickness: " + number(thickness) + ", bending_scaling: " + scaling + "}");
  beam.tip = Vector::Unit(edges + 1, edges);
  return held_where(std::move(beam), {0, 1});
}

std::string solid_yaml(const std::string& model) {
  return "{type: " + model + ", density: " + number(kDensity) + ", young: " + number(kYoung) +
         ", poisson: " + number(kPoisson) + "}";
}

// Shares of a force on the section x = length: those of the area of the section.
Vector section_shares(const SimMesh& mesh, double length, const Vector& mass) {
  Vector shares = Vector::Zero(mesh.V.rows());
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
    if (mesh.V(i, 0) > length * (1 - 1e-9)) shares[i] = mass[i];
  }
  return shares / shares.sum();
}

Beam solid(const std::string& model, int cells, double slenderness) {
  Beam beam;
  beam.length = 1;
  const double height = beam.length / slenderness;
  const int along = static_cast<int>(std::lround(cells * slenderness));
  const bool plane = model.starts_with("solid2d");
  const double width = plane ? 1 : height;
  beam.body = body(plane ? rectangle(along, cells, beam.length, height)
                         : box(along, cells, cells, beam.length, height, width),
                   solid_yaml(model));
  const Matrix C = uniform_strain_stiffness(beam.body);
  const double young = 1 / C.inverse()(0, 0), shear = C(C.rows() - 1, C.cols() - 1);
  beam.EI = young * width * std::pow(height, 3) / 12;
  beam.EA = young * width * height;
  beam.GA = kShearShare * shear * width * height;
  beam.line_density = kDensity * width * height;
  beam.tip = section_shares(beam.body.mesh, beam.length, beam.body.mass);
  std::vector<int> clamp;
  for (int i = 0; i < beam.body.mesh.V.rows(); ++i) {
    if (beam.body.mesh.V(i, 0) < 1e-9) clamp.push_back(i);
  }
  return held_where(std::move(beam), clamp);
}

// The strip of Sze et al. 2004 is 10 by 1 by 0.1. The rows of vertices end in steps of half an edge: the
// clamp and the end section lie in the middle of the steps.
Beam shell(int rows, double slenderness, const std::string& scaling) {
  Beam beam;
  const double width = 1, thickness = 0.1, edge = width / rows / std::sqrt(0.75);
  beam.body = body(equilateral_strip(rows, width, -edge / 2, slenderness * width),
                   "{type: shell3d, density: " + number(kDensity) + ", young: " + number(kYoung) +
                       ", thickness: " + number(thickness) + ", bending_scaling: " + scaling + "}");
  const RowMatrixXd& V = beam.body.mesh.V;
  const int columns = static_cast<int>(V.rows()) / (rows + 1) - 1;
  beam.length = (columns - 0.25) * edge;
  beam.EI = kYoung * width * std::pow(thickness, 3) / 12;
  beam.EA = kYoung * width * thickness;
  beam.GA = INFINITY;
  beam.line_density = kDensity * width;
  beam.tip = Vector::Zero(V.rows());
  std::vector<int> clamp;
  for (int j = 0; j <= rows; ++j) {
    const int first = (columns + 1) * j;
    clamp.push_back(first);
    if (j % 2 == 0) clamp.push_back(first + 1);
    beam.tip[first + columns] = (j == 0 || j == rows ? 0.5 : 1.0) / rows;
  }
  return held_where(std::move(beam), clamp);
}

}  // namespace

Vector Beam::tip_force(int axis) const {
  const int d = body.dimension();
  Vector force = Vector::Zero(X.size());
  for (Eigen::Index i = 0; i < tip.size(); ++i) force[d * i + axis] = tip[i];
  return force;
}

Vector Beam::weight(int axis) const {
  const int d = body.dimension();
  Vector force = Vector::Zero(X.size());
  for (Eigen::Index i = 0; i < tip.size(); ++i) force[d * i + axis] = body.mass[i];
  return force;
}

Beam make_beam(const std::string& model, int cells, double slenderness, const std::string& scaling) {
  if (model == "rod2d") return rod(cells, slenderness, scaling);
  if (model == "shell3d") return shell(cells, slenderness, scaling);
  return solid(model, cells, slenderness);
}

std::vector<std::string> bending_models() {
  return {"rod2d", "solid2d", "solid2d_printed", "shell3d", "solid3d", "solid3d_stvk"};
}

Matrix uniform_strain_stiffness(const BodyModel& body) {
  // Second differences of the energy over unit strains; the energy is a polynomial of degree at most 6.
  const int d = body.dimension(), n = d == 2 ? 3 : 6;
  const Vector X = flat(body.mesh.V);
  const double volume = element_sizes(body.mesh).sum(), eps = 1e-3;
  const auto strained = [&](const Vector& e) {
    Eigen::Matrix3d strain = Eigen::Matrix3d::Zero();
    if (d == 2) {
      strain << e[0], e[2] / 2, 0, e[2] / 2, e[1], 0, 0, 0, 0;
    } else {
      strain << e[0], e[5] / 2, e[4] / 2, e[5] / 2, e[1], e[3] / 2, e[4] / 2, e[3] / 2, e[2];
    }
    Vector x = X;
    for (Eigen::Index i = 0; i < X.size(); i += d) {
      x.segment(i, d) += strain.topLeftCorner(d, d) * X.segment(i, d);
    }
    return energy(body, body.S0, x) / volume;
  };
  Matrix C(n, n);
  for (int a = 0; a < n; ++a) {
    for (int b = 0; b < n; ++b) {
      const auto at = [&](double u, double v) {
        return strained(eps * (u * Vector::Unit(n, a) + v * Vector::Unit(n, b)));
      };
      C(a, b) = (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * eps * eps);
    }
  }
  return C;
}

}  // namespace vivify::validation

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "bench/validation/bodies.h"
#include "bench/validation/lattice.h"
#include "bench/validation/problem.h"

namespace vivify::validation {
namespace {

constexpr double kStretch = 1e4;

SimMesh regular_triangle() {
  SimMesh mesh;
  mesh.V.resize(3, 2);
  mesh.V << 0, 0, 1, 0, 0.5, std::sqrt(0.75);
  mesh.E.resize(1, 3);
  mesh.E << 0, 1, 2;
  return mesh;
}
SimMesh regular_tetrahedron() {
  SimMesh mesh;
  mesh.V.resize(4, 3);
  mesh.V << 1, 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1;
  mesh.V /= std::sqrt(8);
  mesh.E.resize(1, 4);
  mesh.E << 0, 2, 1, 3;
  if (element_sizes(mesh)[0] < 0) std::swap(mesh.E(0, 2), mesh.E(0, 3));
  return mesh;
}
struct Element {
  std::string name, model;
  SimMesh mesh;
  double threshold;  // k_a/k_l or k_v/k_l; see the text
};

std::vector<Element> elements() {
  const double a = std::sqrt(0.8);
  return {
      {"solid2d", "solid2d", regular_triangle(), 1.0 / 6},
      {"solid2d_printed", "solid2d_printed", regular_triangle(), 1.0 / 6},
      {"solid3d", "solid3d", regular_tetrahedron(), 2 / (15 * a * (1 + a * a * a))},
      {"solid3d_stvk", "solid3d_stvk", regular_tetrahedron(), (2 * std::numbers::sqrt2 - 1) / 7},
  };
}

sim::BodyModel element_body(const Element& element, double ratio) {
  return body(element.mesh, "{type: " + element.model + ", stiffness: " + std::to_string(kStretch) +
                                ", volume_stiffness: " + std::to_string(ratio * kStretch) + "}");
}

// The element at rest under energy from x, and whether it is turned inside out there.
struct End {
  Vector x;
  bool inverted = false, converged = false;
};
End relax(const sim::BodyModel& body, const Vector& x) {
  const int d = body.dimension();
  const sim::StaticProblem problem{body.elastic, *body.pattern, body.S0, Vector::Zero(x.size()),
                                   std::vector<bool>(static_cast<std::size_t>(x.size() / d), false)};
  const sim::StaticSolution solution = solve_static(problem, x, 1e-12 * kStretch);
  SimMesh deformed = body.mesh;
  deformed.V = Eigen::Map<const RowMatrixXd>(solution.x.data(), x.size() / d, d);
  return {solution.x, element_sizes(deformed)[0] < 0, solution.converged};
}

Vector mapped(const SimMesh& mesh, const Matrix& F) { return flat(RowMatrixXd(mesh.V * F.transpose())); }

// The largest ratio at which a stable inverted state continues the mirror image of the element: first by
// steps of 2 %, then by bisection, each from the last such state with a little noise that shakes off saddles.
double threshold(const Element& element) {
  CounterRng rng(7);
  const int d = element.mesh.dimension();
  Matrix mirror = Matrix::Identity(d, d);
  mirror(0, 0) = -1;
  double low = 0.01, high = 1;
  Vector state = relax(element_body(element, low), mapped(element.mesh, mirror)).x;
  while (high - low > 1e-6) {
    const double middle = high == 1 ? 1.02 * low : 0.5 * (low + high);
    Vector start = state;
    for (double& value : start) value += rng.uniform(-1e-6, 1e-6);
    const End end = relax(element_body(element, middle), start);
    if (end.inverted) {
      low = middle;
      state = end.x;
    } else {
      high = middle;
    }
  }
  return low;
}

// Affine maps with edges of up to 1.5 times their length: turned inside out, or flattened to a tenth or less.
Matrix random_start(int d, bool flattened, CounterRng& rng) {
  Matrix F(d, d);
  do {
    for (double& value : F.reshaped()) value = rng.uniform(-1.5, 1.5);
  } while (F.determinant() > 0);
  if (flattened) F.row(0) *= -0.1 / std::max(1.0, -F.determinant());
  return F;
}

// Share of random starts that come to rest turned inside out.
double share_inverted(const Element& element, double ratio, int starts) {
  CounterRng rng(3);
  const sim::BodyModel body = element_body(element, ratio);
  int inverted = 0;
  for (int i = 0; i < starts; ++i) {
    const Matrix F = random_start(body.dimension(), i % 2 == 1, rng);
    inverted += relax(body, mapped(element.mesh, F)).inverted;
  }
  return static_cast<double>(inverted) / starts;
}

// Share of random tetrahedra, of at least a tenth of the volume of a regular one with their longest edge,
// that a random start leaves inverted.
double share_of_shapes(double ratio, int shapes, int starts) {
  CounterRng rng(11);
  int inverted = 0;
  for (int i = 0; i < shapes;) {
    SimMesh mesh = regular_tetrahedron();
    mesh.V += random_vector(12, 0.5, rng).reshaped(4, 3);
    double longest = 0;
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < a; ++b) longest = std::max(longest, (mesh.V.row(a) - mesh.V.row(b)).norm());
    }
    if (element_sizes(mesh)[0] * 6 * std::numbers::sqrt2 < 0.1 * std::pow(longest, 3)) continue;
    ++i;
    const sim::BodyModel body = element_body({"", "solid3d", mesh, 0}, ratio);
    bool any = false;
    for (int k = 0; k < starts; ++k) any |= relax(body, mapped(mesh, random_start(3, false, rng))).inverted;
    inverted += any;
  }
  return static_cast<double>(inverted) / shapes;
}

}  // namespace

Result inversion(Effort effort) {
  Result result;
  result.title = "Recovery of elements that are turned inside out";
  result.text =
      "One free element, without forces. Its measure of size is monotone through zero, so it comes back from "
      "any "
      "start when k_a (k_v) is large enough beside k_l. Reference: the state −a·1 (with a mirror image, up "
      "to a "
      "rotation) balances stretch and size, and loses its stability against a change of shape that keeps the "
      "size. "
      "With λ the ratio k_a/k_l or k_v/k_l:\n\n"
      "- Green strain in the plane, W/k_l = ⅛ Σ (a_i² − 1)² + ½ λ (a₁a₂ + 1)²: at a² = 1/2, hence λ = 1/6.\n"
      "- Green strain in space, W/k_l = ⅛ Σ (a_i² − 1)² + ½ λ (a₁a₂a₃ + 1)²: at a² = 1/2 too, hence λ = "
      "(2√2 − 1)/7 = 0.2612. The bound 1/6 of the plane does not hold here.\n"
      "- Edges of a regular tetrahedron, W/k_l = (1/6) Σ_{i<j} (½ (a_i² + a_j²) − 1)² + ½ λ (a₁a₂a₃ + 1)²: "
      "at a² = "
      "4/5, hence λ = 2/(15 a (1 + a³)) = 0.0869 (remembered: 0.087). Other "
      "shapes recover earlier: the table has random tetrahedra.\n\n"
      "`check` warns below these bounds (0.1 for `solid3d`). Starts are random maps, half of them inverted, "
      "half "
      "flattened to at most a tenth.";
  Plot plot{"inversion", "Elements that stay inside out", "k_a/k_l or k_v/k_l", "share of random starts"};
  const int starts = effort == Effort::full ? 400 : 60;
  for (const Element& element : elements()) {
    result.figure(element.name + ": largest k_size/k_l with a stable inverted state", threshold(element),
                  element.threshold, 1e-5);
    result.figure(element.name + ": share of starts that stay inverted at 1.02 of it",
                  share_inverted(element, 1.02 * element.threshold, starts), 0, 0);
    Curve share{element.name}, line{element.name + ": bound", {}, {}, true};
    for (double ratio = 0.02; ratio < 0.31; ratio += effort == Effort::full ? 0.01 : 0.04) {
      share.add(ratio, share_inverted(element, ratio, starts));
    }
    for (const double y : {0.0, 0.5}) line.add(element.threshold, y);
    plot.curves.push_back(std::move(share));
    plot.curves.push_back(std::move(line));
  }
  result.plots.push_back(std::move(plot));
  const int shapes = effort == Effort::full ? 200 : 40, tries = effort == Effort::full ? 40 : 20;
  Table table{"Random tetrahedra of `solid3d`: share of " + std::to_string(shapes) +
                  " shapes that stay inverted from at least one of " + std::to_string(tries) +
                  " inverted starts.",
              {"k_v/k_l", "share"}};
  for (const double ratio : {0.01, 0.02, 0.03, 0.05, 0.0869}) {
    const double share = share_of_shapes(ratio, shapes, tries);
    table.rows.push_back({short_number(ratio), short_number(share)});
    if (ratio >= 0.05) {
      result.figure("solid3d, random shapes: share that stays inverted at " + short_number(ratio), share, 0,
                    0);
    }
  }
  result.tables.push_back(std::move(table));
  return result;
}

}  // namespace vivify::validation

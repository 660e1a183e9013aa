// Assembly with SIMD packets of terms over assembly term by term: every measure, and every model as a whole.
// Ratios of processor time of the scalar over the packed kernels, medians of alternations of one run.
//   simd_bench [NAME]      only the measures and models whose name contains NAME
#include <cstdio>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "bench/bodies.h"
#include "bench/timing.h"
#include "common/rng.h"
#include "sim/elastic/models/models.h"
#include "sim/elastic/packet.h"

using namespace vivify;
using namespace vivify::sim;
using namespace vivify::bench;

namespace {

constexpr int kAlternations = 31;
constexpr double kShortest = 3e-4;  // s; shorter works are repeated until they take this long together

double median_ratio(const std::function<void()>& scalar, const std::function<void()>& packed) {
  scalar();
  const int repeats = 1 + static_cast<int>(kShortest / std::max(1e-8, seconds_of(scalar)));
  const auto time = [&](const std::function<void()>& work) {
    return seconds_of([&] {
      for (int repeat = 0; repeat < repeats; ++repeat) work();
    });
  };
  std::vector<double> ratios;
  for (int alternation = 0; alternation < kAlternations; ++alternation) {
    const double of_scalar = time(scalar);
    ratios.push_back(of_scalar / time(packed));
  }
  return median(ratios);
}

// The same terms with kernels of either kind.
struct Twins {
  ElasticFamilies families[2];  // scalar, packed
};

Eigen::VectorXd shaken(const SimMesh& mesh) {
  CounterRng rng(1);
  Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(mesh.V.data(), mesh.V.size());
  const double edge = (mesh.V.row(mesh.E(0, 0)) - mesh.V.row(mesh.E(0, 1))).norm();
  for (Eigen::Index i = 0; i < x.size(); ++i) x[i] += edge * rng.uniform(-0.05, 0.05);
  return x;
}

struct Assembly {
  explicit Assembly(const SimMesh& mesh, const ElasticFamilies& of)
      : families(of), pattern(static_cast<int>(mesh.V.rows()), mesh.dimension()), x(shaken(mesh)) {
    for (const auto& family : families) family->reserve(pattern);
    pattern.finish();
    for (const auto& family : families) {
      family->bind(pattern);
      rest.emplace_back();
      family->values(Side::rest, Eigen::Map<const Eigen::VectorXd>(mesh.V.data(), mesh.V.size()),
                     rest.back());
    }
    D = std::make_unique<SymmetricMatrix>(pattern);
    c = Eigen::VectorXd::Zero(x.size());
  }
  void gradients() {
    for (const auto& family : families) family->gradients(Side::deformed, x, s, g);
  }
  void values() {
    for (const auto& family : families) family->values(Side::deformed, x, s);
  }
  // D of the family whose gradients were taken last.
  void hessians() {
    D->set_zero();
    const MeasureFamily& family = *families.back();
    family.add_hessians(x, g, stiffness, stress, *D);
  }
  void law() {
    const MeasureFamily& family = *families.back();
    const MeasureValues at{family.coefficients(), s, rest.back()};
    stress = family.law().stress(at);
    stiffness = family.law().stiffness(at);
  }
  // Forces and stiffness of all families.
  void whole() {
    D->set_zero();
    c.setZero();
    for (std::size_t f = 0; f < families.size(); ++f) {
      const MeasureFamily& family = *families[f];
      family.gradients(Side::deformed, x, s, g);
      const MeasureValues at{family.coefficients(), s, rest[f]};
      stress = family.law().stress(at);
      stiffness = family.law().stiffness(at);
      family.scatter(Side::deformed, g, stress, c);
      family.add_hessians(x, g, stiffness, stress, *D);
    }
  }

  const ElasticFamilies& families;
  SymmetricPattern pattern;
  Eigen::VectorXd x, s, g, c, stress, stiffness;
  std::vector<Eigen::VectorXd> rest;
  std::unique_ptr<SymmetricMatrix> D;
};

std::vector<double> constants_of(const MeasureFamily& family, const SimMesh& mesh, int element) {
  return family.parameters() == 0 ? std::vector<double>{} : inverse_edge_matrix(mesh, element);
}

// A measure on the elements of a mesh (on their edges when it has two points).
Twins measure_twins(const std::string& measure, const SimMesh& mesh) {
  Twins twins;
  for (const Kernels kernels : {Kernels::scalar, Kernels::packets}) {
    auto family = make_family(measure, kernels);
    if (family->points_per_term() == 2) {
      std::set<std::pair<int, int>> edges;
      for (Eigen::Index e = 0; e < mesh.E.rows(); ++e) {
        for (int i = 0; i < mesh.E.cols(); ++i) {
          for (int j = 0; j < i; ++j) edges.insert(std::minmax(mesh.E(e, i), mesh.E(e, j)));
        }
      }
      for (const auto& [a, b] : edges) family->add(std::array{a, b}, std::array{a, b}, 1);
    } else {
      for (int e = 0; e < static_cast<int>(mesh.E.rows()); ++e) {
        const std::span<const int> corners(mesh.E.row(e).data(), static_cast<std::size_t>(mesh.E.cols()));
        family->add(corners, corners, 1, constants_of(*family, mesh, e));
      }
    }
    twins.families[kernels == Kernels::packets].push_back(std::move(family));
  }
  return twins;
}

Twins model_twins(const std::string& model, const SimMesh& mesh) {
  Twins twins;
  const Value settings = bench::settings(model_schema(), "{type: " + model + "}");
  twins.families[1] = build_model(mesh, RestLayout::compatible, settings).families;
  for (const auto& family : twins.families[1]) {
    auto twin = make_family(family->name(), Kernels::scalar);
    const std::size_t n = static_cast<std::size_t>(family->points_per_term());
    for (int i = 0; i < family->size(); ++i) {
      const std::span deformed(family->stencils(Side::deformed)), rest(family->stencils(Side::rest));
      twin->add(deformed.subspan(n * i, n), rest.subspan(n * i, n), family->coefficients()[i],
                constants_of(*family, mesh, i));
    }
    twins.families[0].push_back(std::move(twin));
  }
  return twins;
}

// A mesh for stencils of `points` points in `dimension` coordinates, of about `dofs` degrees of freedom.
SimMesh mesh_for(int dimension, int points, bool large) {
  if (dimension == 2)
    return points == 2 ? closed_rod(large ? 564 : 188, 1, 1)
           : large     ? rectangle(22, 23, 0.05)
                       : rectangle(12, 13, 0.1);
  if (points == 3) return large ? card(17, 20, 0.05) : card(9, 12, 0.1);
  return large ? box(5, 8, 6, 0.125) : box(4, 4, 4, 0.25);
}

}  // namespace

int main(int argc, char** argv) {
  const auto wanted = [&](std::string_view name) { return argc < 2 || name.find(argv[1]) != name.npos; };
  std::printf("packets of %d numbers; time of the scalar over the packed kernels\n\n", kLanes<Packet>);
  std::printf("%-22s %5s %6s %8s %10s %9s\n", "measure", "DOF", "terms", "values", "gradients", "hessians");
  for (const MeasureEntry& entry : measures()) {
    if (!wanted(entry.name)) continue;
    for (const bool large : {false, true}) {
      const int points = make_family(entry.name)->points_per_term();
      const SimMesh mesh = mesh_for(entry.dimension, entry.dimension == 2 ? std::max(points, 3) : 4, large);
      const Twins twins = measure_twins(std::string(entry.name), mesh);
      Assembly scalar(mesh, twins.families[0]), packed(mesh, twins.families[1]);
      for (Assembly* assembly : {&scalar, &packed}) {
        assembly->gradients();
        assembly->law();
      }
      std::printf("%-22s %5d %6d %8.2f %10.2f %9.2f\n", std::string(entry.name).c_str(),
                  static_cast<int>(mesh.V.size()), twins.families[0].front()->size(),
                  median_ratio([&] { scalar.values(); }, [&] { packed.values(); }),
                  median_ratio([&] { scalar.gradients(); }, [&] { packed.gradients(); }),
                  median_ratio([&] { scalar.hessians(); }, [&] { packed.hessians(); }));
    }
  }
  std::printf("\n%-22s %5s %6s %18s %10s\n", "model", "DOF", "terms", "forces, stiffness", "packed us");
  for (const ModelEntry& entry : elastic_models()) {
    if (!wanted(entry.name)) continue;
    for (const bool large : {false, true}) {
      const SimMesh mesh = mesh_for(entry.dimension, entry.element_points, large);
      const Twins twins = model_twins(std::string(entry.name), mesh);
      Assembly scalar(mesh, twins.families[0]), packed(mesh, twins.families[1]);
      int terms = 0;
      for (const auto& family : twins.families[0]) terms += family->size();
      std::vector<double> times;
      const double ratio = median_ratio([&] { scalar.whole(); }, [&] { packed.whole(); });
      for (int i = 0; i < kAlternations; ++i) times.push_back(seconds_of([&] { packed.whole(); }));
      std::printf("%-22s %5d %6d %18.2f %10.1f\n", std::string(entry.name).c_str(),
                  static_cast<int>(mesh.V.size()), terms, ratio, 1e6 * median(times));
    }
  }
}

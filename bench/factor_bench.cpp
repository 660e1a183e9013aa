// Sparse factorisation and triangular solves: the solver of sim against Eigen and CHOLMOD, as ratios of
// processor time from this one run (medians of alternating repetitions; above 1: ours is faster).
//   factor_bench [NAME]      only the problems whose name contains NAME
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <unistd.h>

#include <Eigen/SparseCholesky>
#ifdef VIVIFY_CHOLMOD
#include <Eigen/CholmodSupport>
#endif

#include "common/rng.h"
#include "sim/solve/block_cholesky.h"

using namespace vivify;
using namespace vivify::sim;
using Sparse = Eigen::SparseMatrix<double>;

namespace {

constexpr int kRightSides = 25;  // goals and parameters of a usual controlled step

double now() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

struct Mesh {
  std::string name;
  int dim = 3, vertex_count = 0;
  std::set<std::pair<int, int>> couples;  // (larger, smaller) vertex

  void couple(const std::vector<int>& stencil) {
    for (const int a : stencil) {
      for (const int b : stencil) {
        if (a > b) couples.emplace(a, b);
      }
    }
  }
};

// Cells of unit size in six tetrahedra each; `inside` tells which cells exist.
Mesh tetrahedra(const std::string& name, int nx, int ny, int nz,
                const std::function<bool(int, int, int)>& inside) {
  Mesh mesh{name, 3, 0, {}};
  std::vector<int> number(static_cast<std::size_t>((nx + 1) * (ny + 1) * (nz + 1)), -1);
  const auto vertex = [&](int x, int y, int z) {
    int& v = number[(z * (ny + 1) + y) * (nx + 1) + x];
    if (v < 0) v = mesh.vertex_count++;
    return v;
  };
  constexpr int kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (int z = 0; z < nz; ++z) {
    for (int y = 0; y < ny; ++y) {
      for (int x = 0; x < nx; ++x) {
        if (!inside(x, y, z)) continue;
        for (const auto& order : kOrders) {
          int at[3] = {x, y, z};
          std::vector<int> corners = {vertex(x, y, z)};
          for (const int axis : order) {
            ++at[axis];
            corners.push_back(vertex(at[0], at[1], at[2]));
          }
          mesh.couple(corners);
        }
      }
    }
  }
  mesh.name += " " + std::to_string(3 * mesh.vertex_count);
  return mesh;
}
Mesh box(int nx, int ny, int nz) {
  return tetrahedra("box", nx, ny, nz, [](int, int, int) { return true; });
}
// Three crossing bars of `thick` cells, `arm` cells beyond the middle on each side.
Mesh cross(int thick, int arm) {
  const int size = thick + 2 * arm;
  return tetrahedra("cross", size, size, size, [=](int x, int y, int z) {
    const int middle =
        (x >= arm && x < arm + thick) + (y >= arm && y < arm + thick) + (z >= arm && z < arm + thick);
    return middle >= 2;
  });
}
Mesh grid(int nx, int ny) {
  Mesh mesh{"grid " + std::to_string(2 * (nx + 1) * (ny + 1)), 2, (nx + 1) * (ny + 1), {}};
  for (int y = 0; y < ny; ++y) {
    for (int x = 0; x < nx; ++x) {
      const int v = y * (nx + 1) + x;
      mesh.couple({v, v + 1, v + nx + 2});
      mesh.couple({v, v + nx + 1, v + nx + 2});
    }
  }
  return mesh;
}
// Bends at every vertex; each hinge couples three.
Mesh rod(int vertices) {
  Mesh mesh{"rod " + std::to_string(2 * vertices), 2, vertices, {}};
  for (int v = 0; v + 2 < vertices; ++v) mesh.couple({v, v + 1, v + 2});
  return mesh;
}
// Hinges over the edges of a triangulated sheet.
Mesh shell(int nx, int ny) {
  Mesh mesh = grid(nx, ny);
  mesh.dim = 3;
  mesh.name = "shell " + std::to_string(3 * mesh.vertex_count);
  for (int y = 0; y < ny; ++y) {
    for (int x = 0; x < nx; ++x) {
      const int v = y * (nx + 1) + x, up = nx + 1;
      mesh.couple({v, v + 1, v + up, v + up + 1});
      if (x + 1 < nx) mesh.couple({v, v + 1, v + up + 1, v + up + 2});
      if (y + 1 < ny) mesh.couple({v, v + up, v + up + 1, v + 2 * up + 1});
    }
  }
  return mesh;
}

// Symmetric, diagonally dominant, random.
Sparse matrix_of(const Mesh& mesh) {
  const int d = mesh.dim;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd diagonal = Eigen::VectorXd::Ones(d * mesh.vertex_count);
  CounterRng rng(1);
  for (const auto& [a, b] : mesh.couples) {
    for (int i = 0; i < d; ++i) {
      for (int j = 0; j < d; ++j) {
        const double value = rng.uniform(-1, 1);
        entries.emplace_back(d * a + i, d * b + j, value);
        diagonal[d * a + i] += std::abs(value);
        diagonal[d * b + j] += std::abs(value);
      }
    }
  }
  for (int v = 0; v < mesh.vertex_count; ++v) {
    for (int i = 0; i < d; ++i) {
      for (int j = 0; j < i; ++j) entries.emplace_back(d * v + i, d * v + j, 0.1);
      entries.emplace_back(d * v + i, d * v + i, diagonal[d * v + i]);
    }
  }
  Sparse lower(d * mesh.vertex_count, d * mesh.vertex_count);
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

struct Method {
  std::string name;
  std::function<void()> factorize;
  std::function<void(const Eigen::MatrixXd&, Eigen::MatrixXd&)> solve;
  std::vector<double> times[3];  // factorisation, one right-hand side, many
};

template <typename Solver>
Method method_of(const std::string& name, const std::shared_ptr<Solver>& solver, const Sparse& lower) {
  solver->analyzePattern(lower);
  return {name,
          [solver, &lower] { solver->factorize(lower); },
          [solver](const Eigen::MatrixXd& rhs, Eigen::MatrixXd& x) { x = solver->solve(rhs); },
          {}};
}

void run(const Mesh& mesh) {
  const Sparse lower = matrix_of(mesh);
  const double begin = now();
  const auto ours = std::make_shared<BlockCholesky>(lower, mesh.dim);
  const double analysis = now() - begin;
  std::vector<Method> methods;
  methods.push_back({"ours",
                     [=, &lower] { ours->factorize(lower.valuePtr()); },
                     [=](const Eigen::MatrixXd& rhs, Eigen::MatrixXd& x) {
                       x = rhs;
                       ours->solve_in_place(x);
                     },
                     {}});
  const auto eigen = std::make_shared<Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::AMDOrdering<int>>>();
  methods.push_back(method_of("Eigen", eigen, lower));
#ifdef VIVIFY_CHOLMOD
  methods.push_back(method_of("simplicial", std::make_shared<Eigen::CholmodSimplicialLDLT<Sparse>>(), lower));
  methods.push_back(method_of("supernodal", std::make_shared<Eigen::CholmodSupernodalLLT<Sparse>>(), lower));
#endif
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(lower.cols(), 1);
  const Eigen::MatrixXd many = Eigen::MatrixXd::Ones(lower.cols(), kRightSides);
  Eigen::MatrixXd x;
  // Enough repetitions for ten milliseconds of ours, each timed over at least 20 microseconds.
  methods[0].factorize();
  const double start = now();
  methods[0].factorize();
  const double guess = now() - start;
  const int inner = std::max(1, static_cast<int>(20e-6 / guess));
  const int alternations = std::clamp(static_cast<int>(0.02 / (guess * inner)), 9, 301);
  for (int i = 0; i < alternations; ++i) {
    for (Method& method : methods) {
      const double t0 = now();
      for (int k = 0; k < inner; ++k) method.factorize();
      const double t1 = now();
      for (int k = 0; k < inner; ++k) method.solve(one, x);
      const double t2 = now();
      method.solve(many, x);
      const double t3 = now();
      method.times[0].push_back((t1 - t0) / inner);
      method.times[1].push_back((t2 - t1) / inner);
      method.times[2].push_back(t3 - t2);
    }
  }
  double mine[3];
  for (int k = 0; k < 3; ++k) mine[k] = median(methods[0].times[k]);
  std::printf("%-12s %8.3f %8ld %5.2f %7ld %5d %9.1f %8.1f %8.1f %7.2f", mesh.name.c_str(), 1e3 * analysis,
              ours->nonzeros(), static_cast<double>(ours->nonzeros()) / static_cast<double>(lower.nonZeros()),
              static_cast<long>(eigen->matrixL().nestedExpression().nonZeros() + lower.cols()),
              ours->panel_count(), 1e6 * mine[0], 1e6 * mine[1], 1e6 * mine[2],
              1e-9 * ours->flops() / mine[0]);
  for (std::size_t m = 1; m < methods.size(); ++m) {
    std::printf("  |%6.2f %6.2f %6.2f", median(methods[m].times[0]) / mine[0],
                median(methods[m].times[1]) / mine[1], median(methods[m].times[2]) / mine[2]);
  }
  std::printf("\n");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (!std::getenv("OPENBLAS_NUM_THREADS")) {  // read when the library is loaded
    setenv("OPENBLAS_NUM_THREADS", "1", 1);
    execv("/proc/self/exe", argv);
  }
  std::printf("%-12s %8s %8s %5s %7s %5s %9s %8s %8s %7s", "problem", "set up", "nnz(L)", "fill", "Eigen's",
              "panels", "factor", "solve 1", "solve 25", "GFlop/s");
  std::printf("  | time of Eigen / ours");
#ifdef VIVIFY_CHOLMOD
  std::printf("  | simplicial / ours    | supernodal / ours");
#endif
  std::printf("\n%-12s %8s %8s %5s %7s %5s %9s %8s %8s %7s\n", "DOF", "ms", "", "", "", "", "us", "us", "us",
              "");
  const std::vector<Mesh> meshes = {
      rod(32),      rod(71),      rod(500),      grid(4, 9),      grid(6, 13),    grid(9, 9),   grid(12, 40),
      grid(30, 50), shell(5, 5),  shell(8, 8),   shell(16, 20),   box(2, 2, 3),   box(3, 3, 4), box(4, 4, 4),
      cross(3, 3),  box(6, 6, 7), box(7, 7, 12), box(10, 10, 11), box(10, 14, 20)};
  for (const Mesh& mesh : meshes) {
    if (argc < 2 || mesh.name.find(argv[1]) != std::string::npos) run(mesh);
  }
}

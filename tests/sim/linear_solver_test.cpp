// The sparse factorisation against Eigen, dense eigenvalues and its own residual, over many patterns.
#include "sim/solve/linear_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <functional>

#include "common/parallel.h"
#include "common/rng.h"
#include "sim/solve/block_cholesky.h"

namespace vivify::sim {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Couples = std::vector<std::pair<int, int>>;  // of vertices

struct Shape {
  const char* name;
  int vertex_count;
  std::function<Couples(CounterRng&)> couples;
};
void PrintTo(const Shape& shape, std::ostream* out) { *out << shape.name; }

// `density` of all pairs of `count` vertices from `first` on.
void couple_random(Couples& couples, int first, int count, double density, CounterRng& rng) {
  for (int a = first; a < first + count; ++a) {
    for (int b = first; b < a; ++b) {
      if (rng.uniform() < density) couples.emplace_back(a, b);
    }
  }
}

const Shape kShapes[] = {
    {"one_vertex", 1, [](CounterRng&) { return Couples{}; }},
    {"loose_vertices", 9, [](CounterRng&) { return Couples{}; }},
    {"dense", 23,
     [](CounterRng& rng) {
       Couples couples;
       couple_random(couples, 0, 23, 1, rng);
       return couples;
     }},
    {"arrow", 40,
     [](CounterRng&) {
       Couples couples;
       for (int v = 1; v < 40; ++v) couples.emplace_back(v, 0);
       return couples;
     }},
    {"rod", 61,
     [](CounterRng&) {
       Couples couples;
       for (int v = 1; v < 61; ++v) couples.emplace_back(v, v - 1);
       for (int v = 2; v < 61; ++v) couples.emplace_back(v, v - 2);
       return couples;
     }},
    {"ring", 30,
     [](CounterRng&) {
       Couples couples;
       for (int v = 0; v < 30; ++v) couples.emplace_back(v, (v + 1) % 30);
       return couples;
     }},
    {"sparse", 80,
     [](CounterRng& rng) {
       Couples couples;
       couple_random(couples, 0, 80, 0.03, rng);
       return couples;
     }},
    {"random", 60,
     [](CounterRng& rng) {
       Couples couples;
       couple_random(couples, 0, 60, 0.15, rng);
       return couples;
     }},
    {"disconnected", 70,
     [](CounterRng& rng) {
       Couples couples;
       couple_random(couples, 0, 30, 0.3, rng);
       couple_random(couples, 30, 15, 0.8, rng);
       couple_random(couples, 50, 20, 0.2, rng);
       return couples;
     }},
    {"cube", 216,
     [](CounterRng&) {
       Couples couples;
       for (int v = 0; v < 216; ++v) {
         for (int step : {1, 6, 36, 7, 42, 37, 43}) {
           if (v + step < 216) couples.emplace_back(v, v + step);
         }
       }
       return couples;
     }},
};

// Lower triangle, random; eigenvalues above `shift`. Blocks are full, or a few entries of them where `holes`.
Sparse random_matrix(const Shape& shape, int dim, double shift, std::uint64_t seed, bool holes = false) {
  CounterRng rng(seed);
  const int size = dim * shape.vertex_count;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd diagonal = Eigen::VectorXd::Constant(size, shift);
  const auto add = [&](int row, int column) {
    if (holes && rng.uniform() < 0.5) return;
    const double value = rng.uniform(-1, 1);
    entries.emplace_back(std::max(row, column), std::min(row, column), value);
    diagonal[row] += std::abs(value);
    diagonal[column] += std::abs(value);
  };
  Couples couples = shape.couples(rng);
  for (auto& [a, b] : couples) {
    if (a < b) std::swap(a, b);
  }
  std::sort(couples.begin(), couples.end());
  couples.erase(std::unique(couples.begin(), couples.end()), couples.end());
  for (const auto& [a, b] : couples) {
    for (int i = 0; i < dim; ++i) {
      for (int j = 0; j < dim; ++j) add(dim * a + i, dim * b + j);
    }
  }
  for (int v = 0; v < shape.vertex_count; ++v) {
    for (int i = 0; i < dim; ++i) {
      for (int j = 0; j < i; ++j) add(dim * v + i, dim * v + j);
    }
  }
  for (int i = 0; i < size; ++i) entries.emplace_back(i, i, diagonal[i] + rng.uniform());
  Sparse lower(size, size);
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

Eigen::MatrixXd random_columns(Eigen::Index rows, int columns, std::uint64_t seed) {
  CounterRng rng(seed);
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return rng.uniform(-1, 1); });
}

Eigen::MatrixXd dense(const Sparse& lower) { return Sparse(lower.selfadjointView<Eigen::Lower>()); }

class Factorisation : public ::testing::TestWithParam<std::tuple<Shape, int>> {
 protected:
  const Shape& shape() const { return std::get<0>(GetParam()); }
  int dim() const { return std::get<1>(GetParam()); }
};

TEST_P(Factorisation, SolvesAndAgreesWithEigen) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const Sparse lower = random_matrix(shape(), dim(), 0.01, seed, seed % 2 == 1);
    BlockCholesky factor(lower, dim());
    ASSERT_TRUE(factor.factorize(lower.valuePtr()));
    Eigen::SimplicialLDLT<Sparse> eigen(lower);
    for (const int columns : {1, 2, 4, 5, 9, 12, 13, 25, 30}) {
      const Eigen::MatrixXd rhs = random_columns(lower.cols(), columns, seed + 100);
      Eigen::MatrixXd x = rhs;
      factor.solve_in_place(x);
      const Eigen::MatrixXd residual = lower.selfadjointView<Eigen::Lower>() * x - rhs;
      const double scale = dense(lower).norm() * x.norm() + rhs.norm();
      EXPECT_LE(residual.norm(), 1e-15 * scale * std::sqrt(lower.cols()))
          << columns << " columns, seed " << seed;
      EXPECT_LE(residual.norm(), 1e-12 * rhs.norm()) << columns << " columns, seed " << seed;
      EXPECT_LE((x - eigen.solve(rhs)).norm(), 1e-11 * x.norm());
    }
  }
}

TEST_P(Factorisation, FindsIndefiniteMatrices) {
  const Sparse lower = random_matrix(shape(), dim(), 0.01, 7);
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense(lower)).eigenvalues();
  BlockCholesky factor(lower, dim());
  const Eigen::Index size = lower.cols();
  for (const Eigen::Index negative : {Eigen::Index(0), Eigen::Index(1), size / 3, size - 1, size}) {
    // Shifted into the gap below eigenvalue number `negative`.
    const double low = negative > 0 ? eigenvalues[negative - 1] : eigenvalues[0] - 1;
    const double high = negative < size ? eigenvalues[negative] : eigenvalues[size - 1] + 1;
    Sparse shifted = lower;
    for (Eigen::Index i = 0; i < size; ++i) shifted.coeffRef(i, i) -= 0.5 * (low + high);
    EXPECT_EQ(factor.factorize(shifted.valuePtr()), negative == 0);
    const BlockCholesky::Inertia inertia = factor.inertia(shifted.valuePtr());
    EXPECT_EQ(inertia.negative, negative);
    EXPECT_EQ(inertia.zero, 0);
    EXPECT_EQ(inertia.positive, size - negative);
  }
  Sparse broken = lower;
  broken.coeffRef(size - 1, size - 1) = std::nan("");
  EXPECT_FALSE(factor.factorize(broken.valuePtr()));
  broken.coeffRef(size - 1, size - 1) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(factor.factorize(broken.valuePtr()));
}

TEST_P(Factorisation, RepeatsTheSameBits) {
  const Sparse lower = random_matrix(shape(), dim(), 0.01, 3);
  const Eigen::MatrixXd rhs = random_columns(lower.cols(), 7, 5);
  const auto solutions = [&](BlockCholesky& factor) {
    EXPECT_TRUE(factor.factorize(lower.valuePtr()));
    Eigen::MatrixXd x(rhs.rows(), 8);
    x << rhs, rhs.col(0);
    factor.solve_in_place(x.leftCols(7));
    factor.solve_in_place(x.rightCols(1));
    return x;
  };
  BlockCholesky first(lower, dim()), second(lower, dim());
  const Eigen::MatrixXd expected = solutions(first);
  Sparse indefinite = -lower;
  EXPECT_FALSE(second.factorize(indefinite.valuePtr()));
  EXPECT_EQ(solutions(second), expected);
  EXPECT_EQ(solutions(second), expected);
}

INSTANTIATE_TEST_SUITE_P(Patterns, Factorisation,
                         ::testing::Combine(::testing::ValuesIn(kShapes), ::testing::Values(1, 2, 3)),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param).name) + "_" +
                                  std::to_string(std::get<1>(test.param)) + "d";
                         });

// Large enough for nested dissection, or for fronts of several panels that threads share.
const Shape kLargeShapes[] = {
    {"dense", 220,
     [](CounterRng& rng) {
       Couples couples;
       couple_random(couples, 0, 220, 1, rng);
       return couples;
     }},
    {"lattice", 14 * 14 * 14,
     [](CounterRng&) {
       Couples couples;
       for (int v = 0; v < 14 * 14 * 14; ++v) {
         const int x = v % 14, y = v / 14 % 14, z = v / 196;
         for (const auto& [dx, dy, dz] : {std::tuple{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}) {
           if (x + dx < 14 && y + dy < 14 && z + dz < 14)
             couples.emplace_back(v + dx + 14 * dy + 196 * dz, v);
         }
       }
       return couples;
     }},
    {"pieces", 2000,
     [](CounterRng& rng) {
       Couples couples;
       couple_random(couples, 0, 500, 0.01, rng);
       for (int v = 701; v < 2000; ++v) couples.emplace_back(v, v % 100 == 0 ? 600 : v - 1);
       return couples;
     }},
    {"arrow", 1600,
     [](CounterRng&) {
       Couples couples;
       for (int v = 1; v < 1600; ++v) couples.emplace_back(v, 0);
       return couples;
     }},
    {"loose_vertices", 1600, [](CounterRng&) { return Couples{}; }},
};

class LargeFactorisation : public ::testing::TestWithParam<std::tuple<Shape, int>> {};

TEST_P(LargeFactorisation, SolvesWithTheSameBitsOnAnyThreadCount) {
  const auto& [shape, dim] = GetParam();
  const Sparse lower = random_matrix(shape, dim, 0.1, 2);
  const Sparse opposite = -lower;
  const Eigen::MatrixXd rhs = random_columns(lower.cols(), 5, 3);
  Eigen::MatrixXd expected;
  for (const int threads : {1, 2, 5}) {
    set_thread_count(threads);
    BlockCholesky factor(lower, dim);
    EXPECT_FALSE(factor.factorize(opposite.valuePtr()));
    EXPECT_EQ(factor.inertia(opposite.valuePtr()).negative, lower.cols());
    ASSERT_TRUE(factor.factorize(lower.valuePtr()));
    Eigen::MatrixXd x = rhs;
    factor.solve_in_place(x.leftCols(4));
    factor.solve_in_place(x.rightCols(1));
    set_thread_count(0);
    if (threads == 1) expected = x;
    EXPECT_EQ(x, expected) << threads << " threads";
    EXPECT_LE((lower.selfadjointView<Eigen::Lower>() * x - rhs).norm(), 1e-13 * rhs.norm());
  }
}

INSTANTIATE_TEST_SUITE_P(Patterns, LargeFactorisation,
                         ::testing::Combine(::testing::ValuesIn(kLargeShapes), ::testing::Values(1, 2, 3)),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param).name) + "_" +
                                  std::to_string(std::get<1>(test.param)) + "d";
                         });

TEST_P(LargeFactorisation, DividesIntoIndependentSubtrees) {
  const auto& [shape, dim] = GetParam();
  const Elimination elimination = order_elimination(random_matrix(shape, dim, 0.1, 2), dim);
  int first_front = 0, first_column = 0;
  for (const int end : elimination.subtree_ends) {
    ASSERT_LT(first_front, end);
    const std::vector<int>& outside = elimination.fronts[end - 1].rows;  // of the root
    const int last_column = elimination.fronts[end - 1].columns.back();
    for (int f = first_front; f < end; ++f) {
      EXPECT_GE(elimination.fronts[f].columns.front(), first_column);
      for (const int row : elimination.fronts[f].rows)
        EXPECT_TRUE(row <= last_column || std::binary_search(outside.begin(), outside.end(), row));
    }
    first_front = end;
    first_column = last_column + 1;
  }
  for (const int end : elimination.subtree_ends) {
    for (const int row : elimination.fronts[end - 1].rows) EXPECT_GE(row, first_column);  // of no subtree
  }
  if (std::string(shape.name) == "lattice") {
    EXPECT_GE(elimination.subtree_ends.size(), 4u);
  }
  if (std::string(shape.name) == "loose_vertices") {
    EXPECT_TRUE(elimination.subtree_ends.empty());
  }
}

// Less than minimum degree, with the zeros inside fronts.
TEST(LinearSolver, FillsLargeSolidsLittle) {
  constexpr int kSide = 14;
  SymmetricPattern pattern(kSide * kSide * kSide, 3);
  for (int z = 0; z + 1 < kSide; ++z) {
    for (int y = 0; y + 1 < kSide; ++y) {
      for (int x = 0; x + 1 < kSide; ++x) {
        std::vector<int> corners;
        for (int c = 0; c < 8; ++c) {
          corners.push_back(x + (c & 1) + kSide * (y + (c >> 1 & 1) + kSide * (z + (c >> 2))));
        }
        pattern.couple(corners.data(), 8);
      }
    }
  }
  pattern.finish();
  SymmetricMatrix matrix(pattern);
  for (int i = 0; i < pattern.size(); ++i) matrix.lower().coeffRef(i, i) = 1;
  const Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::AMDOrdering<int>> eigen(matrix.lower());
  EXPECT_LT(static_cast<double>(BlockCholesky(matrix.lower(), 3).nonzeros()),
            0.9 * static_cast<double>(eigen.matrixL().nestedExpression().nonZeros()));
}

TEST(LinearSolver, SolvesOverASymmetricPattern) {
  for (const int dim : {2, 3}) {
    SymmetricPattern pattern(5, dim);
    for (const std::vector<int>& stencil : {std::vector{0, 3, 4}, {1, 3}, {2}}) {
      pattern.couple(stencil.data(), static_cast<int>(stencil.size()));
    }
    pattern.finish();
    SymmetricMatrix matrix(pattern);
    CounterRng rng(11);
    for (Eigen::Index i = 0; i < matrix.lower().nonZeros(); ++i) matrix.values()[i] = rng.uniform(-1, 1);
    LinearSolver solver(pattern);
    EXPECT_FALSE(solver.factorize(matrix));
    for (int i = 0; i < pattern.size(); ++i) matrix.lower().coeffRef(i, i) += 10;
    ASSERT_TRUE(solver.factorize(matrix));
    const Eigen::MatrixXd rhs = random_columns(pattern.size(), 3, 12);
    EXPECT_LE((matrix * solver.solve(rhs) - rhs).norm(), 1e-14 * rhs.norm());
  }
}

}  // namespace
}  // namespace vivify::sim

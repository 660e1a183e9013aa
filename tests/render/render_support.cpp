#include "tests/render/render_support.h"

#include <Eigen/Geometry>
#include <cmath>

#include "common/rng.h"

namespace vivify::render::testing_support {

Value settings(const Schema& schema, const std::string& text) {
  std::vector<Error> errors;
  const ConfigNode node = parse_yaml(text, "test", errors);
  Value value = resolve(schema, node, errors);
  for (const Error& error : errors) ADD_FAILURE() << error.full_text();
  return value;
}

Mesh square(const Eigen::Vector3d& center, double half, const Eigen::Vector3d& normal,
            const std::string& material, int object_id) {
  const Eigen::Vector3d n = normal.normalized();
  const Eigen::Vector3d s =
      (std::abs(n.y()) < 0.9 ? Eigen::Vector3d(0, 1, 0) : Eigen::Vector3d(0, 0, -1)).cross(n).normalized();
  const Eigen::Vector3d t = n.cross(s);
  Mesh mesh;
  mesh.name = "square";
  mesh.V.resize(4, 3);
  mesh.V << (center - half * s - half * t).transpose(), (center + half * s - half * t).transpose(),
      (center + half * s + half * t).transpose(), (center - half * s + half * t).transpose();
  mesh.UV.resize(4, 2);
  mesh.UV << 0, 0, 1, 0, 1, 1, 0, 1;
  mesh.F.resize(2, 3);
  mesh.F << 0, 1, 2, 0, 2, 3;
  mesh.part_materials = {material};
  mesh.object_id = object_id;
  mesh.smooth = false;
  return mesh;
}

Mesh ball(const Eigen::Vector3d& center, double radius, const std::string& material, int rings, bool inward,
          int object_id) {
  Mesh mesh;
  mesh.name = "ball";
  const int columns = 2 * rings;
  mesh.V.resize((rings + 1) * columns, 3);
  for (int i = 0; i <= rings; ++i) {
    const double theta = M_PI * i / rings;
    for (int j = 0; j < columns; ++j) {
      const double phi = 2 * M_PI * j / columns;
      mesh.V.row(i * columns + j) =
          (center + radius * Eigen::Vector3d(std::sin(theta) * std::cos(phi), std::cos(theta),
                                             -std::sin(theta) * std::sin(phi)))
              .transpose();
    }
  }
  mesh.F.resize(2 * columns * (rings - 1), 3);
  int f = 0;
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < columns; ++j) {
      const int a = i * columns + j, b = i * columns + (j + 1) % columns;
      const int c = a + columns, d = b + columns;
      if (i > 0) mesh.F.row(f++) << a, c, b;
      if (i + 1 < rings) mesh.F.row(f++) << b, c, d;
    }
  }
  if (inward) mesh.F.col(1).swap(mesh.F.col(2));
  mesh.part_materials = {material};
  mesh.object_id = object_id;
  mesh.smooth = false;
  return mesh;
}

Mesh box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, const std::string& material,
         int object_id) {
  Mesh mesh;
  mesh.name = "box";
  mesh.V.resize(8, 3);
  for (int i = 0; i < 8; ++i) {
    mesh.V.row(i) << ((i & 1) ? high : low).x(), ((i & 2) ? high : low).y(), ((i & 4) ? high : low).z();
  }
  mesh.F.resize(12, 3);
  mesh.F << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5,
      3, 7, 5;
  mesh.part_materials = {material};
  mesh.object_id = object_id;
  mesh.smooth = false;
  return mesh;
}

Vec3 mean_radiance(const Film& film) {
  double sum[3] = {0, 0, 0};
  for (std::size_t i = 0; i < film.pixels(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) sum[k] += film.rgba[4 * i + k];
  }
  const auto n = static_cast<double>(film.pixels());
  return {static_cast<float>(sum[0] / n), static_cast<float>(sum[1] / n), static_cast<float>(sum[2] / n)};
}

Estimate replicated(const std::function<double(std::uint64_t seed)>& value, int replicates) {
  double sum = 0, squares = 0;
  for (int r = 0; r < replicates; ++r) {
    const double v = value(static_cast<std::uint64_t>(r));
    sum += v;
    squares += v * v;
  }
  const double mean = sum / replicates;
  const double variance = std::max(0.0, squares / replicates - mean * mean) * replicates / (replicates - 1);
  return {mean, std::sqrt(variance / replicates)};
}

// Upper incomplete gamma function Q(a, x): series below a + 1, continued fraction (Lentz) above.
double chi_square_p(double statistic, double degrees) {
  const double a = degrees / 2, x = statistic / 2;
  if (x <= 0) return 1;
  const double scale = std::exp(-x + a * std::log(x) - std::lgamma(a));
  if (x < a + 1) {
    double term = 1 / a, sum = term;
    for (int n = 1; n < 100000 && term > sum * 1e-15; ++n) sum += term *= x / (a + n);
    return 1 - sum * scale;
  }
  double b = x + 1 - a, c = 1e300, d = 1 / b, h = d;
  for (int n = 1; n < 100000; ++n) {
    const double an = -n * (n - a);
    b += 2;
    d = 1 / (an * d + b);
    c = b + an / c;
    h *= d * c;
    if (std::abs(d * c - 1) < 1e-15) break;
  }
  return scale * h;
}

double goodness_of_fit(const std::vector<double>& counts, const std::vector<double>& expected) {
  double statistic = 0, pooled_count = 0, pooled_expected = 0;
  int cells = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    pooled_count += counts[i];
    pooled_expected += expected[i];
    if (pooled_expected < 5) continue;
    statistic += (pooled_count - pooled_expected) * (pooled_count - pooled_expected) / pooled_expected;
    pooled_count = pooled_expected = 0;
    ++cells;
  }
  if (pooled_expected > 0 || pooled_count > 0) {  // the rest joins nothing: a cell of its own, conservative
    const double e = std::max(pooled_expected, 1.0);
    statistic += (pooled_count - pooled_expected) * (pooled_count - pooled_expected) / e;
    ++cells;
  }
  return cells > 1 ? chi_square_p(statistic, cells - 1) : 1;
}

double sidak(int tests) { return 1 - std::pow(1 - 0.01, 1.0 / tests); }

namespace {

// Adaptive integral over a rectangle: Gauss points 3 by 3 against those of the four quarters.
double integrate(const std::function<double(double, double)>& f, double x0, double x1, double y0, double y1,
                 double tolerance, int depth) {
  static const double kNode[3] = {-0.7745966692414834, 0, 0.7745966692414834};
  static const double kWeight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  const auto rule = [&](double a0, double a1, double b0, double b1) {
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        sum += kWeight[i] * kWeight[j] *
               f(0.5 * (a0 + a1) + 0.5 * (a1 - a0) * kNode[i], 0.5 * (b0 + b1) + 0.5 * (b1 - b0) * kNode[j]);
      }
    }
    return sum * (a1 - a0) * (b1 - b0);
  };
  const double xm = 0.5 * (x0 + x1), ym = 0.5 * (y0 + y1);
  const double whole = rule(x0, x1, y0, y1);
  const double quarters =
      rule(x0, xm, y0, ym) + rule(xm, x1, y0, ym) + rule(x0, xm, ym, y1) + rule(xm, x1, ym, y1);
  if (depth == 0 || std::abs(whole - quarters) < tolerance) return quarters;
  return integrate(f, x0, xm, y0, ym, tolerance / 4, depth - 1) +
         integrate(f, xm, x1, y0, ym, tolerance / 4, depth - 1) +
         integrate(f, x0, xm, ym, y1, tolerance / 4, depth - 1) +
         integrate(f, xm, x1, ym, y1, tolerance / 4, depth - 1);
}

}  // namespace

double direction_fit(const std::function<bool(const Vec2& u, float v, Vec3& direction)>& sample,
                     const std::function<double(const Vec3& direction)>& pdf, const Vec3& axis,
                     double least_cosine, std::uint64_t seed, double* integral, int samples) {
  constexpr int kRows = 16, kColumns = 32;
  const Basis basis(normalize(axis));
  std::vector<double> counts(kRows * kColumns + 1, 0.0), expected(kRows * kColumns + 1, 0.0);
  CounterRng rng(seed);
  for (int s = 0; s < samples; ++s) {
    const Vec2 u = {static_cast<float>(rng.uniform()), static_cast<float>(rng.uniform())};
    Vec3 direction;
    std::size_t cell = counts.size() - 1;
    if (sample(u, static_cast<float>(rng.uniform()), direction)) {
      EXPECT_NEAR(length(direction), 1, 1e-4);
      const Vec3 d = basis.to_local(direction);
      const double row = (d.z - least_cosine) / (1 - least_cosine) * kRows;
      const double column = (std::atan2(d.y, d.x) / (2 * M_PI) + 0.5) * kColumns;
      if (row >= 0) {
        cell = static_cast<std::size_t>(std::min(static_cast<int>(row), kRows - 1) * kColumns +
                                        std::min(static_cast<int>(column), kColumns - 1));
      }
    }
    counts[cell] += 1;
  }
  const auto density = [&](double z, double phi) {
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    return pdf(basis.to_world({static_cast<float>(r * std::cos(phi)), static_cast<float>(r * std::sin(phi)),
                               static_cast<float>(z)}));
  };
  double total = 0;
  for (int i = 0; i < kRows; ++i) {
    for (int j = 0; j < kColumns; ++j) {
      const double z0 = least_cosine + (1 - least_cosine) * i / kRows;
      const double phi0 = 2 * M_PI * j / kColumns - M_PI;
      const double p =
          integrate(density, z0, z0 + (1 - least_cosine) / kRows, phi0, phi0 + 2 * M_PI / kColumns, 4e-6, 6);
      expected[static_cast<std::size_t>(i * kColumns + j)] = p * samples;
      total += p;
    }
  }
  if (integral != nullptr) *integral = total;
  EXPECT_LE(total, 1.003) << "the density integrates to more than one";
  expected.back() = std::max(0.0, 1 - total) * samples;
  if (expected.back() < 1e-3 * samples && counts.back() == 0)
    expected.back() = 0;  // an error of the integral only
  return goodness_of_fit(counts, expected);
}

}  // namespace vivify::render::testing_support

#include "bench/validation/references.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

namespace vivify::validation {
namespace {

// The root of f in [low, high], where f changes its sign, to the last digits.
double bisect(const std::function<double(double)>& f, double low, double high) {
  const bool rising = f(low) < 0;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    ((f(middle) < 0) == rising ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

template <std::size_t N>
using State = std::array<double, N>;

// Classical Runge–Kutta from s = 0 to 1.
template <std::size_t N, class Slope>
State<N> integrate(State<N> y, const Slope& slope) {
  constexpr int kSteps = 4000;
  constexpr double kStep = 1.0 / kSteps;
  const auto moved = [](State<N> from, const State<N>& along, double by) {
    for (std::size_t k = 0; k < N; ++k) from[k] += by * along[k];
    return from;
  };
  for (int i = 0; i < kSteps; ++i) {
    const double s = i * kStep;
    const State<N> a = slope(s, y), b = slope(s + kStep / 2, moved(y, a, kStep / 2)),
                   c = slope(s + kStep / 2, moved(y, b, kStep / 2)), d = slope(s + kStep, moved(y, c, kStep));
    for (std::size_t k = 0; k < N; ++k) y[k] += kStep / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
  }
  return y;
}

}  // namespace

TipMotion elastica(double alpha) {
  // y = (θ, θ', x across, x along) with θ'' = −α cos θ, θ(0) = 0, θ'(1) = 0.
  const auto shoot = [alpha](double curvature) {
    return integrate<4>({0, curvature, 0, 0}, [alpha](double, const State<4>& y) {
      return State<4>{y[1], -alpha * std::cos(y[0]), std::sin(y[0]), std::cos(y[0])};
    });
  };
  // The bending moment at the clamp is at most α times the length.
  const double curvature =
      bisect([&](double k) { return shoot(k)[1]; }, 0, std::min(alpha, std::sqrt(2 * alpha)));
  const State<4> tip = shoot(curvature);
  return {tip[2], 1 - tip[3]};
}

TipMotion elastica_integrals(double alpha) {
  // With the slope θ of the tip, k² = (1 + sin θ)/2 and sin φ = 1/(k √2): √α = K(k) − F(k, φ).
  const auto modulus = [](double tip) { return std::sqrt((1 + std::sin(tip)) / 2); };
  const auto angle = [](double k) { return std::asin(1 / (k * std::numbers::sqrt2)); };
  const double tip = bisect(
      [&](double theta) {
        const double k = modulus(theta);
        return std::comp_ellint_1(k) - std::ellint_1(k, angle(k)) - std::sqrt(alpha);
      },
      1e-9, std::numbers::pi / 2 - 1e-9);
  const double k = modulus(tip);
  return {1 - 2 / std::sqrt(alpha) * (std::comp_ellint_2(k) - std::ellint_2(k, angle(k))),
          1 - std::sqrt(2 * std::sin(tip) / alpha)};
}

double cantilever_frequency() {
  const double x = bisect([](double v) { return std::cos(v) * std::cosh(v) + 1; }, 1, 3);
  return x * x;
}

double self_weight_buckling() {
  // s from the free top: θ'(0) = 0, and θ(1) = 0 at the clamp.
  return bisect(
      [](double lambda) {
        return integrate<2>({1, 0}, [lambda](double s, const State<2>& y) {
          return State<2>{y[1], -lambda * s * y[0]};
        })[0];
      },
      5, 12);
}

double self_weight_buckling_bessel() {
  // The power series of J_ν(x) (2/x)^ν Γ(ν + 1).
  const auto series = [](double x) {
    double sum = 0, term = 1;
    for (int m = 1; m < 60; ++m) {
      sum += term;
      term *= -x * x / 4 / (m * (m - 1.0 / 3));
    }
    return sum;
  };
  const double j = bisect(series, 1, 3);
  return 2.25 * j * j;
}

}  // namespace vivify::validation

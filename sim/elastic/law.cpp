#include "sim/elastic/law.h"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

namespace vivify::sim {

Eigen::VectorXd per_value(const Eigen::VectorXd& c, int components) {
  if (components == 1) return c;
  Eigen::VectorXd repeated(components * c.size());
  for (Eigen::Index i = 0; i < c.size(); ++i) {
    repeated.segment(components * i, components).setConstant(c[i]);
  }
  return repeated;
}

Eigen::VectorXd strain(const Eigen::VectorXd& s, const Eigen::VectorXd& S, bool periodic) {
  Eigen::VectorXd d = s - S;
  if (periodic) {
    for (double& angle : d) angle = std::remainder(angle, 2 * std::numbers::pi);
  }
  return d;
}

namespace {

class QuadraticLaw final : public Law {
 public:
  QuadraticLaw(int components, bool periodic) : components_(components), periodic_(periodic) {}

  double energy(const MeasureValues& at) const override {
    return 0.5 * stiffness(at).dot(strain(at.s, at.S, periodic_).cwiseAbs2());
  }
  Eigen::VectorXd stress(const MeasureValues& at) const override {
    return stiffness(at).cwiseProduct(strain(at.s, at.S, periodic_));
  }
  bool diagonal() const override { return true; }
  Eigen::VectorXd stiffness(const MeasureValues& at) const override { return per_value(at.c, components_); }
  RowMatrixXd couple(const MeasureValues& at, const RowMatrixXd& rows) const override {
    return (-stiffness(at)).asDiagonal() * rows;
  }
  RowMatrixXd couple_transposed(const MeasureValues& at, const RowMatrixXd& rows) const override {
    return couple(at, rows);
  }
  bool quadratic() const override { return true; }
  RowMatrixXd couple_rate(const MeasureValues&, const Eigen::VectorXd&,
                          const RowMatrixXd& rows) const override {
    return RowMatrixXd::Zero(rows.rows(), rows.cols());
  }
  RowMatrixXd rest_curvature(const MeasureValues&, const Eigen::VectorXd&,
                             const RowMatrixXd& rows) const override {
    return RowMatrixXd::Zero(rows.rows(), rows.cols());
  }

 private:
  int components_;
  bool periodic_;
};

class PrintedGreenLaw final : public Law {
 public:
  double energy(const MeasureValues& at) const override {
    double sum = 0;
    for (Eigen::Index i = 0; i < at.c.size(); ++i) {
      const Metrics m(at, i);
      const Eigen::Matrix2d N = m.K * m.P;
      sum += m.c / 8 * ((N * N).trace() - 2 * N.trace() + 2);
    }
    return sum;
  }

  Eigen::VectorXd stress(const MeasureValues& at) const override {
    Eigen::VectorXd result(at.s.size());
    for (Eigen::Index i = 0; i < at.c.size(); ++i) {
      const Metrics m(at, i);
      const Eigen::Matrix2d T = m.K * m.P * m.K - m.K;
      for (int k = 0; k < 3; ++k) result[3 * i + k] = m.c / 4 * product(T, direction(k));
    }
    return result;
  }

  bool diagonal() const override { return false; }
  Eigen::VectorXd stiffness(const MeasureValues& at) const override {
    Eigen::VectorXd result(9 * at.c.size());
    for (Eigen::Index i = 0; i < at.c.size(); ++i) {
      const Metrics m(at, i);
      for (int k = 0; k < 3; ++k) {
        const Eigen::Matrix2d KkK = m.K * direction(k) * m.K;
        for (int l = 0; l < 3; ++l) result[9 * i + 3 * k + l] = m.c / 4 * product(KkK, direction(l));
      }
    }
    return result;
  }

  RowMatrixXd couple(const MeasureValues& at, const RowMatrixXd& rows) const override {
    return apply(at, rows, [&](Eigen::Index i) { return coupling(Metrics(at, i)); });
  }
  RowMatrixXd couple_transposed(const MeasureValues& at, const RowMatrixXd& rows) const override {
    return apply(at, rows,
                 [&](Eigen::Index i) -> Eigen::Matrix3d { return coupling(Metrics(at, i)).transpose(); });
  }

  bool quadratic() const override { return false; }
  RowMatrixXd couple_rate(const MeasureValues& at, const Eigen::VectorXd& ds,
                          const RowMatrixXd& rows) const override {
    return apply(at, rows, [&](Eigen::Index i) {
      const Metrics m(at, i);
      const Eigen::Matrix2d dP = metric_change(ds, i);
      Eigen::Matrix3d result;
      for (int l = 0; l < 3; ++l) {
        const Eigen::Matrix2d dK = -m.K * direction(l) * m.K;
        const Eigen::Matrix2d dT = dK * dP * m.K + m.K * dP * dK;
        for (int k = 0; k < 3; ++k) result(k, l) = m.c / 4 * product(dT, direction(k));
      }
      return result;
    });
  }
  RowMatrixXd rest_curvature(const MeasureValues& at, const Eigen::VectorXd& ds,
                             const RowMatrixXd& rows) const override {
    return apply(at, rows, [&](Eigen::Index i) {
      const Metrics m(at, i);
      const Eigen::Matrix2d dP = metric_change(ds, i);
      Eigen::Matrix3d result;
      for (int k = 0; k < 3; ++k) {
        for (int l = 0; l < 3; ++l) {
          const Eigen::Matrix2d Kk = -m.K * direction(k) * m.K, Kl = -m.K * direction(l) * m.K;
          const Eigen::Matrix2d Kkl =
              m.K * direction(k) * m.K * direction(l) * m.K + m.K * direction(l) * m.K * direction(k) * m.K;
          const Eigen::Matrix2d T = Kkl * m.P * m.K + Kk * m.P * Kl + Kl * m.P * Kk + m.K * m.P * Kkl - Kkl;
          result(k, l) = m.c / 4 * product(T, dP);
        }
      }
      return result;
    });
  }

 private:
  // How P and Q change with one component of the Green strain (E11, E22, √2 E12).
  static Eigen::Matrix2d direction(int k) {
    Eigen::Matrix2d d = Eigen::Matrix2d::Zero();
    if (k < 2) {
      d(k, k) = 2;
    } else {
      d(0, 1) = d(1, 0) = std::numbers::sqrt2;
    }
    return d;
  }
  static double product(const Eigen::Matrix2d& a, const Eigen::Matrix2d& b) {  // of symmetric matrices
    return a.cwiseProduct(b).sum();
  }
  static Eigen::Matrix2d metric_change(const Eigen::VectorXd& ds, Eigen::Index i) {
    return ds[3 * i] * direction(0) + ds[3 * i + 1] * direction(1) + ds[3 * i + 2] * direction(2);
  }

  struct Metrics {
    Metrics(const MeasureValues& at, Eigen::Index i)
        : c(at.c[i]),
          P(Eigen::Matrix2d::Identity() + metric_change(at.s, i)),
          K((Eigen::Matrix2d::Identity() + metric_change(at.S, i)).inverse()) {}
    double c;
    Eigen::Matrix2d P, K;  // K = Q⁻¹
  };

  static Eigen::Matrix3d coupling(const Metrics& m) {
    Eigen::Matrix3d result;
    for (int l = 0; l < 3; ++l) {
      const Eigen::Matrix2d dK = -m.K * direction(l) * m.K;
      const Eigen::Matrix2d dT = dK * m.P * m.K + m.K * m.P * dK - dK;
      for (int k = 0; k < 3; ++k) result(k, l) = m.c / 4 * product(dT, direction(k));
    }
    return result;
  }

  template <class Block>
  static RowMatrixXd apply(const MeasureValues& at, const RowMatrixXd& rows, const Block& block) {
    RowMatrixXd result(rows.rows(), rows.cols());
    for (Eigen::Index i = 0; i < at.c.size(); ++i) {
      result.middleRows<3>(3 * i).noalias() = block(i) * rows.middleRows<3>(3 * i);
    }
    return result;
  }
};

}  // namespace

std::unique_ptr<Law> make_quadratic_law(int components, bool periodic) {
  return std::make_unique<QuadraticLaw>(components, periodic);
}
std::unique_ptr<Law> make_printed_green_law() { return std::make_unique<PrintedGreenLaw>(); }

}  // namespace vivify::sim

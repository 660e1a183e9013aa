#include "sim/elastic/measure_family.h"

#include <map>
#include <utility>

#include "sim/elastic/measures/edge_length.h"
#include "sim/elastic/measures/volume.h"

namespace vivify::sim {

void MeasureFamily::add(const std::vector<int>& deformed, const std::vector<int>& rest, double coefficient) {
  stencils_[0].insert(stencils_[0].end(), deformed.begin(), deformed.end());
  stencils_[1].insert(stencils_[1].end(), rest.begin(), rest.end());
  coefficients_.conservativeResize(coefficients_.size() + 1);
  coefficients_[coefficients_.size() - 1] = coefficient;
}

void MeasureFamily::merge_equal_terms() {
  const int n = points_per_term();
  std::map<std::pair<std::vector<int>, std::vector<int>>, double> merged;
  for (int i = 0; i < size(); ++i) {
    const auto begin = [&](int side) { return stencils_[side].begin() + n * i; };
    merged[{std::vector<int>(begin(0), begin(0) + n), std::vector<int>(begin(1), begin(1) + n)}] +=
        coefficients_[i];
  }
  stencils_[0].clear();
  stencils_[1].clear();
  coefficients_.resize(static_cast<Eigen::Index>(merged.size()));
  Eigen::Index i = 0;
  for (const auto& [stencils, coefficient] : merged) {
    stencils_[0].insert(stencils_[0].end(), stencils.first.begin(), stencils.first.end());
    stencils_[1].insert(stencils_[1].end(), stencils.second.begin(), stencils.second.end());
    coefficients_[i++] = coefficient;
  }
}

void MeasureFamily::scatter(Side side, const Eigen::MatrixXd& g, const Eigen::VectorXd& w,
                            Eigen::VectorXd& out) const {
  const int n = points_per_term();
  const int* stencil = stencils(side).data();
  for (int i = 0; i < size(); ++i, stencil += n) {
    for (int k = 0; k < n; ++k) out.segment<3>(3 * stencil[k]) += w[i] * g.col(i).segment<3>(3 * k);
  }
}

Eigen::MatrixXd MeasureFamily::gather(Side side, const Eigen::MatrixXd& g, const Eigen::MatrixXd& Y) const {
  const int n = points_per_term();
  const int* stencil = stencils(side).data();
  Eigen::MatrixXd transposed = Eigen::MatrixXd::Zero(Y.cols(), size());
  const Eigen::MatrixXd Yt = Y.transpose();  // columns of Yt are contiguous
  for (int i = 0; i < size(); ++i, stencil += n) {
    for (int k = 0; k < n; ++k) {
      for (int axis = 0; axis < 3; ++axis)
        transposed.col(i) += g(3 * k + axis, i) * Yt.col(3 * stencil[k] + axis);
    }
  }
  return transposed.transpose();
}

void MeasureFamily::reserve(SymmetricPattern& pattern) const {
  const int n = points_per_term();
  for (int i = 0; i < size(); ++i) pattern.couple(stencils_[0].data() + n * i, n);
}

void MeasureFamily::bind(const SymmetricPattern& pattern) {
  const int n = points_per_term();
  slots_.clear();
  for (int i = 0; i < size(); ++i) pattern.append_slots(stencils_[0].data() + n * i, n, slots_);
}

namespace {

template <class Measure>
class FamilyOf final : public MeasureFamily {
 public:
  using Stencil = typename Measure::Stencil;
  using Gradient = typename Measure::Gradient;
  using Hessian = typename Measure::Hessian;
  static constexpr int kPoints = Measure::kPoints;
  static constexpr int kSize = Measure::kSize;

  explicit FamilyOf(std::string name) : name_(std::move(name)) {}

  std::string name() const override { return name_; }
  int points_per_term() const override { return kPoints; }
  bool measures_size() const override { return Measure::kMeasuresSize; }

  void values(Side side, const Eigen::VectorXd& x, Eigen::VectorXd& s) const override {
    s.resize(size());
    for (int i = 0; i < size(); ++i) s[i] = Measure::value(load(side, i, x));
  }

  void gradients(Side side, const Eigen::VectorXd& x, Eigen::VectorXd& s, Eigen::MatrixXd& g) const override {
    s.resize(size());
    g.resize(kSize, size());
    for (int i = 0; i < size(); ++i) {
      const Stencil stencil = load(side, i, x);
      s[i] = Measure::value(stencil);
      g.col(i) = Measure::gradient(stencil);
    }
  }

  void add_hessians(const Eigen::VectorXd& x, const Eigen::MatrixXd& g, const Eigen::VectorXd& a,
                    const Eigen::VectorXd& b, SymmetricMatrix& matrix) const override {
    for (int i = 0; i < size(); ++i) {
      const Gradient gradient = g.col(i);
      Hessian block = b[i] * Measure::hessian(load(Side::deformed, i, x));
      block.noalias() += (a[i] * gradient) * gradient.transpose();
      add_block(i, block, matrix);
    }
  }

  Eigen::MatrixXd hessian_products(const Eigen::VectorXd& x, const Eigen::VectorXd& l) const override {
    Eigen::MatrixXd products(kSize, size());
    for (int i = 0; i < size(); ++i) {
      products.col(i) = Measure::hessian(load(Side::deformed, i, x)) * load_flat(Side::deformed, i, l);
    }
    return products;
  }

  void add_block_a(const Eigen::VectorXd& x, const Eigen::VectorXd& S, const Eigen::VectorXd& l,
                   SymmetricMatrix& matrix) const override {
    for (int i = 0; i < size(); ++i) {
      const Stencil stencil = load(Side::deformed, i, x);
      const Gradient li = load_flat(Side::deformed, i, l);
      const Gradient g = Measure::gradient(stencil);
      const Hessian H = Measure::hessian(stencil);
      const Gradient Hl = H * li;
      const Hessian block =
          coefficients_[i] * (g.dot(li) * H + g * Hl.transpose() + Hl * g.transpose() +
                              (Measure::value(stencil) - S[i]) * Measure::third(stencil, li));
      add_block(i, block, matrix);
    }
  }

  void add_rest_hessians(const Eigen::VectorXd& X, const Eigen::VectorXd& w, const Eigen::MatrixXd& L,
                         Eigen::MatrixXd& out) const override {
    Eigen::MatrixXd local(kSize, L.cols());
    for (int i = 0; i < size(); ++i) {
      for (int k = 0; k < kPoints; ++k) {
        local.middleRows<3>(3 * k) = L.middleRows<3>(3 * stencils_[1][kPoints * i + k]);
      }
      out.noalias() += w[i] * local.transpose() * (Measure::hessian(load(Side::rest, i, X)) * local);
    }
  }

 private:
  Stencil load(Side side, int i, const Eigen::VectorXd& x) const {
    Stencil stencil;
    const int* points = stencils(side).data() + kPoints * i;
    for (int k = 0; k < kPoints; ++k) stencil.col(k) = x.segment<3>(3 * points[k]);
    return stencil;
  }

  Gradient load_flat(Side side, int i, const Eigen::VectorXd& x) const {
    const Stencil stencil = load(side, i, x);
    return Eigen::Map<const Gradient>(stencil.data());
  }

  void add_block(int i, const Hessian& block, SymmetricMatrix& matrix) const {
    static constexpr int kEntries = kSize * (kSize + 1) / 2;
    double* values = matrix.values();
    const int* slot = slots_.data() + kEntries * i;
    for (int column = 0; column < kSize; ++column) {
      for (int row = column; row < kSize; ++row) values[*slot++] += block(row, column);
    }
  }

  std::string name_;
};

}  // namespace

std::unique_ptr<MeasureFamily> make_edge_length_family() {
  return std::make_unique<FamilyOf<EdgeLength<3>>>("edge_length");
}
std::unique_ptr<MeasureFamily> make_volume_family() { return std::make_unique<FamilyOf<Volume>>("volume"); }

}  // namespace vivify::sim

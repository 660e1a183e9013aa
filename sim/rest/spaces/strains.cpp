#include <cmath>

#include "sim/rest/registration.h"
#include "sim/rest/rest_space.h"

namespace vivify::sim {
namespace {

// S(q) = S₀ + Σ q_k (s(X_k) − S₀), where squared lengths interpolate as lengths: S = ℓ(q)².
class StrainSpace final : public RestSpace {
 public:
  // `weights`: the identity; p are the weights of the examples.
  StrainSpace(const RestSpaceInput& input, const Eigen::MatrixXd& weights)
      : RestSpace(weights, 1, weights, example_groups(input.examples)) {
    const Eigen::VectorXd X0 = stack(input.reference.V, input.points);
    for (const auto& family : input.families) {
      const bool squares = is_squared_length(*family);
      Eigen::VectorXd S0, Sk;
      family->values(Side::rest, X0, S0);
      Eigen::MatrixXd dS(S0.size(), parameters());
      if (squares) S0 = S0.cwiseSqrt();
      for (int k = 0; k < parameters(); ++k) {
        const ExamplePose& pose = input.examples[static_cast<std::size_t>(k)];
        check_pose(pose, input.reference);
        family->values(Side::rest, stack(pose.V, input.points), Sk);
        if (squares) Sk = Sk.cwiseSqrt();
        dS.col(k) = strain(Sk, S0, family->kind() == MeasureKind::angle);
      }
      squares_.push_back(squares);
      S0_.push_back(std::move(S0));
      dS_.push_back(std::move(dS));
    }
  }

  void measures(const ElasticFamilies&, const Eigen::VectorXd& q, std::vector<Eigen::VectorXd>& S,
                std::vector<RowMatrixXd>* J) const override {
    S.resize(S0_.size());
    if (J != nullptr) J->resize(S0_.size());
    for (std::size_t f = 0; f < S0_.size(); ++f) {
      const Eigen::VectorXd value = S0_[f] + dS_[f] * q;
      S[f] = squares_[f] ? Eigen::VectorXd(value.cwiseAbs2()) : value;
      if (J == nullptr) continue;
      if (squares_[f]) {
        (*J)[f] = (2 * value).asDiagonal() * dS_[f];
      } else {
        (*J)[f] = dS_[f];
      }
    }
  }

  void add_hessians(const ElasticFamilies&, const Eigen::VectorXd&,
                    const std::vector<Eigen::VectorXd>& weights, Eigen::MatrixXd& C) const override {
    for (std::size_t f = 0; f < S0_.size(); ++f) {
      if (squares_[f]) C += dS_[f].transpose() * (2 * weights[f]).asDiagonal() * dS_[f];
    }
  }

 private:
  static bool is_squared_length(const MeasureFamily& family) { return family.points_per_term() == 2; }

  std::vector<bool> squares_;
  std::vector<Eigen::VectorXd> S0_;
  std::vector<Eigen::MatrixXd> dS_;
};

}  // namespace

std::unique_ptr<RestSpace> make_strains_space(const RestSpaceInput& input) {
  const auto examples = static_cast<Eigen::Index>(input.examples.size());
  return std::make_unique<StrainSpace>(input, Eigen::MatrixXd::Identity(examples, examples));
}

}  // namespace vivify::sim

// Rest-shape parameterisation, equation (4) of Coros et al. 2012: X(p) = X₀ + L p. A rest space is a linear
// map from p to the stacked rest points; compatible spaces (full, cage) and incompatible ones (examples) are
// the same code. Rigid motions of the rest shape change no measure, so they are null directions of the
// control problem: p moves in the span of an orthonormal basis of the others only, p = basis · q.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/elastic/models.h"

namespace vivify::sim {

// A pose of the simulation mesh, and the group of examples that share one convex hull (Section 5.1).
struct ExamplePose {
  std::string name;
  std::string group;
  RowMatrixXd V;  // #V by d
};

// What a rest space is made from. `families` and `points` are of the layout that its entry asks for.
struct RestSpaceInput {
  const SimMesh& reference;  // X̄, the shape as placed in the scene
  const ElasticFamilies& families;
  const RestPoints& points;
  const Eigen::MatrixXd& cage_weights;  // #V by #C: coordinates of the rest vertices in the cage
  const std::vector<ExamplePose>& examples;
};

class RestSpace {
 public:
  // `unit`: size of a large parameter (m for displacements, 1 for weights of examples). `poses`: parameters
  // of each example. `groups`: parameters that are weights of examples, by convex hull.
  RestSpace(Eigen::MatrixXd basis, double unit, Eigen::MatrixXd poses, std::vector<std::vector<int>> groups)
      : basis_(std::move(basis)), unit_(unit), poses_(std::move(poses)), groups_(std::move(groups)) {}
  virtual ~RestSpace() = default;

  int parameters() const { return static_cast<int>(basis_.rows()); }
  int free_parameters() const { return static_cast<int>(basis_.cols()); }
  const Eigen::MatrixXd& basis() const { return basis_; }  // #p by #q
  double unit() const { return unit_; }
  // #p by #examples: the parameters of each example, as near as the space comes to it.
  const Eigen::MatrixXd& poses() const { return poses_; }
  const std::vector<std::vector<int>>& groups() const { return groups_; }

  // Measures S of the rest shape at q, per family (#values), and when J is not null their derivatives ∂S/∂q
  // (#values by #q).
  virtual void measures(const ElasticFamilies& families, const Eigen::VectorXd& q,
                        std::vector<Eigen::VectorXd>& S, std::vector<RowMatrixXd>* J) const = 0;
  // C += Σ w ∂²S/∂q² for weights per family.
  virtual void add_hessians(const ElasticFamilies& families, const Eigen::VectorXd& q,
                            const std::vector<Eigen::VectorXd>& weights, Eigen::MatrixXd& C) const = 0;
  // How the stacked rest points move when q changes by dq, m; empty without a rest shape.
  virtual Eigen::VectorXd motion(const Eigen::VectorXd&) const { return {}; }

 private:
  Eigen::MatrixXd basis_;
  double unit_;
  Eigen::MatrixXd poses_;
  std::vector<std::vector<int>> groups_;
};

// The linear map (4): stacked rest points X₀ + L basis q.
class ShapeSpace final : public RestSpace {
 public:
  ShapeSpace(Eigen::VectorXd X0, const Eigen::MatrixXd& L, Eigen::MatrixXd basis, double unit,
             Eigen::MatrixXd poses = {}, std::vector<std::vector<int>> groups = {});

  const Eigen::VectorXd& X0() const { return X0_; }
  const RowMatrixXd& L() const { return Lq_; }  // L · basis, a row per coordinate of the rest points
  Eigen::VectorXd shape(const Eigen::VectorXd& q) const { return X0_ + Lq_ * q; }

  void measures(const ElasticFamilies& families, const Eigen::VectorXd& q, std::vector<Eigen::VectorXd>& S,
                std::vector<RowMatrixXd>* J) const override;
  void add_hessians(const ElasticFamilies& families, const Eigen::VectorXd& q,
                    const std::vector<Eigen::VectorXd>& weights, Eigen::MatrixXd& C) const override;
  Eigen::VectorXd motion(const Eigen::VectorXd& dq) const override { return Lq_ * dq; }

 private:
  Eigen::VectorXd X0_;
  RowMatrixXd Lq_;
};

struct RestSpaceEntry {
  std::string_view name;
  RestLayout layout;
  std::unique_ptr<RestSpace> (*make)(const RestSpaceInput& input);
};

// Every rest space. A new one is a file in spaces/ and a line in this table.
std::span<const RestSpaceEntry> rest_spaces();
const RestSpaceEntry& rest_space_entry(std::string_view name);

// full: every vertex is free (p: its displacement).
std::unique_ptr<RestSpace> make_full_space(const RestSpaceInput& input);
// cage: p are the displacements of the cage vertices, and the rest vertices follow with their harmonic
// coordinates (Section 4). Examples are poses to take, as near as the cage comes to them: in the sense of
// least squares, where what the pose leaves in its place counts more, so that it stands as the pose does.
std::unique_ptr<RestSpace> make_cage_space(const RestSpaceInput& input);
// examples: p are weights of poses, interpolated element by element after registration (Section 5). Throws
// Error(geometry) that names the pose and the element when one is turned inside out or has no size.
std::unique_ptr<RestSpace> make_examples_space(const RestSpaceInput& input);
// strains: p are weights of poses, interpolated in the measures themselves: Green strain (Martin et al.
// 2011), or lengths and angles (Fröhlich and Botsch 2011). The reference of Figures 4 and 5; it is not a rest
// shape, but a target of strain.
std::unique_ptr<RestSpace> make_strains_space(const RestSpaceInput& input);

// Flat vector (d #points) of the positions V (#V by d) of the vertices that the points copy.
Eigen::VectorXd stack(const RowMatrixXd& V, const RestPoints& points);
// The unit of length of a body (m): its height (along y), for bodies that lie flat a fifth of their diagonal.
double unit_length(const RowMatrixXd& V);
// Groups of examples as lists of their parameters.
std::vector<std::vector<int>> example_groups(const std::vector<ExamplePose>& examples);

// The orthonormal complement of the parameters whose L p is zero or a rigid motion of X₀ (translation or
// linearised rotation). X₀ is flat with `dimension` coordinates per point.
Eigen::MatrixXd shape_changing_basis(const Eigen::VectorXd& X0, const Eigen::MatrixXd& L, int dimension);

}  // namespace vivify::sim

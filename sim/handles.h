// Handles of a body: each holds a part of it where its motion says. Springs so stiff that the part is there
// but for a hair; they act from outside like a contact, and the optimiser sees them.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "sim/contact/rigid_path.h"
#include "sim/control/rigid_motion.h"
#include "sim/region.h"
#include "sim/solve/sparse_matrix.h"

namespace vivify::sim {

// Of a step: a time that is meant is hit in spite of rounding.
inline constexpr double kTimeTolerance = 1e-6;

// At the time t the vertices with the rest places X are held at about + R(t) (X − about) + u(t), where the
// pose of the motion turns by R and moves by u. Without motion it is a pin.
struct Handle {
  Region region;
  std::optional<Eigen::Vector3d> about = {};  // shares of the bounding box; else the middle of the vertices
  RigidPath motion = {};
  double until = std::numeric_limits<double>::infinity();  // s; steps that end later are free
};

// What handles do in one step: the potential Σ ½ k |x_i − y_i|².
class Hold {
 public:
  struct Spring {
    int vertex;
    double stiffness;       // k, N/m
    Eigen::Vector3d place;  // y, m; in the plane z is 0
  };

  Hold() = default;
  Hold(std::vector<Spring> springs, int dimension) : springs_(std::move(springs)), dimension_(dimension) {}

  const std::vector<Spring>& springs() const { return springs_; }

  double energy(const Eigen::VectorXd& x) const;  // J
  void add_gradient(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) const;
  // `diagonal_slots` (d #V): places of the diagonal in the matrix. The Hessian is constant.
  void add_hessian(const std::vector<int>& diagonal_slots, SymmetricMatrix& matrix) const;
  // Sum of the forces on the body, N.
  Eigen::Vector3d total_force(const Eigen::VectorXd& x) const;

 private:
  Eigen::Vector3d stretch(const Spring& spring, const Eigen::VectorXd& x) const {
    return spatial_point(x, spring.vertex, dimension_) - spring.place;
  }

  std::vector<Spring> springs_;
  int dimension_ = 3;
};

class Handles {
 public:
  Handles() = default;
  // Of a body with the rest vertices V (#V by d). `stiffness`: its weight over its height, N/m. Throws
  // Error(usage) for a handle that holds nothing and for a vertex that is held twice.
  Handles(std::vector<Handle> handles, const RowMatrixXd& V, double stiffness);

  // In a step of size h that ends at the time `end`.
  Hold at(double end, double h) const;

 private:
  struct Part {
    Handle handle;
    std::vector<int> vertices;
    Points rest;  // #vertices by 3
    Eigen::Vector3d about;
  };
  std::vector<Part> parts_;
  double stiffness_ = 0;  // of all springs of a handle together, N/m
  int dimension_ = 3;
};

}  // namespace vivify::sim

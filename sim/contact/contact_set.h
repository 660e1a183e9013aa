// Contacts of one body for one step: which points may touch which plane, where they are anchored, and the
// energy, force and stiffness that follow (Coros et al. 2012, Section 3, with one-sided normal forces and a
// Coulomb limit).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/mesh.h"
#include "sim/contact/collider.h"
#include "sim/contact/friction.h"
#include "sim/contact/normal_force.h"
#include "sim/solve/sparse_matrix.h"

namespace vivify::sim {

// Points of a body that may touch: each a fixed combination of the vertices of an element, so that the drawn
// surface itself touches. Bodies of the plane touch with their points of z = 0.
struct ContactPoints {
  RowMatrixXi vertices;  // #P by k
  RowMatrixXd weights;   // #P by k
  int dimension = 3;     // coordinates per vertex

  int size() const { return static_cast<int>(vertices.rows()); }
  int corners() const { return static_cast<int>(vertices.cols()); }
  Eigen::Vector3d position(int i, const Eigen::VectorXd& x) const {
    Eigen::Vector3d y = Eigen::Vector3d::Zero();
    for (int k = 0; k < corners(); ++k) {
      const double* vertex = x.data() + dimension * vertices(i, k);
      for (int axis = 0; axis < dimension; ++axis) y[axis] += weights(i, k) * vertex[axis];
    }
    return y;
  }
};

// What a contact point remembers from step to step.
struct ContactMemory {
  bool touching = false;  // the normal force was positive at the end of the last step
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();  // in the collider's own frame, m
  double normal_force = 0;                           // f_n at the end of the last step, N
  int collider = -1;                                 // that it touched
};

// Coulomb's μ with something of that name.
using FrictionByName = std::map<std::string, double>;

struct ContactParameters {
  double layer = 0;               // δ, m
  double normal_stiffness = 0;    // N/m²
  double friction_stiffness = 0;  // N/m
  double friction = 1;            // the body's factor of Coulomb's μ: that of a pair is the product of both
  bool self = false;              // whether the body touches itself
  FrictionByName friction_with = {};  // μ in place of the product

  // Coulomb's μ with something that has a name and a factor of its own.
  double friction_against(const std::string& name, double factor) const;
};

// One point against one plane, fixed for the step.
struct Contact {
  int point;
  int collider;
  bool touched;                    // at the end of the last step: the anchor is of then
  Eigen::Vector3d origin, normal;  // plane of the nearest surface point
  Eigen::Vector3d anchor;
  Friction friction;
};

// What a contact does at the end of a step, for plots and pictures.
struct ContactForce {
  int first, second;               // contact point and collider; between bodies: body a and body b
  Eigen::Vector3d position;        // of the point; of the place of a that friction holds, m
  Eigen::Vector3d normal_force;    // on the body; on a, N
  Eigen::Vector3d friction_force;  // likewise
  Eigen::Vector3d anchor;          // where the position would be without tension of the friction spring, m
  double slip;                     // how far the anchor was dragged along in the step, m; 0: it sticks
  double distance;                 // of the surfaces, m; negative where they penetrate
};

class ContactSet {
 public:
  ContactSet() = default;

  // Planes for every point that can reach a collider: those nearer than `reach` at `x`. Friction acts where
  // the point touched at the end of the last step. The step is from `begin` to `end` (s): planes and anchors
  // move with their colliders. `x` are positions of the beginning, or of the end (`settled`).
  ContactSet(const ContactPoints& points, const ContactParameters& parameters,
             const std::vector<Collider>& colliders, const Eigen::VectorXd& x, double reach,
             const std::vector<ContactMemory>& memory, double begin = 0, double end = 0,
             bool settled = false);

  const std::vector<Contact>& contacts() const { return contacts_; }

  double energy(const Eigen::VectorXd& x) const;
  void add_gradient(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) const;
  void add_hessian(const Eigen::VectorXd& x, const std::vector<int>& slots, SymmetricMatrix& matrix) const;
  // matrix += d/dε Hessian(x + ε l): the contact part of block A of equation (13).
  void add_block_a(const Eigen::VectorXd& x, const Eigen::VectorXd& l, const std::vector<int>& slots,
                   SymmetricMatrix& matrix) const;

  double distance(const Contact& contact, const Eigen::VectorXd& x) const {
    return contact.normal.dot(points_->position(contact.point, x) - contact.origin);
  }
  // Normal force of a contact, N.
  double normal_force(const Contact& contact, const Eigen::VectorXd& x) const {
    return normal_.force(distance(contact, x));
  }
  // Every contact with a force.
  std::vector<ContactForce> forces(const Eigen::VectorXd& x) const;
  // Sum of the forces that the world exerts on the body, N.
  Eigen::Vector3d total_force(const Eigen::VectorXd& x) const;

  // Whether the planes still describe the colliders at x: no point in reach of the layer is farther than
  // `tolerance` from the distance that its plane gives.
  bool planes_hold(const std::vector<Collider>& colliders, const Eigen::VectorXd& x, double tolerance) const;

  // Memory after the step that ended at x: anchors set at first touch, dragged along by slip, dropped on
  // release.
  void update_memory(const Eigen::VectorXd& x, std::vector<ContactMemory>& memory) const;

 private:
  void scatter(const Contact& contact, const Eigen::Matrix3d& block, const std::vector<int>& slots,
               SymmetricMatrix& matrix) const;

  const ContactPoints* points_ = nullptr;
  std::vector<Eigen::Isometry3d> poses_;  // of the colliders at the end of the step
  NormalForce normal_ = {0, 0};
  std::vector<Contact> contacts_;
};

// What a body stands on: what pushes it upwards counts, walls do not.
struct Ground {
  double load = 0;                               // sum of the upward parts of the normal forces, N
  std::optional<Eigen::Vector3d> velocity = {};  // of the colliders among it, weighted by load, m/s
};

// Colliders that were touched at the end of the last step, with their velocity in a step from `begin` to
// `end` (s).
Ground ground_under(const std::vector<ContactMemory>& memory, const std::vector<Collider>& colliders,
                    double begin, double end);

}  // namespace vivify::sim

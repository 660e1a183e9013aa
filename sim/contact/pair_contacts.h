// Contacts between bodies of one island (and of a body with itself), fixed for one pass of a step. Each is a
// spring between two places of two surfaces; its energy depends on the difference of the two places only, so
// the forces on the two bodies are equal and opposite.
#pragma once

#include <Eigen/Core>
#include <array>
#include <compare>
#include <set>
#include <vector>

#include "sim/contact/contact_surface.h"
#include "sim/contact/friction.h"
#include "sim/contact/normal_force.h"
#include "sim/contact/surface_pairs.h"
#include "sim/solve/sparse_matrix.h"

namespace vivify::sim {

// A place on a surface: a combination of up to three of its points; −1 and weight 0 where there are fewer.
struct MaterialPlace {
  std::array<int, 3> points;
  std::array<double, 3> weights;
};

// A combination Σ w_k x_k of vertices of an island.
struct Stencil {
  std::vector<int> vertices;
  std::vector<double> weights;

  // Adds `sign` times the place of a surface whose body's vertices begin at `first_vertex`.
  void add(const ContactPoints& points, const MaterialPlace& place, int first_vertex, double sign);
  Eigen::Vector3d position(const Eigen::VectorXd& x, int dimension) const;
};

// Which features touch: stays the same over steps while they do.
struct PairIdentity {
  int body_a, body_b;  // of the world
  int kind;            // SurfacePair::Kind
  int feature_a, feature_b;
  auto operator<=>(const PairIdentity&) const = default;
};

// What a contact remembers from step to step.
struct PairMemory {
  PairIdentity identity;
  MaterialPlace a, b;                                // material places that friction holds together
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  // y_a − y_b where the friction spring is slack, m
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // from b to a at the end of the step
  double normal_force = 0;                           // at the end of the step, N
  double distance = 0;                               // then, m; negative where the surfaces penetrate
  // For plots and pictures only; not kept over a restart.
  Eigen::Vector3d friction_force = Eigen::Vector3d::Zero();  // on a, N
  double slip = 0;  // how far the offset was dragged along in the step, m; 0: it sticks
};

struct PairContact {
  PairIdentity identity;
  MaterialPlace place_a, place_b;    // nearest places
  MaterialPlace anchor_a, anchor_b;  // where friction acts
  Stencil gap;                       // y_a − y_b
  Stencil slip;                      // between the anchors
  Eigen::Vector3d normal;            // unit, from b to a
  double thickness;                  // distance of the places when the surfaces touch, m
  NormalForce law;
  Eigen::Vector3d offset;
  Friction friction;
  bool touched = false;  // at the end of the last step
};

class PairContacts {
 public:
  explicit PairContacts(int dimension = 3) : dimension_(dimension) {}

  void add(PairContact contact) { contacts_.push_back(std::move(contact)); }
  const std::vector<PairContact>& contacts() const { return contacts_; }

  // The vertices that each stencil couples, ascending.
  std::set<std::vector<int>> couplings() const;
  // Remembers where the entries that the Hessians write lie in a pattern that has them.
  void bind(const SymmetricPattern& pattern);

  double energy(const Eigen::VectorXd& x) const;
  void add_gradient(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) const;
  void add_hessian(const Eigen::VectorXd& x, SymmetricMatrix& matrix) const;
  // matrix += d/dε Hessian(x + ε l): the contact part of block A of equation (13).
  void add_block_a(const Eigen::VectorXd& x, const Eigen::VectorXd& l, SymmetricMatrix& matrix) const;

  // Distance between the surfaces along the frozen normal, m.
  double distance(const PairContact& contact, const Eigen::VectorXd& x) const;
  double normal_force(const PairContact& contact, const Eigen::VectorXd& x) const;
  // Force of body b on body a, N.
  Eigen::Vector3d force_on_a(const PairContact& contact, const Eigen::VectorXd& x) const;
  // What touches at x: anchors set at first touch, dragged along by slip, dropped on release. Sorted by
  // identity.
  std::vector<PairMemory> memory(const Eigen::VectorXd& x) const;

 private:
  Eigen::Vector3d slip_offset(const PairContact& contact, const Eigen::VectorXd& x) const;

  int dimension_;
  std::vector<PairContact> contacts_;
  std::vector<int> slots_;  // of the blocks of each contact: of its gap, then of its slip
};

}  // namespace vivify::sim

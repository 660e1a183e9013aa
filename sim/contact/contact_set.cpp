#include "sim/contact/contact_set.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace vivify::sim {
namespace {

constexpr double kLeastPlanarNormal = 0.1;  // of a normal's part in the plane of a flat body

// The nearest place of a collider that stands at `pose`, as a body of that dimension meets it: flat bodies
// meet its section with the plane z = 0. Empty where the collider faces across the plane.
std::optional<SurfacePoint> nearest_place(const Collider& collider, const Eigen::Isometry3d& pose,
                                          const Eigen::Vector3d& y, int dimension) {
  SurfacePoint nearest = collider.nearest(y, pose);
  if (dimension == 3) return nearest;
  nearest.normal.z() = 0;
  const double length = nearest.normal.norm();
  if (length < kLeastPlanarNormal) return std::nullopt;
  nearest.normal /= length;
  nearest.position.z() = 0;
  return nearest;
}

}  // namespace

double ContactParameters::friction_against(const std::string& name, double factor) const {
  const auto given = friction_with.find(name);
  if (given != friction_with.end()) return given->second;
  return friction == 0 || factor == 0 ? 0 : friction * factor;  // also of 0 · ∞
}

ContactSet::ContactSet(const ContactPoints& points, const ContactParameters& parameters,
                       const std::vector<Collider>& colliders, const Eigen::VectorXd& x, double reach,
                       const std::vector<ContactMemory>& memory, double begin, double end, bool settled)
    : points_(&points), normal_{parameters.normal_stiffness, parameters.layer} {
  std::vector<Eigen::Isometry3d> moves;  // from the place at `x` to that at the end
  std::vector<double> friction;          // Coulomb's μ with each collider
  for (const Collider& collider : colliders) {
    poses_.push_back(collider.pose(end));
    friction.push_back(parameters.friction_against(collider.name(), collider.friction()));
    moves.push_back(settled ? Eigen::Isometry3d::Identity() : poses_.back() * collider.pose(begin).inverse());
  }
  for (int i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d y = points.position(i, x);
    for (int c = 0; c < static_cast<int>(colliders.size()); ++c) {
      const Collider& collider = colliders[c];
      const Eigen::Isometry3d& from = settled            ? poses_[c]
                                      : collider.moves() ? collider.pose(begin)
                                                         : poses_[c];
      std::optional<SurfacePoint> nearest = nearest_place(collider, from, y, points.dimension);
      if (!nearest) continue;
      double travel = 0;
      if (collider.moves()) {
        const Eigen::Vector3d moved = moves[c] * nearest->position;
        travel = (moved - nearest->position).norm();
        nearest->position = moved;
        nearest->normal = moves[c].linear() * nearest->normal;
      }
      if (nearest->distance > reach + travel) continue;
      const bool touched = memory[i].touching && memory[i].collider == c;
      const double limit = touched ? friction[static_cast<std::size_t>(c)] * memory[i].normal_force : 0.0;
      Eigen::Vector3d anchor = memory[i].anchor;
      if (touched) {
        const Eigen::Vector3d carried = (end - begin) * collider.surface_velocity();
        if (!carried.isZero(0)) anchor += carried;
        if (collider.moves()) anchor = poses_[c] * anchor;
      }
      contacts_.push_back({i, c, touched, nearest->position, nearest->normal, anchor,
                           Friction(parameters.friction_stiffness, limit)});
    }
  }
}

double ContactSet::energy(const Eigen::VectorXd& x) const {
  double sum = 0;
  for (const Contact& contact : contacts_) {
    const Eigen::Vector3d y = points_->position(contact.point, x);
    sum += normal_.energy(contact.normal.dot(y - contact.origin));
    sum += contact.friction.energy(tangential(contact.normal, y - contact.anchor));
  }
  return sum;
}

void ContactSet::add_gradient(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) const {
  for (const Contact& contact : contacts_) {
    const Eigen::Vector3d y = points_->position(contact.point, x);
    const Eigen::Vector3d g = -normal_.force(contact.normal.dot(y - contact.origin)) * contact.normal +
                              contact.friction.gradient(tangential(contact.normal, y - contact.anchor));
    const int d = points_->dimension;
    for (int k = 0; k < points_->corners(); ++k) {
      gradient.segment(d * points_->vertices(contact.point, k), d) +=
          points_->weights(contact.point, k) * g.head(d);
    }
  }
}

void ContactSet::scatter(const Contact& contact, const Eigen::Matrix3d& block, const std::vector<int>& slots,
                         SymmetricMatrix& matrix) const {
  const int d = points_->dimension, size = d * points_->corners();
  const int* slot = slots.data() + size * (size + 1) / 2 * contact.point;
  double* values = matrix.values();
  for (int column = 0; column < size; ++column) {
    for (int row = column; row < size; ++row) {
      values[*slot++] += points_->weights(contact.point, row / d) *
                         points_->weights(contact.point, column / d) * block(row % d, column % d);
    }
  }
}

void ContactSet::add_hessian(const Eigen::VectorXd& x, const std::vector<int>& slots,
                             SymmetricMatrix& matrix) const {
  for (const Contact& contact : contacts_) {
    const Eigen::Vector3d y = points_->position(contact.point, x);
    const Eigen::Matrix3d nn = contact.normal * contact.normal.transpose();
    const Eigen::Matrix3d T = Eigen::Matrix3d::Identity() - nn;
    const Eigen::Matrix3d block =
        normal_.second(contact.normal.dot(y - contact.origin)) * nn +
        T * contact.friction.hessian(tangential(contact.normal, y - contact.anchor)) * T;
    if (block.isZero(0)) continue;
    scatter(contact, block, slots, matrix);
  }
}

void ContactSet::add_block_a(const Eigen::VectorXd& x, const Eigen::VectorXd& l,
                             const std::vector<int>& slots, SymmetricMatrix& matrix) const {
  for (const Contact& contact : contacts_) {
    const Eigen::Vector3d y = points_->position(contact.point, x), w = points_->position(contact.point, l);
    const Eigen::Matrix3d nn = contact.normal * contact.normal.transpose();
    const Eigen::Matrix3d T = Eigen::Matrix3d::Identity() - nn;
    const Eigen::Vector3d u = tangential(contact.normal, y - contact.anchor);
    const Eigen::Matrix3d block =
        normal_.third(contact.normal.dot(y - contact.origin)) * contact.normal.dot(w) * nn +
        T * contact.friction.third(u, tangential(contact.normal, w)) * T;
    scatter(contact, block, slots, matrix);
  }
}

std::vector<ContactForce> ContactSet::forces(const Eigen::VectorXd& x) const {
  std::vector<ContactForce> forces;
  for (const Contact& contact : contacts_) {
    const Eigen::Vector3d y = points_->position(contact.point, x);
    const Eigen::Vector3d u = tangential(contact.normal, y - contact.anchor);
    const Eigen::Vector3d normal = normal_force(contact, x) * contact.normal,
                          friction = -contact.friction.gradient(u);
    if (normal.isZero(0) && friction.isZero(0)) continue;
    const Eigen::Vector3d kept = contact.touched ? contact.friction.return_map(u) : Eigen::Vector3d::Zero();
    forces.push_back({contact.point, contact.collider, y, normal, friction, y - kept,
                      contact.touched ? (u - kept).norm() : 0.0, distance(contact, x)});
  }
  return forces;
}

Eigen::Vector3d ContactSet::total_force(const Eigen::VectorXd& x) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Contact& contact : contacts_) {
    const Eigen::Vector3d y = points_->position(contact.point, x);
    sum += normal_.force(contact.normal.dot(y - contact.origin)) * contact.normal -
           contact.friction.gradient(tangential(contact.normal, y - contact.anchor));
  }
  return sum;
}

bool ContactSet::planes_hold(const std::vector<Collider>& colliders, const Eigen::VectorXd& x,
                             double tolerance) const {
  for (const Contact& contact : contacts_) {
    const double assumed = distance(contact, x);
    if (assumed > normal_.layer + tolerance) continue;
    const Eigen::Vector3d y = points_->position(contact.point, x);
    const double actual = colliders[contact.collider].nearest(y, poses_[contact.collider]).distance;
    if (std::abs(actual - assumed) > tolerance) return false;
  }
  return true;
}

void ContactSet::update_memory(const Eigen::VectorXd& x, std::vector<ContactMemory>& memory) const {
  std::vector<ContactMemory> next(memory.size());
  for (const Contact& contact : contacts_) {
    const double force = normal_force(contact, x);
    ContactMemory& after = next[contact.point];
    if (!(force > after.normal_force))
      continue;  // with several colliders a point belongs to the one that presses most
    const Eigen::Vector3d y = points_->position(contact.point, x);
    after.touching = true;
    after.normal_force = force;
    after.anchor = y;
    after.collider = contact.collider;
    if (contact.touched) {
      after.anchor = y - contact.friction.return_map(tangential(contact.normal, y - contact.anchor));
    }
    // Colliders that do not move stand at the identity.
    if (!poses_[contact.collider].matrix().isIdentity(0))
      after.anchor = poses_[contact.collider].inverse() * after.anchor;
  }
  memory = std::move(next);
}

Ground ground_under(const std::vector<ContactMemory>& memory, const std::vector<Collider>& colliders,
                    double begin, double end) {
  Ground ground;
  Eigen::Vector3d flow = Eigen::Vector3d::Zero();
  for (const ContactMemory& contact : memory) {
    if (!contact.touching) continue;
    const Collider& collider = colliders[static_cast<std::size_t>(contact.collider)];
    const Eigen::Vector3d normal = collider.nearest(contact.anchor).normal;
    const Eigen::Isometry3d before = collider.pose(begin), after = collider.pose(end);
    const double load = contact.normal_force * std::max(0.0, (before.linear() * normal).y());
    ground.load += load;
    const Eigen::Vector3d& belt = collider.surface_velocity();
    if (!collider.moves() && belt.isZero(0)) continue;
    const Eigen::Vector3d along = after.linear() * tangential(normal, belt);
    flow += load * ((after * contact.anchor - before * contact.anchor) / (end - begin) + along);
  }
  if (ground.load > 0) ground.velocity = flow / ground.load;
  return ground;
}

}  // namespace vivify::sim

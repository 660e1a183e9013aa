#include "sim/contact/pair_contacts.h"

#include <algorithm>
#include <cmath>

#include "common/parallel.h"

namespace vivify::sim {
namespace {

constexpr std::size_t kContactsOfTask = 64;

// What `value_of` returns for each contact.
template <typename Value, typename Function>
std::vector<Value> of_each(const std::vector<PairContact>& contacts, const Function& value_of) {
  std::vector<Value> values(contacts.size());
  const auto evaluate = [&](std::size_t task) {
    const std::size_t end = std::min((task + 1) * kContactsOfTask, contacts.size());
    for (std::size_t i = task * kContactsOfTask; i < end; ++i) values[i] = value_of(contacts[i]);
  };
  const std::size_t tasks = (contacts.size() + kContactsOfTask - 1) / kContactsOfTask;
  if (tasks > 1) {
    parallel_for(tasks, evaluate);
  } else if (tasks == 1) {
    evaluate(0);
  }
  return values;
}

// Of the normal force and of friction.
struct Gradients {
  Eigen::Vector3d gap, slip;
};
struct Hessians {
  Eigen::Matrix3d gap, slip;
};

void add_forces(const Stencil& stencil, const Eigen::Vector3d& g, int dimension, Eigen::VectorXd& gradient) {
  if (g.isZero(0)) return;
  for (std::size_t k = 0; k < stencil.vertices.size(); ++k) {
    gradient.segment(dimension * stencil.vertices[k], dimension) += stencil.weights[k] * g.head(dimension);
  }
}

// matrix += (w wᵀ) ⊗ block for the stencil whose blocks begin at `slot`; returns the end of its slots.
const int* add_block(const Stencil& stencil, const Eigen::Matrix3d& block, int dimension, const int* slot,
                     double* values) {
  const std::size_t count = stencil.vertices.size();
  if (block.isZero(0)) return slot + static_cast<std::size_t>(dimension) * count * (count + 1) / 2;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const double weight = stencil.weights[i] * stencil.weights[j];
      for (int column = 0; column < dimension; ++column, ++slot) {
        double* entry = values + *slot;
        for (int row = i == j ? column : 0; row < dimension; ++row) *entry++ += weight * block(row, column);
      }
    }
  }
  return slot;
}

}  // namespace

void Stencil::add(const ContactPoints& points, const MaterialPlace& place, int first_vertex, double sign) {
  for (int k = 0; k < 3; ++k) {
    if (place.points[k] < 0 || place.weights[k] == 0) continue;
    for (int c = 0; c < points.corners(); ++c) {
      const double weight = sign * place.weights[k] * points.weights(place.points[k], c);
      if (weight == 0) continue;
      const int vertex = first_vertex + points.vertices(place.points[k], c);
      const auto found = std::find(vertices.begin(), vertices.end(), vertex);
      if (found == vertices.end()) {
        vertices.push_back(vertex);
        weights.push_back(weight);
      } else {
        weights[static_cast<std::size_t>(found - vertices.begin())] += weight;
      }
    }
  }
}

Eigen::Vector3d Stencil::position(const Eigen::VectorXd& x, int dimension) const {
  Eigen::Vector3d y = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    y.head(dimension) += weights[k] * x.segment(dimension * vertices[k], dimension);
  }
  return y;
}

std::set<std::vector<int>> PairContacts::couplings() const {
  std::set<std::vector<int>> all;
  for (const PairContact& contact : contacts_) {
    for (const Stencil* stencil : {&contact.gap, &contact.slip}) {
      std::vector<int> vertices = stencil->vertices;
      std::sort(vertices.begin(), vertices.end());
      all.insert(std::move(vertices));
    }
  }
  return all;
}

void PairContacts::bind(const SymmetricPattern& pattern) {
  slots_.clear();
  std::vector<double> turned;  // blocks of contacts are symmetric
  for (const PairContact& contact : contacts_) {
    for (const Stencil* stencil : {&contact.gap, &contact.slip}) {
      pattern.append_columns(stencil->vertices.data(), static_cast<int>(stencil->vertices.size()), slots_,
                             turned);
    }
  }
}

double PairContacts::distance(const PairContact& contact, const Eigen::VectorXd& x) const {
  return contact.normal.dot(contact.gap.position(x, dimension_)) - contact.thickness;
}

double PairContacts::normal_force(const PairContact& contact, const Eigen::VectorXd& x) const {
  return contact.law.force(distance(contact, x));
}

Eigen::Vector3d PairContacts::slip_offset(const PairContact& contact, const Eigen::VectorXd& x) const {
  return tangential(contact.normal, contact.slip.position(x, dimension_) - contact.offset);
}

Eigen::Vector3d PairContacts::force_on_a(const PairContact& contact, const Eigen::VectorXd& x) const {
  return normal_force(contact, x) * contact.normal - contact.friction.gradient(slip_offset(contact, x));
}

double PairContacts::energy(const Eigen::VectorXd& x) const {
  double sum = 0;
  for (const double energy : of_each<double>(contacts_, [&](const PairContact& contact) {
         return contact.law.energy(distance(contact, x)) + contact.friction.energy(slip_offset(contact, x));
       }))
    sum += energy;
  return sum;
}

void PairContacts::add_gradient(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) const {
  const auto gradients = of_each<Gradients>(contacts_, [&](const PairContact& contact) -> Gradients {
    return {-normal_force(contact, x) * contact.normal, contact.friction.gradient(slip_offset(contact, x))};
  });
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    add_forces(contacts_[i].gap, gradients[i].gap, dimension_, gradient);
    add_forces(contacts_[i].slip, gradients[i].slip, dimension_, gradient);
  }
}

void PairContacts::add_hessian(const Eigen::VectorXd& x, SymmetricMatrix& matrix) const {
  const auto hessians = of_each<Hessians>(contacts_, [&](const PairContact& contact) -> Hessians {
    const Eigen::Matrix3d nn = contact.normal * contact.normal.transpose();
    const Eigen::Matrix3d T = Eigen::Matrix3d::Identity() - nn;
    return {contact.law.second(distance(contact, x)) * nn,
            T * contact.friction.hessian(slip_offset(contact, x)) * T};
  });
  const int* slot = slots_.data();
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    slot = add_block(contacts_[i].gap, hessians[i].gap, dimension_, slot, matrix.values());
    slot = add_block(contacts_[i].slip, hessians[i].slip, dimension_, slot, matrix.values());
  }
}

void PairContacts::add_block_a(const Eigen::VectorXd& x, const Eigen::VectorXd& l,
                               SymmetricMatrix& matrix) const {
  const int* slot = slots_.data();
  for (const PairContact& contact : contacts_) {
    const Eigen::Matrix3d nn = contact.normal * contact.normal.transpose();
    const Eigen::Matrix3d T = Eigen::Matrix3d::Identity() - nn;
    const double along = contact.normal.dot(contact.gap.position(l, dimension_));
    slot = add_block(contact.gap, contact.law.third(distance(contact, x)) * along * nn, dimension_, slot,
                     matrix.values());
    const Eigen::Vector3d across = tangential(contact.normal, contact.slip.position(l, dimension_));
    slot = add_block(contact.slip, T * contact.friction.third(slip_offset(contact, x), across) * T,
                     dimension_, slot, matrix.values());
  }
}

std::vector<PairMemory> PairContacts::memory(const Eigen::VectorXd& x) const {
  std::vector<PairMemory> memory;
  for (const PairContact& contact : contacts_) {
    const double force = normal_force(contact, x);
    if (force <= 0) continue;
    PairMemory after = {contact.identity,    contact.anchor_a, contact.anchor_b,
                        contact.offset,      contact.normal,   force,
                        distance(contact, x)};
    const Eigen::Vector3d slip = slip_offset(contact, x), kept = contact.friction.return_map(slip);
    if (kept != slip || contact.friction.slip_limit() == 0) {
      // The anchor follows: it is where the surfaces are nearest now.
      after.a = contact.place_a;
      after.b = contact.place_b;
      after.offset = tangential(contact.normal, contact.gap.position(x, dimension_)) - kept;
    }
    after.friction_force = -contact.friction.gradient(slip);
    if (contact.touched) after.slip = (slip - kept).norm();
    memory.push_back(std::move(after));
  }
  std::sort(memory.begin(), memory.end(),
            [](const PairMemory& a, const PairMemory& b) { return a.identity < b.identity; });
  return memory;
}

}  // namespace vivify::sim

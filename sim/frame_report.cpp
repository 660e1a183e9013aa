#include "sim/frame_report.h"

#include <Eigen/Geometry>

#include "sim/control/rigid_motion.h"

namespace vivify::sim {
namespace {

constexpr double kNoTranslation = 1e-9;  // of a goal's weights: how much of them is left when all is added up

Eigen::Vector3d position(const ContactSurface& surface, const MaterialPlace& place,
                         const Eigen::VectorXd& x) {
  Eigen::Vector3d y = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < place.points.size(); ++k) {
    if (place.points[k] >= 0) y += place.weights[k] * surface.points.position(place.points[k], x);
  }
  return y;
}

// How weights of the coordinates act on the body as a whole.
struct GoalAction {
  bool turns = false;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  // m
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();   // times their sum
};

GoalAction action(const Eigen::VectorXd& a, const Eigen::VectorXd& mass, const Eigen::VectorXd& x) {
  const int d = dimension_of(mass, x);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), place = Eigen::Vector3d::Zero(),
                  moment = Eigen::Vector3d::Zero();
  double size = 0;
  for (Eigen::Index i = 0; i < mass.size(); ++i) {
    const Eigen::Vector3d weight = spatial_point(a, i, d), y = spatial_point(x, i, d);
    sum += weight;
    place += weight.norm() * y;
    moment += y.cross(weight);
    size += weight.norm();
  }
  if (sum.norm() > kNoTranslation * size) return {false, place / size, sum};
  return {true, centre_of_mass(mass, x), moment};
}

}  // namespace

std::vector<ContactForce> contact_forces(const std::vector<PairMemory>& touching,
                                         const std::vector<std::unique_ptr<Body>>& bodies) {
  std::vector<ContactForce> forces;
  for (const PairMemory& memory : touching) {
    const auto [a, b] = std::pair(memory.identity.body_a, memory.identity.body_b);
    const Body &of_a = *bodies[static_cast<std::size_t>(a)], &of_b = *bodies[static_cast<std::size_t>(b)];
    forces.push_back({a, b, position(of_a.model().surface, memory.a, of_a.x()),
                      memory.normal_force * memory.normal, memory.friction_force,
                      position(of_b.model().surface, memory.b, of_b.x()) + memory.offset, memory.slip,
                      memory.distance});
  }
  return forces;
}

void put_contacts(Hdf5Writer& file, const std::string& group, const ContactNames& names,
                  const std::vector<ContactForce>& contacts) {
  if (contacts.empty()) return;
  const auto count = static_cast<Eigen::Index>(contacts.size());
  Eigen::VectorXi first(count), second(count);
  Eigen::VectorXd slip(count), distance(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const ContactForce& contact = contacts[static_cast<std::size_t>(i)];
    first[i] = contact.first;
    second[i] = contact.second;
    slip[i] = contact.slip;
    distance[i] = contact.distance;
  }
  file.put(group + "/" + names.first, first);
  file.put(group + "/" + names.second, second);
  file.put(group + "/slip", slip);
  file.put(group + "/distance", distance);
  const auto put = [&](const std::string& name, Eigen::Vector3d ContactForce::*field) {
    RowMatrixXd rows(count, 3);
    for (Eigen::Index i = 0; i < count; ++i)
      rows.row(i) = (contacts[static_cast<std::size_t>(i)].*field).transpose();
    file.put(group + "/" + name, rows);
  };
  put("position", &ContactForce::position);
  put("normal_force", &ContactForce::normal_force);
  put("friction_force", &ContactForce::friction_force);
  put("anchor", &ContactForce::anchor);
}

void put_goals(Hdf5Writer& file, const std::string& group, const std::vector<Goal>& goals,
               const Eigen::VectorXd& mass, const Eigen::VectorXd& x, const Eigen::VectorXd& v) {
  if (goals.empty()) return;
  const auto count = static_cast<Eigen::Index>(goals.size());
  Eigen::VectorXi turns(count);
  RowMatrixXd place(count, 3), axis(count, 3);
  Eigen::VectorXd value(count), rate(count), value_target(count), rate_target(count), value_weight(count),
      rate_weight(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Goal& goal = goals[static_cast<std::size_t>(i)];
    const GoalAction acts = action(goal.a, mass, x);
    const double size = acts.axis.norm(), unit = size > 0 ? 1 / size : 0;
    turns[i] = acts.turns ? 1 : 0;
    place.row(i) = acts.place.transpose();
    axis.row(i) = unit * acts.axis.transpose();
    value[i] = unit * goal.a.dot(x);
    rate[i] = unit * goal.a.dot(v);
    value_target[i] = unit * goal.sx;
    rate_target[i] = unit * goal.sv;
    value_weight[i] = goal.kp;
    rate_weight[i] = goal.kd;
  }
  file.put(group + "/turns", turns);
  file.put(group + "/place", place);
  file.put(group + "/axis", axis);
  file.put(group + "/value", value);
  file.put(group + "/rate", rate);
  file.put(group + "/value_target", value_target);
  file.put(group + "/rate_target", rate_target);
  file.put(group + "/value_weight", value_weight);
  file.put(group + "/rate_weight", rate_weight);
}

}  // namespace vivify::sim

#include "sim/body.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "common/registry.h"
#include "sim/contact/contact_points.h"
#include "sim/control/rigid_motion.h"
#include "sim/settings.h"

namespace vivify::sim {
namespace {

constexpr int kMaxContactPasses = 3;     // solves of one step while contact planes still move
constexpr double kPlaneTolerance = 0.1;  // of the contact layer: how far a plane may be from the true surface
constexpr double kLeastGravity = 1;      // m/s²; the weight is the unit of force even where there is none
constexpr double kRelaxedRest = 0.8;     // a body stuck on a collapsed rest shape relaxes it by this factor

Eigen::VectorXd flatten(const Points& V) { return Eigen::Map<const Eigen::VectorXd>(V.data(), V.size()); }

Points unflatten(const Eigen::VectorXd& x) { return Eigen::Map<const Points>(x.data(), x.size() / 3, 3); }

// The regulariser's own material: the model's, with both stiffnesses scaled.
Value regularizer_material(const Value& model, const Value& regularizer) {
  Value material = model;
  for (const char* key : {"stiffness", "volume_stiffness"}) {
    material.set(key, Value::number(model[key].as_number() * regularizer[key].as_number()));
  }
  return material;
}

}  // namespace

BodyModel make_body_model(const BodyInput& input, const WorldSettings& settings) {
  BodyModel body;
  body.name = input.name;
  body.mesh = input.rest;
  body.mass = lumped_mass(body.mesh, input.model["density"].as_number());
  const Box box = bounding_box(body.mesh.V);
  body.height = box.max.y() - box.min.y();
  body.weight = body.mass.sum() * std::max(settings.gravity.norm(), kLeastGravity);

  body.rest = make_cage_space(body.mesh.V, input.cage_weights);
  body.elastic = build_model(body.mesh, body.rest.layout, input.model);
  const ElasticModel regularizer =
      build_model(body.mesh, body.rest.layout, regularizer_material(input.model, input.regularizer));
  for (std::size_t f = 0; f < body.elastic.size(); ++f) {
    Eigen::VectorXd measures;
    body.elastic[f]->values(Side::rest, body.rest.X0, measures);
    body.S0.push_back(std::move(measures));
    body.regularizer_coefficients.push_back(regularizer[f]->coefficients());
  }
  // ½ ρ |ṗ|² h² with ρ h² independent of h: 0.03 M g / L at h = 0.01 s.
  body.rate_weight =
      input.regularizer["rate"].as_number() * body.weight / body.height * std::pow(0.01 / settings.h, 2);

  body.contact_points = input.contact_points;
  const int standing = std::max(1, count_standing_points(body.contact_points, flatten(body.mesh.V)));
  const double layer = input.contact["layer"].as_number() * body.height;
  body.contact = {layer, body.weight / standing / (layer * layer), 2 * body.weight / standing / layer};

  body.pattern = std::make_unique<SymmetricPattern>(static_cast<int>(body.mesh.V.rows()));
  for (const auto& family : body.elastic) family->reserve(*body.pattern);
  for (int i = 0; i < body.contact_points.size(); ++i) {
    body.pattern->couple(body.contact_points.vertices.row(i).data(), 4);
  }
  body.pattern->finish();
  for (const auto& family : body.elastic) family->bind(*body.pattern);
  for (int i = 0; i < body.contact_points.size(); ++i) {
    body.pattern->append_slots(body.contact_points.vertices.row(i).data(), 4, body.contact_slots);
  }
  for (int i = 0; i < body.dofs(); ++i) body.diagonal_slots.push_back(body.pattern->slot(i, i));
  body.solver = solver_settings(input.solver);
  return body;
}

Body::Body(const BodyInput& input, const WorldSettings& settings)
    : settings_(settings),
      model_(make_body_model(input, settings)),
      workspace_(std::make_unique<StepWorkspace>(*model_.pattern)) {
  x_ = flatten(model_.mesh.V);
  v_ = Eigen::VectorXd::Zero(x_.size());
  q_ = Eigen::VectorXd::Zero(model_.rest.free_parameters());
  contact_memory_.resize(static_cast<std::size_t>(model_.contact_points.size()));
  const ControlledBody controlled{model_.mass, model_.rest.X0, model_.height, -settings.gravity.y(),
                                  settings.h};
  controller_ = make_controller(controlled, input.controller);
}

StepSolution Body::solve(const StepProblem& problem, int* fallback, std::string* method) {
  const Eigen::VectorXd start = guess(settings_.h);
  *method = model_.solver.method;
  StepSolution best =
      find_entry(step_methods(), *method, "step method").solve(problem, q_, start, *workspace_);
  if (best.exact && best.optimal) return best;

  *fallback = std::max(*fallback, 1);
  const StepSolution first = best;
  const std::string other = *method == "sqp" ? "reduced" : "sqp";
  StepSolution second =
      find_entry(step_methods(), other, "step method").solve(problem, q_, start, *workspace_);
  if (second.exact && (!best.exact || second.objective < best.objective)) {
    *method = other;
    best = std::move(second);
    best.iterations += first.iterations;
    best.halvings += first.halvings;
  } else {
    best.iterations += second.iterations;
    best.halvings += second.halvings;
  }
  if (best.exact) return best;

  *fallback = 2;
  *method = "hold";
  for (const double keep : {1.0, kRelaxedRest, kRelaxedRest * kRelaxedRest}) {
    for (const Eigen::VectorXd& x : {start, x_}) {
      StepSolution hold;
      hold.rest = problem.rest_point(keep * q_, true);
      hold.at = problem.deformed_point(x);
      finish_exactly(problem, hold, *workspace_);
      if (hold.exact) return hold;
    }
  }
  return best;
}

StepRecord Body::step(long step, const std::vector<Collider>& colliders) {
  const auto begin = std::chrono::steady_clock::now();
  const double h = settings_.h;
  double load = 0;
  for (const ContactMemory& memory : contact_memory_) load += memory.normal_force;
  const Goals goals = make_goals(controller_->goals({x_, v_, load}), x_, h);

  Eigen::VectorXd x_tilde = guess(h);
  for (Eigen::Index i = 0; i < model_.mass.size(); ++i)
    x_tilde.segment<3>(3 * i) += h * h * settings_.gravity;

  const double fastest = unflatten(v_).rowwise().norm().maxCoeff() + h * settings_.gravity.norm();
  const double reach = model_.contact.layer + 2 * h * fastest + 0.05 * model_.height;
  ContactSet contacts(model_.contact_points, model_.contact, colliders, x_, reach, contact_memory_);
  StepSolution solution;
  int fallback = 0;
  std::string method;
  int iterations = 0, halvings = 0;
  for (int pass = 1;; ++pass) {
    const StepProblem problem(model_, contacts, goals, x_tilde, q_, h);
    solution = solve(problem, &fallback, &method);
    iterations += solution.iterations;
    halvings += solution.halvings;
    if (!solution.exact || pass == kMaxContactPasses ||
        contacts.planes_hold(colliders, solution.at.x, kPlaneTolerance * model_.contact.layer))
      break;
    contacts =
        ContactSet(model_.contact_points, model_.contact, colliders, solution.at.x, reach, contact_memory_);
  }
  if (!solution.exact) {
    throw Error(ErrorKind::numerical,
                "body '" + model_.name + "', step " + std::to_string(step) +
                    ": the equations of motion were not solved (residual " +
                    std::to_string(solution.residual) + " of the weight)",
                "raise frames.steps_per_frame, or make the model stiffer");
  }

  StepRecord record;
  record.step = step;
  record.t = static_cast<double>(step) * h;
  record.body = model_.name;
  record.method = method;
  record.iterations = iterations;
  record.halvings = halvings;
  record.fallback = fallback;
  record.residual_rel = solution.residual;
  record.objective = solution.objective;
  const Eigen::VectorXd p = model_.rest.basis * solution.rest.q;
  record.p_norm = p.norm();
  record.p_rate = (p - this->p()).norm() / h;
  record.phase = controller_->phase();

  v_ = (solution.at.x - x_) / h;
  x_ = solution.at.x;
  q_ = solution.rest.q;
  contacts.update_memory(x_, contact_memory_);

  record.com = centre_of_mass(model_.mass, x_);
  record.vel = centre_of_mass(model_.mass, v_);
  const StepProblem problem(model_, contacts, goals, x_tilde, q_, h);
  const Eigen::VectorXd internal = problem.elastic_gradient(solution.at, solution.rest);
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), torque = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < model_.mass.size(); ++i) {
    const Eigen::Vector3d f = internal.segment<3>(3 * i), arm = x_.segment<3>(3 * i) - record.com;
    force += f;
    torque += arm.cross(f);
    record.kinetic += 0.5 * model_.mass[i] * v_.segment<3>(3 * i).squaredNorm();
  }
  record.internal_force = force.norm();
  record.internal_torque = torque.norm();
  record.elastic = problem.elastic_energy(solution.at, solution.rest);
  record.min_element_ratio = problem.smallest_element(solution.at);
  record.contacts =
      static_cast<int>(std::count_if(contact_memory_.begin(), contact_memory_.end(),
                                     [](const ContactMemory& memory) { return memory.touching; }));
  record.min_clearance = INFINITY;
  for (int i = 0; i < model_.contact_points.size(); ++i) {
    const Eigen::Vector3d y = model_.contact_points.position(i, x_);
    for (const Collider& collider : colliders)
      record.min_clearance = std::min(record.min_clearance, collider.nearest(y).distance);
  }
  record.max_penetration = std::max(0.0, -record.min_clearance);
  const Eigen::Matrix3d R = best_rotation(model_.mass, model_.rest.X0, x_);
  record.tilt_deg = std::acos(std::clamp(R(1, 1), -1.0, 1.0)) * 180 / std::numbers::pi;
  wall_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return record;
}

void Body::save(Hdf5Writer& file, const std::string& group) const {
  file.put(group + "/x", RowMatrixXd(unflatten(x_)));
  file.put(group + "/v", RowMatrixXd(unflatten(v_)));
  file.put(group + "/p", p());
  file.put(group + "/restart/q", q_);
  RowMatrixXd contact(static_cast<Eigen::Index>(contact_memory_.size()), 6);
  for (std::size_t i = 0; i < contact_memory_.size(); ++i) {
    const ContactMemory& memory = contact_memory_[i];
    contact.row(static_cast<Eigen::Index>(i)) << memory.touching, memory.collider, memory.normal_force,
        memory.anchor.transpose();
  }
  file.put(group + "/restart/contact", contact);
  file.put(group + "/restart/controller", controller_->state());
}

void Body::restore(const Hdf5Reader& file, const std::string& group) {
  const RowMatrixXd x = file.matrix(group + "/x"), v = file.matrix(group + "/v");
  const Eigen::VectorXd q = file.vector(group + "/restart/q");
  const RowMatrixXd contact = file.matrix(group + "/restart/contact");
  if (x.size() != x_.size() || v.size() != v_.size() || q.size() != q_.size() ||
      contact.rows() != static_cast<Eigen::Index>(contact_memory_.size())) {
    throw Error(ErrorKind::io, "the saved state of body '" + model_.name + "' is of another mesh",
                "run again with --force=simulate");
  }
  x_ = flatten(x);
  v_ = flatten(v);
  q_ = q;
  for (std::size_t i = 0; i < contact_memory_.size(); ++i) {
    const auto row = contact.row(static_cast<Eigen::Index>(i));
    contact_memory_[i] = {row[0] != 0, row.tail<3>().transpose(), row[2], static_cast<int>(row[1])};
  }
  controller_->restore(file.vector(group + "/restart/controller"));
}

}  // namespace vivify::sim

#include "sim/body.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <sstream>

#include "common/registry.h"
#include "common/text.h"
#include "sim/contact/contact_points.h"
#include "sim/control/rigid_motion.h"
#include "sim/elastic/models/models.h"
#include "sim/settings.h"
#include "sim/solve/static_solve.h"

namespace vivify::sim {
namespace {

constexpr int kMaxContactPasses = 3;     // solves of one step while contact planes still move
constexpr double kPlaneTolerance = 0.1;  // of the contact layer: how far a plane may be from the true surface
constexpr double kLeastGravity = 1;      // m/s²; the weight is the unit of force even where there is none
constexpr double kRelaxedRest = 0.8;     // a body stuck on a collapsed rest shape relaxes it by this factor
constexpr double kStaticTolerance = 1e-9;  // of the weight: force on a vertex that is left in equilibrium
constexpr int kStaticStart = 16;           // increments of the parameters to the first keyframe
constexpr int kMaxStepSplits = 6;          // a step that cannot be solved is cut in halves so many times
constexpr double kSqueezed = 0.1;          // of its size at rest: what a message calls a squeezed element
constexpr double kTimeLimit = 100;  // of the median of the last steps: a step that takes longer is given up
constexpr double kLeastTimeLimit = 10;  // s
constexpr std::size_t kTimedSteps = 50, kFewestTimedSteps = 5;

RowMatrixXd unflatten(const Eigen::VectorXd& x, int d) {
  return Eigen::Map<const RowMatrixXd>(x.data(), x.size() / d, d);
}
Eigen::VectorXd flatten(const RowMatrixXd& V) {
  return Eigen::Map<const Eigen::VectorXd>(V.data(), V.size());
}

// Share of the model's stiffness that the regulariser takes for a measure.
double regularizer_share(const MeasureFamily& family, const Value& regularizer) {
  switch (family.kind()) {
    case MeasureKind::size:
      return regularizer["volume_stiffness"].as_number();
    case MeasureKind::angle:
      return regularizer["bending_stiffness"].as_number();
    default:
      return regularizer["stiffness"].as_number();
  }
}

// Throws Error(geometry) unless every element is of vertices with finite coordinates and every vertex of an
// element.
void check_mesh(const std::string& body, const SimMesh& mesh) {
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorKind::geometry, "body '" + body + "': " + what, "mesh the character again");
  };
  if (mesh.V.rows() == 0 || mesh.E.rows() == 0) fail("the simulation mesh has no elements");
  std::vector<bool> used(static_cast<std::size_t>(mesh.V.rows()), false);
  for (Eigen::Index e = 0; e < mesh.E.rows(); ++e) {
    for (const int v : mesh.E.row(e)) {
      if (v < 0 || v >= mesh.V.rows()) {
        fail("element " + std::to_string(e) + " of the simulation mesh has vertex " + std::to_string(v) +
             " of " + std::to_string(mesh.V.rows()));
      }
      used[static_cast<std::size_t>(v)] = true;
    }
  }
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
    const std::string vertex = "vertex " + std::to_string(v) + " of the simulation mesh";
    if (!mesh.V.row(v).allFinite()) fail(vertex + " has coordinates that are not finite");
    if (!used[static_cast<std::size_t>(v)]) fail(vertex + " belongs to no element: it has no mass");
  }
}

}  // namespace

BodyModel make_body_model(const BodyInput& input, const WorldSettings& settings) {
  return make_body_model(input, settings, model_entry(input.model), rest_space_entry(input.rest_space));
}

BodyModel make_body_model(const BodyInput& input, const WorldSettings& settings, const ModelEntry& model,
                          const RestSpaceEntry& space) {
  BodyModel body;
  body.name = input.name;
  body.mesh = input.rest;
  check_mesh(body.name, body.mesh);
  const int d = body.dimension();
  const RowMatrixXd& V = body.mesh.V;
  ElasticModel elastic = build_model(model, body.mesh, space.layout, input.model);
  body.elastic = std::move(elastic.families);
  body.mass = std::move(elastic.mass);
  body.damping = input.model["damping_s"].as_number();
  body.height = unit_length(V);
  body.weight = body.mass.sum() * std::max(settings.gravity.norm(), kLeastGravity);

  body.rest = space.make({body.mesh, body.elastic, elastic.rest, input.cage_weights, input.examples});
  body.rest->measures(body.elastic, Eigen::VectorXd::Zero(body.rest->free_parameters()), body.S0, nullptr);
  for (const auto& family : body.elastic) {
    body.regularizer_coefficients.push_back(regularizer_share(*family, input.regularizer) *
                                            per_value(family->coefficients(), family->components()));
  }
  // ½ ρ |ṗ|² h² with ρ h² independent of h: 0.03 M g L per squared unit of p at h = 0.01 s.
  const double unit2 = body.rest->unit() * body.rest->unit();
  body.rate_weight = input.regularizer["rate"].as_number() * body.weight * body.height / unit2 *
                     std::pow(0.01 / settings.h, 2);
  body.hull = {body.rest->groups(), input.regularizer["hull"].as_number() * body.weight * body.height};

  body.contact_points = input.contact_points;
  const int standing = std::max(1, count_standing_points(body.contact_points, flatten(V)));
  const double layer = input.contact["layer"].as_number() * body.height;
  body.contact = {layer, body.weight / standing / (layer * layer), 2 * body.weight / standing / layer};

  body.pattern = std::make_unique<SymmetricPattern>(static_cast<int>(V.rows()), d);
  for (const auto& family : body.elastic) family->reserve(*body.pattern);
  for (int i = 0; i < V.rows(); ++i) body.pattern->couple(&i, 1);
  const int corners = body.contact_points.corners();
  for (int i = 0; i < body.contact_points.size(); ++i) {
    body.pattern->couple(body.contact_points.vertices.row(i).data(), corners);
  }
  body.pattern->finish();
  for (const auto& family : body.elastic) family->bind(*body.pattern);
  for (int i = 0; i < body.contact_points.size(); ++i) {
    body.pattern->append_slots(body.contact_points.vertices.row(i).data(), corners, body.contact_slots);
  }
  for (int i = 0; i < body.dofs(); ++i) body.diagonal_slots.push_back(body.pattern->slot(i, i));
  body.solver = solver_settings(input.solver);
  return body;
}

Body::Body(const BodyInput& input, const WorldSettings& settings)
    : settings_(settings),
      model_(make_body_model(input, settings)),
      rest_(flatten(model_.mesh.V)),
      workspace_(std::make_unique<StepWorkspace>(*model_.pattern)) {
  x_ = rest_;
  v_ = Eigen::VectorXd::Zero(x_.size());
  q_ = Eigen::VectorXd::Zero(model_.rest->free_parameters());
  contact_memory_.resize(static_cast<std::size_t>(model_.contact_points.size()));
  const ControlledBody controlled{model_.mass, rest_, model_.height, -settings.gravity.y(), settings.h};
  controller_ = make_controller(controlled, input.controller);
  const auto keyed = controller_->rest_parameters(0);
  if (keyed && keyed->size() != model_.rest->parameters()) {
    throw Error(ErrorKind::usage,
                "body '" + model_.name + "': the controller gives " + std::to_string(keyed->size()) +
                    " weights and the rest space has " + std::to_string(model_.rest->parameters()),
                "give one weight per example", input.controller.where());
  }
  if (!keyed || !settings.statics) return;
  const Eigen::VectorXd q = model_.rest->basis().transpose() * *keyed;
  StepRecord record;
  for (int part = 1; part <= kStaticStart; ++part) {
    if (settle(static_cast<double>(part) / kStaticStart * q, record)) continue;
    throw Error(
        ErrorKind::numerical,
        "body '" + model_.name + "': no equilibrium was found for the rest shape of its first keyframe",
        "begin with weights nearer to 0");
  }
}

StepSolution Body::solve(const StepProblem& problem, const Eigen::VectorXd& start, StepRecord& record) {
  const auto attempt = [&](const std::string& method) {
    StepSolution solution =
        find_entry(step_methods(), method, "step method").solve(problem, q_, start, *workspace_);
    record.iterations += solution.iterations;
    record.halvings += solution.halvings;
    record.guards += solution.guards;
    return solution;
  };
  record.method = model_.solver.method;
  StepSolution best = attempt(record.method);
  if (best.exact && best.optimal) return best;

  record.fallback = std::max(record.fallback, 1);
  const std::string other = record.method == "sqp" ? "reduced" : "sqp";
  StepSolution second = attempt(other);
  if (second.exact && (!best.exact || second.objective < best.objective)) {
    record.method = other;
    best = std::move(second);
  }
  if (best.exact) return best;

  record.fallback = 2;
  record.method = "hold";
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

bool Body::settle(const Eigen::VectorXd& q, StepRecord& record) {
  std::vector<Eigen::VectorXd> S;
  model_.rest->measures(model_.elastic, q, S, nullptr);
  const Eigen::Index n = model_.mass.size();
  const StaticProblem problem = {model_.elastic, *model_.pattern, S, Eigen::VectorXd::Zero(x_.size()),
                                 std::vector<bool>(static_cast<std::size_t>(n), false)};
  StaticSolution solution = solve_static(problem, x_, kStaticTolerance * model_.weight);
  record.method = "static";
  record.iterations += solution.iterations;
  record.residual_rel = std::max(record.residual_rel, solution.residual / model_.weight);
  if (!solution.converged) {
    stuck_ = std::move(solution.x);
    return false;
  }

  const int d = model_.dimension();
  const Eigen::Matrix3d R = best_rotation(model_.mass, solution.x, x_);
  const Eigen::Vector3d from = centre_of_mass(model_.mass, solution.x), to = centre_of_mass(model_.mass, x_);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector3d y = to + R * (spatial_point(solution.x, i, d) - from);
    for (int k = 0; k < d; ++k) x_[d * i + k] = y[k];
  }
  record.p_rate = std::max(record.p_rate, (model_.rest->basis() * (q - q_)).norm() / settings_.h);
  q_ = q;
  const ContactSet no_contacts;
  const Goals no_goals;
  const StepProblem at_rest(model_, no_contacts, no_goals, x_, x_, q_, settings_.h);
  StepSolution state;
  state.at = at_rest.deformed_point(x_);
  state.rest = at_rest.rest_point(q_, false);
  state.objective = state.rest.regularizer;
  measure(at_rest, state, record);
  return true;
}

bool Body::advance(double h, const std::vector<Goal>& goals, const std::optional<Eigen::VectorXd>& keyed,
                   const std::vector<Collider>& colliders, StepRecord& record) {
  const int d = model_.dimension();
  const Goals wanted = make_goals(goals, x_, h);
  const Eigen::VectorXd start = x_ + h * v_;
  Eigen::VectorXd x_tilde = start;
  for (Eigen::Index i = 0; i < model_.mass.size(); ++i)
    x_tilde.segment(d * i, d) += h * h * settings_.gravity.head(d);

  const double fastest = unflatten(v_, d).rowwise().norm().maxCoeff() + h * settings_.gravity.norm();
  const double reach = model_.contact.layer + 2 * h * fastest + 0.05 * model_.height;
  ContactSet contacts(model_.contact_points, model_.contact, colliders, x_, reach, contact_memory_);
  StepSolution solution;
  for (int pass = 1;; ++pass) {
    const StepProblem problem(model_, contacts, wanted, x_, x_tilde, q_, h);
    if (keyed) {
      record.method = "keyed";
      solution = {};
      solution.rest = problem.rest_point(*keyed, false);
      solution.at = problem.deformed_point(start);
      finish_exactly(problem, solution, *workspace_);
    } else {
      solution = solve(problem, start, record);
    }
    if (!solution.exact || pass == kMaxContactPasses ||
        contacts.planes_hold(colliders, solution.at.x, kPlaneTolerance * model_.contact.layer))
      break;
    contacts =
        ContactSet(model_.contact_points, model_.contact, colliders, solution.at.x, reach, contact_memory_);
  }
  record.residual_rel = std::max(record.residual_rel, solution.residual);
  if (!solution.exact) {
    stuck_ = std::move(solution.at.x);
    return false;
  }

  const Eigen::VectorXd x_n = x_;
  record.p_rate = std::max(record.p_rate, (model_.rest->basis() * (solution.rest.q - q_)).norm() / h);
  v_ = (solution.at.x - x_) / h;
  x_ = solution.at.x;
  contacts.update_memory(x_, contact_memory_);
  measure(StepProblem(model_, contacts, wanted, x_n, x_tilde, q_, h), solution, record);
  q_ = solution.rest.q;
  return true;
}

StepRecord Body::step(long step, const std::vector<Collider>& colliders) {
  const auto begin = std::chrono::steady_clock::now();
  const double processor_begin = processor_seconds();
  double load = 0;
  for (const ContactMemory& memory : contact_memory_) load += memory.normal_force;
  const std::vector<Goal> goals = controller_->goals({x_, v_, load});
  std::optional<Eigen::VectorXd> target;  // of q
  if (const auto p = controller_->rest_parameters(static_cast<double>(step) * settings_.h)) {
    target = model_.rest->basis().transpose() * *p;
  }

  const State before{x_, v_, q_, contact_memory_};
  workspace_->deadline = step_deadline();
  StepRecord record;
  bool solved = false;
  for (int splits = 0; splits <= kMaxStepSplits && !solved && !workspace_->expired(); ++splits) {
    record.residual_rel = record.p_rate = 0;
    record.substeps = 1 << splits;
    solved = true;
    for (int part = 0; part < record.substeps && solved; ++part) {
      const double share = (part + 1.0) / record.substeps;
      std::optional<Eigen::VectorXd> keyed;
      if (target) keyed = (1 - share) * before.q + share * *target;
      solved = settings_.statics ? settle(keyed.value_or(q_), record)
                                 : advance(settings_.h / record.substeps, goals, keyed, colliders, record);
    }
    if (solved) break;
    x_ = before.x;
    v_ = before.v;
    q_ = before.q;
    contact_memory_ = before.contacts;
  }
  // Also of a step that was solved: methods that ran out of time stop early, and results must not depend on
  // the clock.
  if (workspace_->expired()) {
    throw Error(ErrorKind::numerical,
                "body '" + model_.name + "', step " + std::to_string(step) + ": not solved in " +
                    number_text(kTimeLimit) + " times the time of the steps before",
                "raise frames.steps_per_frame, ask for slower motion, or make the model stiffer");
  }
  if (!solved) {
    throw Error(ErrorKind::numerical,
                "body '" + model_.name + "', step " + std::to_string(step) +
                    ": the equations of motion were not solved (residual " +
                    number_text(record.residual_rel) + " of the weight, in steps down to a " +
                    std::to_string(1 << kMaxStepSplits) + "th" + squeezed_element() + ")",
                "raise frames.steps_per_frame, ask for slower motion, or make the model stiffer");
  }

  record.step = step;
  record.t = static_cast<double>(step) * settings_.h;
  record.body = model_.name;
  record.phase = controller_->phase();
  record.p_norm = p().norm();
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
  const Eigen::Matrix3d R = best_rotation(model_.mass, rest_, x_);
  record.tilt_deg = std::acos(std::clamp(R(1, 1), -1.0, 1.0)) * 180 / std::numbers::pi;
  note_step_time(processor_seconds() - processor_begin);
  wall_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return record;
}

std::string Body::squeezed_element() const {
  SimMesh mesh = model_.mesh;
  const Eigen::VectorXd sizes = element_sizes(mesh);
  mesh.V = unflatten(stuck_, model_.dimension());
  Eigen::Index e = 0;
  const double ratio = element_sizes(mesh).cwiseQuotient(sizes).minCoeff(&e);
  if (!(ratio < kSqueezed)) return {};
  std::ostringstream text;
  text.precision(2);
  text << ", with " << element_name(mesh, e);
  if (ratio < 0) {
    text << " turned inside out";
  } else {
    text << " squeezed to " << 100 * ratio << " % of its size at rest";
  }
  return text.str();
}

// None until enough steps tell how long one takes.
double Body::step_deadline() const {
  if (step_seconds_.size() < kFewestTimedSteps) return INFINITY;
  std::vector<double> sorted = step_seconds_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return processor_seconds() + std::max(kTimeLimit * *middle, kLeastTimeLimit);
}

void Body::note_step_time(double seconds) {
  if (step_seconds_.size() == kTimedSteps) step_seconds_.erase(step_seconds_.begin());
  step_seconds_.push_back(seconds);
}

void Body::measure(const StepProblem& problem, const StepSolution& solution, StepRecord& record) const {
  const int d = model_.dimension();
  record.objective = solution.objective;
  record.com = centre_of_mass(model_.mass, x_);
  record.vel = centre_of_mass(model_.mass, v_);
  const Eigen::VectorXd internal = problem.internal_gradient(solution.at, solution.rest);
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), torque = Eigen::Vector3d::Zero();
  record.kinetic = 0;
  for (Eigen::Index i = 0; i < model_.mass.size(); ++i) {
    const Eigen::Vector3d f = spatial_point(internal, i, d), arm = spatial_point(x_, i, d) - record.com;
    force += f;
    torque += arm.cross(f);
    record.kinetic += 0.5 * model_.mass[i] * v_.segment(d * i, d).squaredNorm();
  }
  record.internal_force = force.norm();
  record.internal_torque = torque.norm();
  record.elastic = problem.elastic_energy(solution.at, solution.rest);
  record.min_element_ratio = problem.smallest_element(solution.at);
}

void Body::save(Hdf5Writer& file, const std::string& group) const {
  file.put(group + "/x", unflatten(x_, model_.dimension()));
  file.put(group + "/v", unflatten(v_, model_.dimension()));
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

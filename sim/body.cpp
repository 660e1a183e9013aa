#include "sim/body.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "common/registry.h"
#include "common/text.h"
#include "sim/contact/contact_points.h"
#include "sim/control/behavior.h"
#include "sim/control/rigid_motion.h"
#include "sim/elastic/models/models.h"
#include "sim/frame_report.h"
#include "sim/settings.h"
#include "sim/solve/static_solve.h"

namespace vivify::sim {
namespace {

constexpr double kLeastGravity = 1;        // m/s²; the weight is the unit of force even where there is none
constexpr double kStaticTolerance = 1e-9;  // of the weight: force on a vertex that is left in equilibrium
constexpr int kStaticStart = 16;           // increments of the parameters to the first keyframe
constexpr double kSqueezed = 0.1;          // of its size at rest: what a message calls a squeezed element

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

// The boundary of a solid, or the whole of a shell or rod with its thickness (twice the contact layer for
// models that have none).
ContactSurface default_surface(const BodyInput& input, double layer) {
  const bool solid = input.rest.element_points() == input.rest.dimension() + 1;
  const double radius = input.model.has("thickness") ? 0.5 * input.model["thickness"].as_number() : layer;
  return boundary_of(input.rest, solid ? 0 : radius);
}

// Normal forces of the colliders shared out to the vertices, N.
Eigen::VectorXd vertex_loads(const ContactPoints& points, const std::vector<ContactMemory>& memory,
                             Eigen::Index vertices) {
  Eigen::VectorXd loads = Eigen::VectorXd::Zero(vertices);
  for (int i = 0; i < points.size(); ++i) {
    const ContactMemory& contact = memory[static_cast<std::size_t>(i)];
    if (!contact.touching) continue;
    for (int k = 0; k < points.corners(); ++k)
      loads[points.vertices(i, k)] += points.weights(i, k) * contact.normal_force;
  }
  return loads;
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
  body.where = input.where;
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
  body.contact = {layer,
                  body.weight / standing / (layer * layer),
                  2 * body.weight / standing / layer,
                  input.contact["friction"].as_number(),
                  input.contact["self"].as_bool(),
                  input.friction_with};

  body.surface = input.surface ? *input.surface : default_surface(input, layer);

  body.pattern = std::make_unique<SymmetricPattern>(static_cast<int>(V.rows()), d);
  body.reserve(*body.pattern, 0);
  body.pattern->finish();
  body.bind(*body.pattern, 0);
  body.solver = solver_settings(input.solver);
  return body;
}

void BodyModel::reserve(SymmetricPattern& shared, int first_vertex) const {
  for (const auto& family : elastic) family->reserve(shared, first_vertex);
  for (int i = 0; i < mesh.V.rows(); ++i) shared.couple(&i, 1, first_vertex);
  for (int i = 0; i < contact_points.size(); ++i) {
    shared.couple(contact_points.vertices.row(i).data(), contact_points.corners(), first_vertex);
  }
}

void BodyModel::bind(const SymmetricPattern& shared, int first_vertex) {
  for (const auto& family : elastic) family->bind(shared, first_vertex);
  contact_slots.clear();
  for (int i = 0; i < contact_points.size(); ++i) {
    shared.append_slots(contact_points.vertices.row(i).data(), contact_points.corners(), contact_slots,
                        first_vertex);
  }
  diagonal_slots.clear();
  const int first = dimension() * first_vertex;
  for (int i = 0; i < dofs(); ++i) diagonal_slots.push_back(shared.slot(first + i, first + i));
  bound_to = &shared;
}

Body::Body(const BodyInput& input, const WorldSettings& settings)
    : settings_(settings),
      model_(make_body_model(input, settings)),
      rest_(flatten(model_.mesh.V)),
      pushes_(input.pushes) {
  state_ = {rest_, Eigen::VectorXd::Zero(rest_.size()), Eigen::VectorXd::Zero(model_.rest->free_parameters()),
            std::vector<ContactMemory>(static_cast<std::size_t>(model_.contact_points.size()))};
  surface_ = std::make_unique<SurfaceState>(model_.surface);
  spawn_step_ = std::lround(std::ceil(input.spawn / settings.h - kTimeTolerance));
  handles_ = Handles(input.handles, model_.mesh.V, model_.weight / model_.height);
  const int d = model_.dimension();
  for (Eigen::Index i = 0; i < model_.mass.size(); ++i) state_.v.segment(d * i, d) = input.velocity.head(d);
  for (const ExamplePose& example : input.examples) examples_.push_back(example.name);
  const ControlledBody controlled{model_.mass, rest_,     model_.height,       -settings.gravity.y(),
                                  settings.h,  examples_, model_.rest->poses()};
  controller_ = input.behavior.items().empty() ? make_controller(controlled, input.controller)
                                               : make_script(controlled, input.behavior);
  const auto keyed = controller_->rest_parameters(0);
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

bool Body::settle(const Eigen::VectorXd& q, StepRecord& record) {
  std::vector<Eigen::VectorXd> S;
  model_.rest->measures(model_.elastic, q, S, nullptr);
  const Eigen::Index n = model_.mass.size();
  const StaticProblem problem = {model_.elastic, *model_.pattern, S, Eigen::VectorXd::Zero(state_.x.size()),
                                 std::vector<bool>(static_cast<std::size_t>(n), false)};
  StaticSolution solution = solve_static(problem, state_.x, kStaticTolerance * model_.weight);
  record.method = "static";
  record.iterations += solution.iterations;
  record.residual_rel = std::max(record.residual_rel, solution.residual / model_.weight);
  if (!solution.converged) {
    note_failure(std::move(solution.x));
    return false;
  }

  const int d = model_.dimension();
  const Eigen::Matrix3d R = best_rotation(model_.mass, solution.x, state_.x);
  const Eigen::Vector3d from = centre_of_mass(model_.mass, solution.x),
                        to = centre_of_mass(model_.mass, state_.x);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector3d y = to + R * (spatial_point(solution.x, i, d) - from);
    for (int k = 0; k < d; ++k) state_.x[d * i + k] = y[k];
  }
  measure_rest_motion(q, settings_.h, record);
  state_.q = q;
  const ContactSet no_contacts;
  const Goals no_goals;
  const StepProblem at_rest(model_, no_contacts, no_goals, state_.x, state_.x, state_.q, settings_.h);
  const RestPoint rest = at_rest.rest_point(state_.q, false);
  record.objective = rest.regularizer;
  measure(at_rest, 0, at_rest.deformed_point(state_.x), rest, record);
  return true;
}

OtherBody Body::seen() const {
  return {model_.name, centre_of_mass(model_.mass, state_.x), controller_->arrived()};
}

Body::Wish Body::wish(long step, const Ground& ground, Others others) {
  Wish wish;
  const Eigen::VectorXd loads = vertex_loads(model_.contact_points, state_.contacts, model_.mass.size());
  wish.goals = controller_->goals({state_.x, state_.v, ground.load, ground.velocity, others, loads, p()});
  if (const auto p = controller_->rest_parameters(static_cast<double>(step) * settings_.h)) {
    wish.q = model_.rest->basis().transpose() * *p;
  } else if (controller_->passive()) {
    wish.q = state_.q;
  }
  goals_ = wish.q ? std::vector<Goal>() : wish.goals;
  return wish;
}

double Body::travel(double h) const {
  return h *
         (unflatten(state_.v, model_.dimension()).rowwise().norm().maxCoeff() + h * settings_.gravity.norm());
}

std::string Body::squeezed_element() const {
  if (stuck_.size() == 0) return {};
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

void Body::finish_record(long step, const std::vector<Collider>& colliders, StepRecord& record) const {
  record.step = step;
  record.t = static_cast<double>(step) * settings_.h;
  record.body = model_.name;
  record.phase = controller_->phase();
  record.behavior = controller_->behavior();
  record.p_norm = p().norm();
  record.contacts +=
      static_cast<int>(std::count_if(state_.contacts.begin(), state_.contacts.end(),
                                     [](const ContactMemory& memory) { return memory.touching; }));
  record.min_clearance = INFINITY;
  for (const Collider& collider : colliders) {
    const Eigen::Isometry3d pose = collider.pose(record.t);
    for (int i = 0; i < model_.contact_points.size(); ++i) {
      const Eigen::Vector3d y = model_.contact_points.position(i, state_.x);
      record.min_clearance = std::min(record.min_clearance, collider.nearest(y, pose).distance);
    }
  }
  record.max_penetration = std::max(record.max_penetration, -record.min_clearance);
  const Eigen::Matrix3d R = best_rotation(model_.mass, rest_, state_.x);
  record.tilt_deg = std::acos(std::clamp(R(1, 1), -1.0, 1.0)) * 180 / std::numbers::pi;
}

void Body::measure_rest_motion(const Eigen::VectorXd& q, double h, StepRecord& record) const {
  const Eigen::VectorXd dq = q - state_.q, motion = model_.rest->motion(dq);
  record.p_rate = std::max(record.p_rate, (model_.rest->basis() * dq).norm() / h);
  if (motion.size() == 0) return;
  const double points = static_cast<double>(motion.size()) / model_.dimension();
  record.rest_rate = std::max(record.rest_rate, motion.norm() / std::sqrt(points) / model_.height / h);
}

void Body::measure(const StepProblem& problem, std::size_t b, const DeformedPoint& at, const RestPoint& rest,
                   StepRecord& record) const {
  const int d = model_.dimension();
  record.com = centre_of_mass(model_.mass, state_.x);
  record.vel = centre_of_mass(model_.mass, state_.v);
  const Eigen::VectorXd internal = problem.internal_gradient(b, at, rest);
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), torque = Eigen::Vector3d::Zero();
  record.kinetic = 0;
  for (Eigen::Index i = 0; i < model_.mass.size(); ++i) {
    const Eigen::Vector3d f = spatial_point(internal, i, d), arm = spatial_point(state_.x, i, d) - record.com;
    force += f;
    torque += arm.cross(f);
    record.kinetic += 0.5 * model_.mass[i] * state_.v.segment(d * i, d).squaredNorm();
  }
  record.internal_force = force.norm();
  record.internal_torque = torque.norm();
  record.handle_force = problem.handle_force(b, at);
  record.elastic = problem.elastic_energy(b, at, rest);
  record.min_element_ratio = problem.smallest_element(b, at);
  record.min_rest_element_ratio = problem.smallest_rest_element(b, rest);
  record.rest_volume_ratio = problem.rest_volume(b, rest);
}

void Body::save(Hdf5Writer& file, const std::string& group) const {
  file.put(group + "/x", unflatten(state_.x, model_.dimension()));
  file.put(group + "/v", unflatten(state_.v, model_.dimension()));
  file.put(group + "/p", p());
  file.put(group + "/restart/q", state_.q);
  RowMatrixXd contact(static_cast<Eigen::Index>(state_.contacts.size()), 6);
  for (std::size_t i = 0; i < state_.contacts.size(); ++i) {
    const ContactMemory& memory = state_.contacts[i];
    contact.row(static_cast<Eigen::Index>(i)) << memory.touching, memory.collider, memory.normal_force,
        memory.anchor.transpose();
  }
  file.put(group + "/restart/contact", contact);
  file.put(group + "/restart/controller", controller_->state());
  put_contacts(file, group + "/contacts", {"point", "collider"}, contact_forces_);
  put_goals(file, group + "/goals", goals_, model_.mass, state_.x, state_.v);
}

void Body::restore(const Hdf5Reader& file, const std::string& group) {
  const RowMatrixXd x = file.matrix(group + "/x"), v = file.matrix(group + "/v");
  const Eigen::VectorXd q = file.vector(group + "/restart/q");
  const RowMatrixXd contact = file.matrix(group + "/restart/contact");
  if (x.size() != state_.x.size() || v.size() != state_.v.size() || q.size() != state_.q.size() ||
      contact.rows() != static_cast<Eigen::Index>(state_.contacts.size())) {
    throw Error(ErrorKind::io, "the saved state of body '" + model_.name + "' is of another mesh",
                "run again with --force=simulate");
  }
  state_.x = flatten(x);
  state_.v = flatten(v);
  state_.q = q;
  for (std::size_t i = 0; i < state_.contacts.size(); ++i) {
    const auto row = contact.row(static_cast<Eigen::Index>(i));
    state_.contacts[i] = {row[0] != 0, row.tail<3>().transpose(), row[2], static_cast<int>(row[1])};
  }
  controller_->restore(file.vector(group + "/restart/controller"));
}

}  // namespace vivify::sim

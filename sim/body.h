// One controlled (or passive) deformable body: its model, its state and its controller. Islands
// (sim/island.h) move it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/hdf5_file.h"
#include "sim/body_model.h"
#include "sim/contact/surface_pairs.h"
#include "sim/control/controller.h"
#include "sim/handles.h"
#include "sim/push.h"
#include "sim/solve/step_problem.h"
#include "sim/step_record.h"

namespace vivify::sim {

// What a body is made from. The settings are resolved with the schemas of sim/settings.h.
struct BodyInput {
  std::string name;
  SimMesh rest;                       // placed in the scene
  std::string rest_space = "cage";    // a name of sim/rest/rest_space.h
  Eigen::MatrixXd cage_weights;       // #V by #C: harmonic coordinates of the rest vertices (cage)
  std::vector<ExamplePose> examples;  // placed in the scene (cage, examples, strains)
  ContactPoints contact_points;       // that touch colliders
  Value model, regularizer, contact, controller, solver;
  Value behavior = Value::list({});  // in place of the controller when it has items
  std::optional<ContactSurface> surface =
      {};  // that touches other bodies; the boundary of the mesh when empty
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // at the start, m/s
  // Coulomb's μ with bodies and colliders by name, where it is not the product of both factors.
  FrictionByName friction_with = {};
  Location where = {};  // of its position in the scene file, for messages
  std::vector<Handle> handles = {};
  std::vector<Push> pushes = {};
  double spawn = 0;  // when it appears in the world, s
};

struct WorldSettings {
  Eigen::Vector3d gravity = {0, -9.81, 0};  // m/s²
  double h = 1.0 / 48;                      // s
  bool statics = false;  // every step is the equilibrium of its rest shape: no motion, gravity or contact
};

// Throws Error(geometry) or Error(usage) when the input cannot be simulated. The second form takes the model
// and the rest space themselves instead of looking up their names.
BodyModel make_body_model(const BodyInput& input, const WorldSettings& settings);
BodyModel make_body_model(const BodyInput& input, const WorldSettings& settings, const ModelEntry& model,
                          const RestSpaceEntry& space);

class Body {
 public:
  // Throws Error(geometry) or Error(usage) when the input cannot be simulated.
  Body(const BodyInput& input, const WorldSettings& settings);
  Body(Body&&) = delete;

  struct State {
    Eigen::VectorXd x, v;                 // d #V, m and m/s
    Eigen::VectorXd q;                    // free rest parameters
    std::vector<ContactMemory> contacts;  // with colliders, per contact point
  };

  BodyModel& model() { return model_; }
  const BodyModel& model() const { return model_; }
  State& state() { return state_; }
  const State& state() const { return state_; }
  const Eigen::VectorXd& x() const { return state_.x; }
  const Eigen::VectorXd& v() const { return state_.v; }
  Eigen::VectorXd p() const { return model_.rest->basis() * state_.q; }
  const Controller& controller() const { return *controller_; }
  const SurfaceState& surface() const { return *surface_; }
  const Handles& handles() const { return handles_; }
  // What its pushes add to its velocity between two times, m/s.
  Eigen::Vector3d pushed(double from, double to) const {
    return impulse_between(pushes_, from, to) / model_.mass.sum();
  }
  long spawn_step() const { return spawn_step_; }        // steps of the world before it appears
  double wall_seconds() const { return wall_seconds_; }  // of its steps in this process
  void add_wall_seconds(double seconds) { wall_seconds_ += seconds; }

  // What the body wants in a step; `step` counts from 1. Advances the controller's clock. `ground`: what it
  // stands on, bodies too. `others`: all bodies that are present.
  struct Wish {
    std::vector<Goal> goals;
    std::optional<Eigen::VectorXd> q;  // rest parameters that are given instead of sought
  };
  Wish wish(long step, const Ground& ground, Others others);

  // As controllers of other bodies see it.
  OtherBody seen() const;

  // Moves the surface that touches other bodies to x.
  void move_surface(const Eigen::VectorXd& x) { surface_->move_to(x); }
  // How far a part of the body may get in a step of size h if nothing accelerates it but gravity, m.
  double travel(double h) const;

  // To the equilibrium of the rest shape at q, turned and moved as little as can be; false when none was
  // found.
  bool settle(const Eigen::VectorXd& q, StepRecord& record);
  // Remembers what the colliders did to the body in the step, for save().
  void note_contacts(std::vector<ContactForce> forces) { contact_forces_ = std::move(forces); }
  // Remembers x where a solve failed; ", with triangle 17 squeezed to 0.1 % of its size at rest" there, or
  // empty when no element was.
  void note_failure(Eigen::VectorXd x) { stuck_ = std::move(x); }
  std::string squeezed_element() const;
  // Writes down how fast the rest shape gets from its present parameters to q in a time of h.
  void measure_rest_motion(const Eigen::VectorXd& q, double h, StepRecord& record) const;
  // Writes down the motion and the elastic state at the end of a step of the problem's body `b`.
  void measure(const StepProblem& problem, std::size_t b, const DeformedPoint& at, const RestPoint& rest,
               StepRecord& record) const;
  // Writes down the rest of the step.
  void finish_record(long step, const std::vector<Collider>& colliders, StepRecord& record) const;

  // State under `group`, enough for an exact restart, and what sim/frame_report.h tells of the last step.
  void save(Hdf5Writer& file, const std::string& group) const;
  void restore(const Hdf5Reader& file, const std::string& group);

 private:
  WorldSettings settings_;
  BodyModel model_;
  Eigen::VectorXd rest_;               // d #V, the shape as placed in the scene
  std::vector<std::string> examples_;  // names
  std::unique_ptr<Controller> controller_;
  std::unique_ptr<SurfaceState> surface_;
  Handles handles_;
  std::vector<Push> pushes_;
  State state_;
  long spawn_step_;
  std::vector<Goal> goals_;                   // of the last step
  std::vector<ContactForce> contact_forces_;  // at its end
  Eigen::VectorXd stuck_;                     // x of the last solve that failed
  double wall_seconds_ = 0;
};

}  // namespace vivify::sim

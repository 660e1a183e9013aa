// One controlled (or passive) deformable body: its model, its state, its controller, and the step that moves
// it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/hdf5_file.h"
#include "sim/body_model.h"
#include "sim/control/controller.h"
#include "sim/solve/step_method.h"
#include "sim/step_record.h"

namespace vivify::sim {

// What a body is made from. The settings are resolved with the schemas of sim/settings.h.
struct BodyInput {
  std::string name;
  SimMesh rest;                       // placed in the scene
  std::string rest_space = "cage";    // a name of sim/rest/rest_space.h
  Eigen::MatrixXd cage_weights;       // #V by #C: harmonic coordinates of the rest vertices (cage)
  std::vector<ExamplePose> examples;  // placed in the scene (examples, strains)
  ContactPoints contact_points;
  Value model, regularizer, contact, controller, solver;
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

  const BodyModel& model() const { return model_; }
  const Eigen::VectorXd& x() const { return x_; }  // d #V, m
  const Eigen::VectorXd& v() const { return v_; }  // d #V, m/s
  Eigen::VectorXd p() const { return model_.rest->basis() * q_; }
  const Controller& controller() const { return *controller_; }
  double wall_seconds() const { return wall_seconds_; }  // spent in step() by this process

  // One implicit Euler step; `step` counts from 1. Throws Error(numerical) when no exact step can be found.
  StepRecord step(long step, const std::vector<Collider>& colliders);

  // State under `group`, enough for an exact restart.
  void save(Hdf5Writer& file, const std::string& group) const;
  void restore(const Hdf5Reader& file, const std::string& group);

 private:
  struct State {
    Eigen::VectorXd x, v, q;
    std::vector<ContactMemory> contacts;
  };
  // One step of size h towards the goals, or with the rest parameters `keyed`; false when no exact step was
  // found. Adds to the record.
  bool advance(double h, const std::vector<Goal>& goals, const std::optional<Eigen::VectorXd>& keyed,
               const std::vector<Collider>& colliders, StepRecord& record);
  // To the equilibrium of the rest shape at q, turned and moved as little as can be; false when none was
  // found.
  bool settle(const Eigen::VectorXd& q, StepRecord& record);
  StepSolution solve(const StepProblem& problem, const Eigen::VectorXd& start, StepRecord& record);
  // ", with triangle 17 squeezed to 0.1 % of its size at rest" where the last solve failed; empty when none
  // was.
  std::string squeezed_element() const;
  double step_deadline() const;  // s of processor_seconds()
  void note_step_time(double seconds);
  void measure(const StepProblem& problem, const StepSolution& solution, StepRecord& record) const;

  WorldSettings settings_;
  BodyModel model_;
  Eigen::VectorXd rest_;  // d #V, the shape as placed in the scene
  std::unique_ptr<StepWorkspace> workspace_;
  std::unique_ptr<Controller> controller_;
  Eigen::VectorXd x_, v_, q_;
  Eigen::VectorXd stuck_;  // x of the last solve that failed
  std::vector<ContactMemory> contact_memory_;
  double wall_seconds_ = 0;
  std::vector<double> step_seconds_;  // processor time of the last steps, for the time limit
};

}  // namespace vivify::sim

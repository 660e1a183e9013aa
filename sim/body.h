// One controlled (or passive) deformable body: its model, its state, its controller, and the step that moves
// it.
#pragma once

#include <memory>
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
  TetMesh rest;                  // placed in the scene
  Eigen::MatrixXd cage_weights;  // #V by #C: harmonic coordinates of the rest vertices
  ContactPoints contact_points;
  Value model, regularizer, contact, controller, solver;
};

struct WorldSettings {
  Eigen::Vector3d gravity = {0, -9.81, 0};  // m/s²
  double h = 1.0 / 48;                      // s
};

BodyModel make_body_model(const BodyInput& input, const WorldSettings& settings);

class Body {
 public:
  // Throws Error(geometry) or Error(usage) when the input cannot be simulated.
  Body(const BodyInput& input, const WorldSettings& settings);
  Body(Body&&) = delete;

  const BodyModel& model() const { return model_; }
  const Eigen::VectorXd& x() const { return x_; }  // 3 #V, m
  const Eigen::VectorXd& v() const { return v_; }  // 3 #V, m/s
  Eigen::VectorXd p() const { return model_.rest.basis * q_; }
  const Controller& controller() const { return *controller_; }
  double wall_seconds() const { return wall_seconds_; }  // spent in step() by this process

  // One implicit Euler step; `step` counts from 1. Throws Error(numerical) when no exact step can be found.
  StepRecord step(long step, const std::vector<Collider>& colliders);

  // State under `group`, enough for an exact restart.
  void save(Hdf5Writer& file, const std::string& group) const;
  void restore(const Hdf5Reader& file, const std::string& group);

 private:
  StepSolution solve(const StepProblem& problem, int* fallback, std::string* method);
  Eigen::VectorXd guess(double h) const { return x_ + h * v_; }

  WorldSettings settings_;
  BodyModel model_;
  std::unique_ptr<StepWorkspace> workspace_;
  std::unique_ptr<Controller> controller_;
  Eigen::VectorXd x_, v_, q_;
  std::vector<ContactMemory> contact_memory_;
  double wall_seconds_ = 0;
};

}  // namespace vivify::sim

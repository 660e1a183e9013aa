// A controller turns what the animator asks for into goals for one step (Coros et al. 2012, Sections 3 and
// 7).
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/schema.h"
#include "sim/control/goal.h"

namespace vivify::sim {

// What a controller knows of its body, fixed for the run.
struct ControlledBody {
  const Eigen::VectorXd& mass;                 // #V, kg
  const Eigen::VectorXd& rest;                 // d #V, m, as placed in the scene
  double height;                               // of the body at rest, m
  double gravity;                              // downwards, m/s²
  double h;                                    // step size, s
  std::span<const std::string> examples = {};  // names of its example poses
  Eigen::MatrixXd poses = {};                  // #p by #examples: parameters of the rest shape in each
  int dimension() const { return static_cast<int>(rest.size() / mass.size()); }
};

// What a controller sees of the other bodies that are present.
struct OtherBody {
  std::string_view name;
  Eigen::Vector3d centre;  // of mass, m
  bool arrived;            // has done what it was asked for
};
using Others = std::span<const OtherBody>;

// What a controller sees at the start of a step.
struct Observation {
  const Eigen::VectorXd& x;  // d #V, m
  const Eigen::VectorXd& v;  // d #V, m/s
  double load;               // sum of the upward parts of the normal forces of the last step, N
  // Velocity in the coming step of the colliders that it stands on, m/s; nothing where it stands on none.
  std::optional<Eigen::Vector3d> ground = {};
  Others others = {};
  Eigen::VectorXd loads = {};  // #V: the normal forces of colliders in the last step, shared out, N
  Eigen::VectorXd p = {};      // of the rest shape
};

class Controller {
 public:
  virtual ~Controller() = default;

  // Goals of the coming step. Advances the controller's clock by one step.
  virtual std::vector<Goal> goals(const Observation& observation) = 0;

  // Whether it has done all that it was asked for; it stands by then.
  virtual bool arrived() const { return false; }

  // Parameters p of the rest shape at time t (s) when they are prescribed instead of sought; then the goals
  // have no effect.
  virtual std::optional<Eigen::VectorXd> rest_parameters(double) const { return std::nullopt; }

  // Whether the body asks for nothing and never changes its rest shape.
  virtual bool passive() const { return false; }

  // Which behaviour of a script it follows, from 0.
  virtual int behavior() const { return 0; }

  // What the controller is doing, for people: "thrust".
  virtual std::string phase() const = 0;

  // All that the next steps depend on, for an exact restart.
  virtual Eigen::VectorXd state() const = 0;
  virtual void restore(const Eigen::VectorXd& state) = 0;
};

struct ControllerEntry {
  std::string_view name;
  Schema (*schema)();
  std::unique_ptr<Controller> (*make)(const ControlledBody& body, const Value& settings);
};

std::span<const ControllerEntry> controllers();

// The setting `controller` of a body.
Schema controller_schema();

// The controller that `settings` (resolved with controller_schema) asks for. `body` must outlive it.
std::unique_ptr<Controller> make_controller(const ControlledBody& body, const Value& settings);

}  // namespace vivify::sim

// What is written down about every step of every body: the rows of sim/steps.csv.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace vivify::sim {

struct StepRecord {
  long step = 0;
  double t = 0;  // s, at the end of the step
  std::string body;
  std::string method;       // whose solution was kept: sqp, reduced, hold (rest shape kept), keyed (rest
                            // shape prescribed) or static
  int iterations = 0;       // of the optimiser, over all methods and contact passes
  int halvings = 0;         // damped or shortened trial steps
  int fallback = 0;         // 0: the chosen method converged; 1: the other was tried too; 2: rest shape held
  int guards = 0;           // trial steps refused because an element collapsed
  int substeps = 1;         // parts that the step was cut into because it could not be solved whole
  double residual_rel = 0;  // ‖c‖∞ over the weight
  double objective = 0;     // J
  double p_norm = 0;        // m, or shares of examples
  double p_rate = 0;        // ‖p − p_n‖ / h, per second
  Eigen::Vector3d com = Eigen::Vector3d::Zero();           // m
  Eigen::Vector3d vel = Eigen::Vector3d::Zero();           // m/s
  double internal_force = 0;                               // ‖Σ f_int‖, N
  double internal_torque = 0;                              // ‖Σ x × f_int‖, N m
  Eigen::Vector3d handle_force = Eigen::Vector3d::Zero();  // of the handles, which is external, N
  int contacts = 0;                                        // points with a normal force
  double max_penetration = 0;    // of the drawn surface's contact points below a collider, m
  double min_clearance = 0;      // smallest signed distance to a collider, m; infinite without colliders
  double min_element_ratio = 1;  // smallest v/V̄ (of rods and shells: l/L̄)
  double kinetic = 0;            // J
  double elastic = 0;            // J
  double tilt_deg = 0;           // angle of the body's up vector to the vertical
  std::string phase;             // of the controller
  // The rest shape. `rest_rate` is the root mean square of the velocities of its points over the height of
  // the body, per second: ‖Ẋ‖ in heights/s, alike for all rest spaces (p_rate has the unit of p and grows
  // with the number of parameters). 0 for strains, which have no shape.
  double rest_rate = 0;
  double min_rest_element_ratio = 1;  // smallest V/V̄ (of rods and shells: L/L̄)
  double rest_volume_ratio = 1;       // ΣV/ΣV̄ (of rods ΣL/ΣL̄, of shells ΣL²/ΣL̄², which goes as the area)
  int behavior = 0;                   // which one of its script the body follows, from 0
};

std::string csv_header();                        // one line, with the newline
std::string csv_line(const StepRecord& record);  // one line, with the newline; numbers read back exactly

}  // namespace vivify::sim

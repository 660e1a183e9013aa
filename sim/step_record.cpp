#include "sim/step_record.h"

#include "common/text.h"

namespace vivify::sim {

std::string csv_header() {
  return "step,t_s,body,method,sqp_iterations,linesearch_halvings,fallback,residual_rel,objective,p_norm,p_"
         "rate,"
         "com_x_m,com_y_m,com_z_m,vel_x_m_s,vel_y_m_s,vel_z_m_s,internal_force_sum_n,internal_torque_sum_nm,"
         "contacts,"
         "max_penetration_m,min_clearance_m,min_element_ratio,kinetic_j,elastic_j,tilt_deg,guards,substeps,"
         "handle_force_x_n,handle_force_y_n,handle_force_z_n,phase,rest_rate_per_s,min_rest_element_ratio,"
         "rest_volume_ratio,behavior\n";
}

std::string csv_line(const StepRecord& r) {
  std::string line = std::to_string(r.step) + ',' + number_text(r.t) + ',' + r.body + ',' + r.method + ',' +
                     std::to_string(r.iterations) + ',' + std::to_string(r.halvings) + ',' +
                     std::to_string(r.fallback);
  const auto add = [&](double value) { line += ',' + number_text(value); };
  for (const double value : {r.residual_rel, r.objective, r.p_norm, r.p_rate}) add(value);
  for (const Eigen::Vector3d& vector : {r.com, r.vel}) {
    for (int axis = 0; axis < 3; ++axis) add(vector[axis]);
  }
  for (const double value : {r.internal_force, r.internal_torque}) add(value);
  line += ',' + std::to_string(r.contacts);
  for (const double value :
       {r.max_penetration, r.min_clearance, r.min_element_ratio, r.kinetic, r.elastic, r.tilt_deg}) {
    add(value);
  }
  line += ',' + std::to_string(r.guards) + ',' + std::to_string(r.substeps);
  for (int axis = 0; axis < 3; ++axis) add(r.handle_force[axis]);
  line += ',' + r.phase;
  for (const double value : {r.rest_rate, r.min_rest_element_ratio, r.rest_volume_ratio}) add(value);
  return line + ',' + std::to_string(r.behavior) + '\n';
}

}  // namespace vivify::sim

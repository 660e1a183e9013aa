// What a frame tells of the contacts and goals of the step that ended with it, for plots and pictures. A
// restart needs none of it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/hdf5_file.h"
#include "sim/body.h"
#include "sim/contact/pair_contacts.h"

namespace vivify::sim {

// What touched between bodies.
std::vector<ContactForce> contact_forces(const std::vector<PairMemory>& touching,
                                         const std::vector<std::unique_ptr<Body>>& bodies);

// Writes #C contacts, in the units of ContactForce: GROUP/{position, normal_force, friction_force, anchor}
// (#C by 3), GROUP/{slip, distance} (#C), and what is first and second under the given names (#C). Nothing
// when there are none.
struct ContactNames {
  std::string first, second;
};
void put_contacts(Hdf5Writer& file, const std::string& group, const ContactNames& names,
                  const std::vector<ContactForce>& contacts);

// Writes #G goals of a body (mass #V, kg) at x and v (d #V, m and m/s). A goal asks for a motion of the
// GROUP/place (#G by 3, m) along GROUP/axis (#G by 3, unit), or where GROUP/turns (#G) is 1 for a turn about
// it: GROUP/{value, rate} (#G; m and m/s, turns: rad/s) are where it is, {value_target, rate_target} where it
// should be, and {value_weight, rate_weight} k_p and k_d of equation (6); a target without weight means
// nothing. Nothing when there are none.
void put_goals(Hdf5Writer& file, const std::string& group, const std::vector<Goal>& goals,
               const Eigen::VectorXd& mass, const Eigen::VectorXd& x, const Eigen::VectorXd& v);

}  // namespace vivify::sim

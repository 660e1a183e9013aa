// A foot of a body that walks: some of its vertices, and the goals that keep them or move them.
#pragma once

#include <vector>

#include "common/matrix.h"
#include "sim/control/controller.h"

namespace vivify::sim {

struct FootTarget {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();    // of its centre, m
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();  // of its centre, m/s
  double upright = 0;                              // frequency with which it turns upright, 1/s
  double yaw = 0;                                  // of the body about the vertical
};

class Foot {
 public:
  // `vertices` of the body; of a body of space those of the sole.
  Foot(const ControlledBody& body, std::vector<int> vertices);

  const std::vector<int>& vertices() const { return vertices_; }
  // Its centre less that of the body at rest, horizontally, m.
  const Eigen::Vector3d& home() const { return home_; }
  // Of a body that is at x (d #V), m.
  Eigen::Vector3d centre(const Eigen::VectorXd& x) const;
  // Height of its centre while it stands on ground of the height `ground`, m: a sole is flat, in the plane it
  // is as deformed as it is.
  double standing_height(const Eigen::VectorXd& x, double ground) const;

  // k_p and k_d are those of the foot as a whole. In the plane its centre has a goal, and its turning. In
  // space each vertex has its place: only a sole that is flat on the ground can push where the balance needs
  // it.
  void add_goals(const Eigen::VectorXd& x, const FootTarget& target, double kp, double kd,
                 std::vector<Goal>& goals) const;

 private:
  void add_goals_in_plane(const Eigen::VectorXd& x, const FootTarget& target, double kp, double kd,
                          std::vector<Goal>& goals) const;
  void add_goals_of_sole(const FootTarget& target, double kp, double kd, std::vector<Goal>& goals) const;

  ControlledBody body_;
  std::vector<int> vertices_;
  Eigen::VectorXd mass_;  // #V: of its vertices, kg, or 1 for each of a sole; 0 elsewhere
  Eigen::Vector3d home_;
  double size_;       // radius of gyration, m
  RowMatrixXd arms_;  // #vertices by 3: from its centre to its vertices at rest, m
};

}  // namespace vivify::sim

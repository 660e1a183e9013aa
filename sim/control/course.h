// Where a controller travels: along a heading, to a place, along a path, after another body or away from it.
#pragma once

#include <string>
#include <vector>

#include "sim/control/controller.h"

namespace vivify::sim {

// Adds the keys `heading_deg`, `to`, `path`, `chase` and `flee`.
Schema add_course(Schema controller);

// Adds an Error(usage) for two courses at once, and for a body of the plane that is sent out of it. `where`
// is the path of the settings. Settings without a course pass.
void check_course(const Value& settings, const std::string& where, bool planar, std::vector<Error>& errors);

class Course {
 public:
  // Throws Error(usage) for what check_course() finds, and without gravity, which presses a body onto the
  // ground that it travels on.
  Course(const ControlledBody& body, const Value& settings);

  // What is ahead of the centre of mass, horizontally.
  struct Way {
    Eigen::Vector3d forward;  // unit vector
    double offset;            // from the line of travel, to the left, m
    double left;              // to where it ends, m; infinite when it does not
  };
  // From `centre` (m), aiming `ahead` m further along a path. The course begins at the centre of the first
  // call. Of the others only those that it is about are looked at; without them it keeps its direction.
  Way way(const Eigen::Vector3d& centre, double ahead, const Others& others);

  // Whether the way is as good as gone: so near to its end that a body as large does not mind.
  bool ends(const Way& way) const { return way.left < tolerance_; }

  static constexpr int kStateSize = 8;
  Eigen::VectorXd state() const;
  void restore(const Eigen::VectorXd& state);

 private:
  Eigen::Vector3d level(Eigen::Vector3d v) const;
  Way along_path(const Eigen::Vector3d& centre, double ahead);

  bool planar_;
  double tolerance_;                   // m
  std::vector<Eigen::Vector3d> path_;  // places after the first
  std::string other_;                  // body that it follows or flees
  double towards_other_ = 0;           // 1 follows, −1 flees
  Eigen::Vector3d forward_;
  bool begun_ = false;
  Eigen::Vector3d from_ = Eigen::Vector3d::Zero();  // where the present leg begins
  int leg_ = 0;                                     // place that it goes to
};

}  // namespace vivify::sim

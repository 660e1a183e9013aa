// Where the ground shall push a body that walks. Of the body only its centre of mass counts: the linear
// inverted pendulum. Pushed at p, the centre of mass c accelerates with ω² (c − p), and the capture point ξ =
// c + ċ / ω moves away from p with the rate ω (ξ − p) (Pratt et al. 2006).
#pragma once

#include <memory>

#include "sim/control/support.h"

namespace vivify::sim {

// A walker at the beginning of a time step. Points are level: their heights are 0.
struct Stance {
  enum Phase { stand, shift, swing };  // no foot steps; one is about to; it is on its way

  Phase phase;
  double height;                  // of the body at rest, m
  double pendulum;                // ω, 1/s
  Eigen::Vector3d capture_point;  // ξ
  Support every;                  // under all feet
  Support loaded;                 // under those that bear the body; where none does, under those that stay
  Support staying;                // under all but the one that steps
  Eigen::Vector3d belongs;        // where the foot that steps belongs beside the others
  Eigen::Vector3d landing;        // where it shall land
  double swing_s;                 // duration of its way
  double left_s;                  // of it
};

class WalkingBalance {
 public:
  virtual ~WalkingBalance() = default;

  // Where the ground shall push: within the support.
  virtual Eigen::Vector3d push(const Stance& now) const = 0;
  // Whether the foot that is about to step may leave the ground.
  virtual bool can_step(const Stance& now) const = 0;
  // Whether the foot on its way has to come down at once.
  virtual bool must_land(const Stance& now) const = 0;
  // How much further it goes than it was meant to, m.
  virtual Eigen::Vector3d further(const Stance& now) const = 0;
  // Rate at which is forgotten what was learnt to be asked for on top, 1/s.
  virtual double forgetting() const = 0;
};

// In the plane the centre of mass goes above the feet that stay, and then the other one steps. In space the
// body rocks from foot to foot: its feet may be lines on which it cannot stand.
std::unique_ptr<WalkingBalance> make_walking_balance(bool planar);

}  // namespace vivify::sim

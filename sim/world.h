// All bodies and colliders of a scene, stepped together.
#pragma once

#include <memory>
#include <vector>

#include "sim/body.h"

namespace vivify::sim {

class World {
 public:
  World(const std::vector<BodyInput>& bodies, std::vector<Collider> colliders, const WorldSettings& settings);

  // One step of every body, in order; the records are kept until save().
  void step();
  long steps() const { return steps_; }
  double time() const { return static_cast<double>(steps_) * settings_.h; }
  int body_count() const { return static_cast<int>(bodies_.size()); }
  const Body& body(int i) const { return *bodies_[static_cast<std::size_t>(i)]; }

  // Records of the steps since the last save().
  const std::vector<StepRecord>& records() const { return records_; }

  // Writes a frame: /t, /bodies/NAME/{x,v,p,restart}, and the records since the frame before as CSV lines in
  // /steps.
  void save(Hdf5Writer& file);
  // Goes on from a saved frame.
  void restore(const Hdf5Reader& file);

 private:
  WorldSettings settings_;
  std::vector<Collider> colliders_;
  std::vector<std::unique_ptr<Body>> bodies_;
  std::vector<StepRecord> records_;
  long steps_ = 0;
};

}  // namespace vivify::sim

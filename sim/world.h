// All bodies and colliders of a scene, stepped together. Bodies that may touch in a step are solved as one
// island; islands are independent and run in parallel.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "sim/island.h"

namespace vivify::sim {

class World {
 public:
  // Throws Error(geometry) for bodies that cannot be simulated or that start deep inside each other.
  World(const std::vector<BodyInput>& bodies, std::vector<Collider> colliders, const WorldSettings& settings);

  // One step of every body; the records, in the order of the bodies, are kept until save().
  void step();
  long steps() const { return steps_; }
  double time() const { return static_cast<double>(steps_) * settings_.h; }
  int body_count() const { return static_cast<int>(bodies_.size()); }
  const Body& body(int i) const { return *bodies_[static_cast<std::size_t>(i)]; }
  // The bodies of each island of the last step.
  const std::vector<std::vector<int>>& islands() const { return grouping_; }
  // What touched at the end of the last step, sorted by identity.
  const std::vector<PairMemory>& touching() const { return touching_; }

  // Records of the steps since the last save().
  const std::vector<StepRecord>& records() const { return records_; }

  // Writes a frame: /t, /bodies/NAME/{x,v,p,restart}, /touching, and the records since the frame before as
  // CSV lines in /steps.
  void save(Hdf5Writer& file);
  // Goes on from a saved frame.
  void restore(const Hdf5Reader& file);

 private:
  std::vector<BodyPairs> near_bodies();
  void require_apart();
  void group(const std::vector<BodyPairs>& pairs);

  WorldSettings settings_;
  std::vector<Collider> colliders_;
  std::vector<std::unique_ptr<Body>> bodies_;
  std::vector<std::vector<int>> grouping_;
  std::map<std::vector<int>, std::unique_ptr<Island>>
      islands_;  // those of the last step, and every body alone
  std::vector<PairMemory> touching_;
  std::vector<StepRecord> records_;
  long steps_ = 0;
};

}  // namespace vivify::sim

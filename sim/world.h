// All bodies and colliders of a scene, stepped together. Bodies that may touch in a step are solved as one
// island; islands are independent and run in parallel. Islands that met nevertheless are solved again as one.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "sim/island.h"

namespace vivify::sim {

class World {
 public:
  // Throws Error(geometry) for bodies that cannot be simulated or that check_start() refuses.
  World(const std::vector<BodyInput>& bodies, std::vector<Collider> colliders, const WorldSettings& settings);

  // One step of every body that has appeared; the records, in the order of the bodies, are kept until save().
  // Throws Error(numerical) when it cannot be solved, and Error(geometry) when check_start() refuses a body
  // that appears after it.
  void step();
  long steps() const { return steps_; }
  double time() const { return static_cast<double>(steps_) * settings_.h; }
  int body_count() const { return static_cast<int>(bodies_.size()); }
  const Body& body(int i) const { return *bodies_[static_cast<std::size_t>(i)]; }
  // Whether a body has appeared. Before, it is not simulated, recorded or saved.
  bool present(int i) const { return steps_ >= body(i).spawn_step(); }
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
  // Finds the bodies that are present.
  void list_members();
  // Lets in the bodies whose time has come.
  void admit();
  // Near places of all bodies where they are.
  std::vector<BodyPairs> find_near();
  std::vector<Body::Wish> wishes();
  // The numbers of the bodies of each island when the bodies of a link are in one.
  using Links = std::vector<std::pair<int, int>>;
  std::vector<std::vector<int>> groups_of(const Links& links) const;
  // Solves one island from the states at the start of the step.
  struct IslandStep {
    std::vector<StepRecord> records;
    std::vector<PairMemory> touching;
  };
  IslandStep solve(const std::vector<int>& group, const std::vector<Body::Wish>& wishes,
                   const std::vector<BodyPairs>& near);
  // Bodies of different islands that touch or have crossed at the end of the step, and where they were near
  // at its beginning.
  struct Meetings {
    Links links;
    std::vector<BodyPairs> near;
  };
  Meetings met(const std::vector<Body::State>& before, const std::vector<BodyPairs>& near_after);

  WorldSettings settings_;
  std::vector<Collider> colliders_;
  std::vector<std::unique_ptr<Body>> bodies_;
  std::vector<Member> members_;  // that are present
  std::vector<std::vector<int>> grouping_;
  // Those of the last step, and every body alone.
  std::map<std::vector<int>, std::unique_ptr<Island>> islands_;
  std::optional<std::vector<BodyPairs>> near_;  // at the end of the last step
  std::vector<PairMemory> touching_;
  std::vector<StepRecord> records_;
  long steps_ = 0;
};

}  // namespace vivify::sim

// Bodies that are solved together because they may touch during a step, with all their parameters (one body
// alone is an island too).
#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "sim/contact/pair_contacts.h"
#include "sim/near_bodies.h"
#include "sim/solve/step_method.h"

namespace vivify::sim {

class Island {
 public:
  // The members are in ascending order of their numbers, and of one dimension.
  Island(std::vector<Member> members, const WorldSettings& settings);

  // One implicit Euler step of every member towards its wish; `step` counts from 1. `pairs` are the near
  // places at its start; `memory` holds what touched at the end of the last step, and is renewed. Throws
  // Error(numerical) when no exact step can be found.
  std::vector<StepRecord> step(long step, const std::vector<Collider>& colliders,
                               const std::vector<Body::Wish>& wishes, const std::vector<BodyPairs>& pairs,
                               std::vector<PairMemory>& memory);

 private:
  // One step of size h to the time `end` towards the wishes; `share` is how much of the whole step has passed
  // at its end. False when no exact step was found. Adds to the records.
  bool advance(double end, double h, double share, const std::vector<Body::Wish>& wishes,
               const std::vector<Body::State>& before, const std::vector<Collider>& colliders,
               std::vector<BodyPairs> places, std::vector<PairMemory>& memory,
               std::vector<StepRecord>& records);
  // From the guess q, x; `x_n` are the positions before the step.
  StepSolution solve(const StepProblem& problem, const Eigen::VectorXd& x_n, const Eigen::VectorXd& q,
                     const Eigen::VectorXd& x, StepRecord& record);
  // Adds the edges of `memory` that touch still (their surfaces are where they were moved to).
  void keep_edges(const std::vector<PairMemory>& memory, std::vector<BodyPairs>& pairs) const;
  // Contacts between the members at the places `pairs`, bound to a pattern that holds them; `last` are those
  // of the pass before.
  PairContacts pair_contacts(const std::vector<BodyPairs>& pairs, const std::vector<PairMemory>& memory,
                             const PairContacts* last);
  void bind(PairContacts& contacts);
  // Where members are near one another when they are at x, before (`ahead`) or after a step of h.
  std::vector<BodyPairs> near_members(const Eigen::VectorXd& x, double h, bool ahead) const;
  bool pairs_hold(const std::vector<BodyPairs>& pairs, const PairContacts& contacts,
                  const Eigen::VectorXd& x) const;
  // Whether thin members would cross on straight lines from one state to another.
  bool passes_through(const Eigen::VectorXd& from, const Eigen::VectorXd& to) const;
  std::size_t member(int index) const;  // place in the list of the member with this number
  const BodyModel& model_of(int index) const { return members_[member(index)].body->model(); }
  Eigen::VectorXd part(const Eigen::VectorXd& x, std::size_t m) const;  // of member m, of the x of all
  void move_surfaces(const Eigen::VectorXd& x) const;
  std::string names() const;
  double step_deadline() const;  // s of processor_seconds()
  void note_step_time(double seconds);

  WorldSettings settings_;
  std::vector<Member> members_;
  std::vector<int> first_vertex_;  // of each member
  double heaviest_ = 0;            // weight of a member, N
  std::unique_ptr<SymmetricPattern> pattern_;
  std::set<std::vector<int>> couplings_;  // vertices of the contacts in the pattern
  std::unique_ptr<StepWorkspace> workspace_;
  double deadline_ = INFINITY;        // of the step, s of processor_seconds()
  bool crossed_ = false;              // the last part of a step failed because thin bodies would cross
  std::vector<double> step_seconds_;  // processor time of the last steps, for the time limit
};

}  // namespace vivify::sim

#include "sim/island.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

#include "common/parallel.h"
#include "common/registry.h"
#include "common/text.h"
#include "sim/solve/processor_time.h"

namespace vivify::sim {
namespace {

constexpr int kMaxContactPasses = 3;     // solves of one step while contact planes still move
constexpr double kPlaneTolerance = 0.1;  // of the contact layer: how far a plane may be from the true surface
constexpr double kReach = 2;          // of the travel of a body in a step: how far a collider is looked for
constexpr double kNear = 0.05;        // and of its height
constexpr double kRelaxedRest = 0.8;  // a body stuck on a collapsed rest shape relaxes it by this factor
constexpr int kMaxStepSplits = 6;     // a step that cannot be solved is cut in halves so many times
constexpr double kTimeLimit = 100;    // of the median of the last steps: a step that takes longer is given up
constexpr double kLeastTimeLimit = 10;   // s
constexpr std::size_t kNamedBodies = 4;  // in a message
constexpr std::size_t kTimedSteps = 50, kFewestTimedSteps = 5;

Eigen::VectorXd joined(const std::vector<Eigen::VectorXd>& parts) {
  Eigen::Index size = 0;
  for (const Eigen::VectorXd& part : parts) size += part.size();
  Eigen::VectorXd all(size);
  Eigen::Index at = 0;
  for (const Eigen::VectorXd& part : parts) {
    all.segment(at, part.size()) = part;
    at += part.size();
  }
  return all;
}

// The goals of all members, each of its own x.
Goals joined(const std::vector<Goals>& parts, const std::vector<Eigen::VectorXd>& x) {
  if (parts.size() == 1) return parts[0];
  Goals all;
  Eigen::Index rows = 0, columns = 0;
  for (std::size_t b = 0; b < parts.size(); ++b) {
    rows += parts[b].size();
    columns += x[b].size();
  }
  all.G = Eigen::MatrixXd::Zero(rows, columns);
  all.s.resize(rows);
  Eigen::Index row = 0, column = 0;
  for (std::size_t b = 0; b < parts.size(); ++b) {
    all.G.block(row, column, parts[b].size(), x[b].size()) = parts[b].G;
    all.s.segment(row, parts[b].size()) = parts[b].s;
    row += parts[b].size();
    column += x[b].size();
  }
  return all;
}

// Whether the sign of the pair's distance tells nothing: its face (of edges both) belongs to a body without
// inside.
bool is_unsided(const SurfacePair& pair, const BodyModel& a, const BodyModel& b) {
  switch (pair.kind) {
    case SurfacePair::point_face:
      return b.surface.two_sided;
    case SurfacePair::face_point:
      return a.surface.two_sided;
    default:
      return a.surface.two_sided && b.surface.two_sided;
  }
}

const PairMemory* find(const std::vector<PairMemory>& memory, const PairIdentity& identity) {
  const auto found = std::lower_bound(
      memory.begin(), memory.end(), identity,
      [](const PairMemory& entry, const PairIdentity& wanted) { return entry.identity < wanted; });
  return found != memory.end() && found->identity == identity ? &*found : nullptr;
}

}  // namespace

Island::Island(std::vector<Member> members, const WorldSettings& settings)
    : settings_(settings), members_(std::move(members)) {
  int vertices = 0;
  for (const Member& member : members_) {
    first_vertex_.push_back(vertices);
    vertices += static_cast<int>(member.body->model().mass.size());
    heaviest_ = std::max(heaviest_, member.body->model().weight);
  }
}

Eigen::VectorXd Island::part(const Eigen::VectorXd& x, std::size_t m) const {
  const BodyModel& model = members_[m].body->model();
  return x.segment(model.dimension() * first_vertex_[m], model.dofs());
}

void Island::move_surfaces(const Eigen::VectorXd& x) const {
  parallel_for(members_.size(), [&](std::size_t m) { members_[m].body->move_surface(part(x, m)); });
}

std::string Island::names() const {
  std::string text = members_.size() == 1 ? "body" : "bodies";
  const std::size_t shown = std::min(members_.size(), kNamedBodies);
  for (std::size_t m = 0; m < shown; ++m)
    text += (m == 0 ? " '" : ", '") + members_[m].body->model().name + "'";
  if (shown < members_.size()) text += " and " + std::to_string(members_.size() - shown) + " more";
  return text;
}

// The pattern, and with it the order of elimination, depends on the contacts of now alone, so that a run that
// goes on from a saved frame rounds alike.
void Island::bind(PairContacts& contacts) {
  std::set<std::vector<int>> couplings = contacts.couplings();
  const bool fits = workspace_ && couplings == couplings_;
  if (!fits) {
    workspace_.reset();
    couplings_ = std::move(couplings);
    const int vertices = first_vertex_.back() + static_cast<int>(members_.back().body->model().mass.size());
    pattern_ = std::make_unique<SymmetricPattern>(vertices, members_[0].body->model().dimension());
    for (std::size_t m = 0; m < members_.size(); ++m)
      members_[m].body->model().reserve(*pattern_, first_vertex_[m]);
    for (const std::vector<int>& coupled : couplings_)
      pattern_->couple(coupled.data(), static_cast<int>(coupled.size()));
    pattern_->finish();
    workspace_ = std::make_unique<StepWorkspace>(*pattern_);
    workspace_->deadline = deadline_;
  }
  contacts.bind(*pattern_);
  parallel_for(members_.size(), [&](std::size_t m) {
    BodyModel& model = members_[m].body->model();
    if (!fits || model.bound_to != pattern_.get()) model.bind(*pattern_, first_vertex_[m]);
  });
}

std::size_t Island::member(int index) const {
  const auto found = std::lower_bound(members_.begin(), members_.end(), index,
                                      [](const Member& m, int wanted) { return m.index < wanted; });
  return static_cast<std::size_t>(found - members_.begin());
}

void Island::keep_edges(const std::vector<PairMemory>& memory, std::vector<BodyPairs>& pairs) const {
  std::set<PairIdentity> known;
  for (const BodyPairs& between : pairs) {
    for (const SurfacePair& pair : between.pairs)
      known.insert({between.a, between.b, pair.kind, pair.feature_a, pair.feature_b});
  }
  for (const PairMemory& entry : memory) {
    const PairIdentity& id = entry.identity;
    if (id.kind != SurfacePair::edge_edge || known.contains(id)) continue;
    const std::optional<SurfacePair> kept =
        kept_edge_pair(members_[member(id.body_a)].body->surface(), id.feature_a,
                       members_[member(id.body_b)].body->surface(), id.feature_b, entry.normal);
    if (kept) pairs.push_back({id.body_a, id.body_b, {*kept}});
  }
}

PairContacts Island::pair_contacts(const std::vector<BodyPairs>& pairs, const std::vector<PairMemory>& memory,
                                   const PairContacts* last) {
  PairContacts contacts(members_[0].body->model().dimension());
  std::map<PairIdentity, Eigen::Vector3d> last_normals;
  if (last != nullptr) {
    for (const PairContact& contact : last->contacts()) last_normals[contact.identity] = contact.normal;
  }
  for (const BodyPairs& between : pairs) {
    const std::size_t ma = member(between.a), mb = member(between.b);
    const BodyModel &a = members_[ma].body->model(), &b = members_[mb].body->model();
    // One place may have to bear the heaviest body.
    const double layer = std::max(a.contact.layer, b.contact.layer), load = heaviest_;
    const double friction_stiffness = 2 * load / layer;
    for (const SurfacePair& pair : between.pairs) {
      const PairIdentity identity{between.a, between.b, pair.kind, pair.feature_a, pair.feature_b};
      const PairMemory* before = find(memory, identity);
      PairContact contact{identity,
                          {pair.a, pair.weight_a},
                          {pair.b, pair.weight_b},
                          {pair.a, pair.weight_a},
                          {pair.b, pair.weight_b},
                          {},
                          {},
                          pair.normal,
                          a.surface.radius + b.surface.radius,
                          {load / (layer * layer), layer},
                          Eigen::Vector3d::Zero(),
                          Friction(friction_stiffness, 0)};
      if (before != nullptr) {
        contact.anchor_a = before->a;
        contact.anchor_b = before->b;
        contact.offset = before->offset;
        contact.touched = true;
        contact.friction =
            Friction(friction_stiffness,
                     a.contact.friction_against(b.name, b.contact.friction) * before->normal_force);
      }
      // Thin bodies have no inside: what touched them stays on its side.
      const auto normal = last_normals.find(identity);
      const Eigen::Vector3d side = normal != last_normals.end() ? normal->second
                                   : before != nullptr          ? before->normal
                                                                : pair.normal;
      if (is_unsided(pair, a, b) && side.dot(pair.normal) < 0) contact.normal = -pair.normal;
      contact.gap.add(a.surface.points, contact.place_a, first_vertex_[ma], 1);
      contact.gap.add(b.surface.points, contact.place_b, first_vertex_[mb], -1);
      contact.slip.add(a.surface.points, contact.anchor_a, first_vertex_[ma], 1);
      contact.slip.add(b.surface.points, contact.anchor_b, first_vertex_[mb], -1);
      contacts.add(std::move(contact));
    }
  }
  bind(contacts);
  return contacts;
}

std::vector<BodyPairs> Island::near_members(const Eigen::VectorXd& x, double h, bool ahead) const {
  move_surfaces(x);
  std::vector<Eigen::VectorXd> moves;
  for (const Member& member : members_) moves.push_back(h * member.body->v());
  return near_bodies(members_, moves, ahead);
}

// Whether every near place that touches is a contact of `contacts` whose frozen plane describes it.
bool Island::pairs_hold(const std::vector<BodyPairs>& pairs, const PairContacts& contacts,
                        const Eigen::VectorXd& x) const {
  std::map<PairIdentity, const PairContact*> known;
  for (const PairContact& contact : contacts.contacts()) known[contact.identity] = &contact;
  for (const BodyPairs& between : pairs) {
    for (const SurfacePair& pair : between.pairs) {
      const auto found = known.find({between.a, between.b, pair.kind, pair.feature_a, pair.feature_b});
      const auto [a, b] = std::pair(&model_of(between.a), &model_of(between.b));
      const double layer = std::max(a->contact.layer, b->contact.layer);
      const double distance = pair.distance - a->surface.radius - b->surface.radius;
      if (found == known.end()) {
        if (distance < (1 - kPlaneTolerance) * layer) return false;
        continue;
      }
      const double assumed = contacts.distance(*found->second, x);
      if (std::min(assumed, distance) < layer && std::abs(assumed - distance) > kPlaneTolerance * layer)
        return false;
    }
  }
  return true;
}

bool Island::passes_through(const Eigen::VectorXd& from, const Eigen::VectorXd& to) const {
  if (!has_thin(members_)) return false;
  std::vector<Eigen::VectorXd> moves;
  for (std::size_t m = 0; m < members_.size(); ++m) moves.push_back(part(to - from, m));
  move_surfaces(from);
  return !crossing_bodies(members_, moves, [](int, int) { return true; }).empty();
}

StepSolution Island::solve(const StepProblem& problem, const Eigen::VectorXd& x_n, const Eigen::VectorXd& q,
                           const Eigen::VectorXd& x, StepRecord& record) {
  const Eigen::VectorXd& q_n = problem.q_n();
  if (q_n.size() == 0) {
    StepSolution solution;
    record.method = "keyed";
    solution.rest = problem.rest_point(q_n, false);
    solution.at = problem.deformed_point(x);
    finish_exactly(problem, solution, *workspace_);
    return solution;
  }
  const auto attempt = [&](const std::string& method) {
    StepSolution solution =
        find_entry(step_methods(), method, "step method").solve(problem, q, x, *workspace_);
    record.iterations += solution.iterations;
    record.halvings += solution.halvings;
    record.guards += solution.guards;
    return solution;
  };
  record.method = problem.solver().method;
  StepSolution best = attempt(record.method);
  if (best.exact && best.optimal) return best;

  record.fallback = std::max(record.fallback, 1);
  const std::string other = record.method == "sqp" ? "reduced" : "sqp";
  StepSolution second = attempt(other);
  if (second.exact && (!best.exact || second.objective < best.objective)) {
    record.method = other;
    best = std::move(second);
  }
  if (best.exact) return best;

  record.fallback = 2;
  record.method = "hold";
  for (const double keep : {1.0, kRelaxedRest, kRelaxedRest * kRelaxedRest}) {
    for (const Eigen::VectorXd& start : {x, x_n}) {
      StepSolution hold;
      hold.rest = problem.rest_point(keep * q_n, true);
      hold.at = problem.deformed_point(start);
      finish_exactly(problem, hold, *workspace_);
      if (hold.exact) return hold;
    }
  }
  return best;
}

bool Island::advance(double end, double h, double share, const std::vector<Body::Wish>& wishes,
                     const std::vector<Body::State>& before, const std::vector<Collider>& colliders,
                     std::vector<BodyPairs> places, std::vector<PairMemory>& memory,
                     std::vector<StepRecord>& records) {
  const std::size_t count = members_.size();
  std::vector<Eigen::VectorXd> x_n(count), starts(count);
  std::vector<BodyStep> steps(count);
  std::vector<Goals> own_goals(count);
  std::vector<double> reaches(count);
  std::vector<ContactSet> contacts(count);
  std::vector<Hold> holds(count);
  const auto touch_colliders = [&](const Eigen::VectorXd& x, bool settled) {
    parallel_for(count, [&](std::size_t m) {
      const BodyModel& model = members_[m].body->model();
      ContactParameters parameters = model.contact;
      if (count > 1) {  // one point of a light body may have to bear the heaviest of the island
        parameters.normal_stiffness = heaviest_ / (parameters.layer * parameters.layer);
        parameters.friction_stiffness = 2 * heaviest_ / parameters.layer;
      }
      contacts[m] = ContactSet(model.contact_points, parameters, colliders, part(x, m), reaches[m],
                               members_[m].body->state().contacts, end - h, end, settled);
    });
  };
  for (std::size_t m = 0; m < count; ++m) {
    const BodyModel& model = members_[m].body->model();
    const Body::State& state = members_[m].body->state();
    const int d = model.dimension();
    own_goals[m] = wishes[m].q ? Goals() : make_goals(wishes[m].goals, state.x, h);
    if (wishes[m].q) own_goals[m].G.resize(0, state.x.size());
    x_n[m] = state.x;
    starts[m] = state.x + h * state.v;
    holds[m] = members_[m].body->handles().at(end, h);
    steps[m] = {&model, &contacts[m], state.x, starts[m], state.q, {}, &holds[m]};
    const Eigen::Vector3d push = members_[m].body->pushed(end - h, end);
    for (Eigen::Index i = 0; i < model.mass.size(); ++i)
      steps[m].x_tilde.segment(d * i, d) += h * h * settings_.gravity.head(d) + h * push.head(d);
    if (wishes[m].q) {
      const bool same = *wishes[m].q == before[m].q;
      steps[m].q = same ? before[m].q : Eigen::VectorXd((1 - share) * before[m].q + share * *wishes[m].q);
    }
    reaches[m] = model.contact.layer + kReach * members_[m].body->travel(h) + kNear * model.height;
  }
  const Goals goals = joined(own_goals, x_n);
  const Eigen::VectorXd x_start = joined(x_n), start = joined(starts);
  touch_colliders(x_start, false);
  if (!memory.empty()) {
    move_surfaces(x_start);
    keep_edges(memory, places);
  }
  PairContacts pairs = pair_contacts(places, memory, nullptr);
  const bool may_touch = count > 1 || members_[0].body->model().contact.self;

  StepRecord shared;
  StepSolution solution;
  std::optional<StepProblem> problem;
  for (int pass = 1;; ++pass) {
    problem.emplace(steps, &pairs, goals, h);
    // The solution of the pass before is near that of the next.
    solution = pass == 1 ? solve(*problem, x_start, problem->q_n(), start, shared)
                         : solve(*problem, x_start, solution.rest.q, solution.at.x, shared);
    if (!solution.exact || pass == kMaxContactPasses) break;
    std::vector<char> planes_hold(count);
    parallel_for(count, [&](std::size_t m) {
      planes_hold[m] = contacts[m].planes_hold(colliders, part(solution.at.x, m),
                                               kPlaneTolerance * members_[m].body->model().contact.layer);
    });
    bool hold = std::find(planes_hold.begin(), planes_hold.end(), false) == planes_hold.end();
    if (may_touch) {
      places = near_members(solution.at.x, h, false);
      keep_edges(memory, places);
      hold = hold && pairs_hold(places, pairs, solution.at.x);
    }
    if (hold) break;
    if (may_touch) pairs = pair_contacts(places, memory, &pairs);
    touch_colliders(solution.at.x, true);
  }
  for (StepRecord& record : records) {
    record.method = shared.method;
    record.iterations += shared.iterations;
    record.halvings += shared.halvings;
    record.guards += shared.guards;
    record.fallback = std::max(record.fallback, shared.fallback);
    record.residual_rel = std::max(record.residual_rel, solution.residual);
  }
  // What has no inside cannot be pushed back out: it must not be passed through on the way.
  crossed_ = solution.exact && may_touch && passes_through(x_start, solution.at.x);
  if (crossed_) solution.exact = false;
  if (!solution.exact) {
    for (std::size_t m = 0; m < count; ++m) members_[m].body->note_failure(problem->x_of(m, solution.at.x));
    return false;
  }

  memory = pairs.memory(solution.at.x);
  parallel_for(count, [&](std::size_t m) {
    Body& body = *members_[m].body;
    Body::State& state = body.state();
    const Eigen::VectorXd q = problem->q_of(m, solution.rest.q);
    body.measure_rest_motion(q, h, records[m]);
    records[m].objective = solution.objective;
    const Eigen::VectorXd x = problem->x_of(m, solution.at.x);
    state.v = (x - state.x) / h;
    state.x = x;
    state.q = q;
    contacts[m].update_memory(x, state.contacts);
    body.note_contacts(contacts[m].forces(x));
    body.measure(*problem, m, solution.at, solution.rest, records[m]);
  });
  return true;
}

std::vector<StepRecord> Island::step(long step, const std::vector<Collider>& colliders,
                                     const std::vector<Body::Wish>& wishes,
                                     const std::vector<BodyPairs>& pairs, std::vector<PairMemory>& memory) {
  const auto begin = std::chrono::steady_clock::now();
  const double processor_begin = processor_seconds();
  const std::vector<PairMemory> memory_before = memory;
  std::vector<Body::State> before;
  for (const Member& member : members_) before.push_back(member.body->state());

  deadline_ = step_deadline();
  if (workspace_) workspace_->deadline = deadline_;
  const auto expired = [&] { return processor_seconds() > deadline_; };
  std::vector<StepRecord> records;
  bool solved = false;
  for (int splits = 0; splits <= kMaxStepSplits && !solved && !expired(); ++splits) {
    const int parts = 1 << splits;
    if (records.empty()) records.resize(members_.size());
    for (StepRecord& record : records) {
      record.residual_rel = record.p_rate = record.rest_rate = 0;
      record.substeps = parts;
    }
    solved = true;
    for (int part = 0; part < parts && solved; ++part) {
      const double share = (part + 1.0) / parts, h = settings_.h / parts;
      const double end = (static_cast<double>(step) - 1 + share) * settings_.h;
      if (settings_.statics) {
        for (std::size_t m = 0; m < members_.size() && solved; ++m) {
          Eigen::VectorXd q = before[m].q;
          if (wishes[m].q) q = (1 - share) * before[m].q + share * *wishes[m].q;
          solved = members_[m].body->settle(q, records[m]);
        }
      } else if (part == 0) {
        solved = advance(end, h, share, wishes, before, colliders, pairs, memory, records);
      } else {
        std::vector<Eigen::VectorXd> x;
        for (const Member& member : members_) x.push_back(member.body->x());
        solved = advance(end, h, share, wishes, before, colliders, near_members(joined(x), h, true), memory,
                         records);
      }
    }
    if (solved) break;
    for (std::size_t m = 0; m < members_.size(); ++m) members_[m].body->state() = before[m];
    memory = memory_before;
  }
  const std::string where = names() + ", step " + std::to_string(step);
  // Also of a step that was solved: methods that ran out of time stop early, and results must not depend on
  // the clock.
  if (expired()) {
    throw Error(ErrorKind::numerical,
                where + ": not solved in " + number_text(kTimeLimit) + " times the time of the steps before",
                "raise frames.steps_per_frame, ask for slower motion, or make the model stiffer");
  }
  if (!solved) {
    std::string squeezed;
    for (const Member& member : members_) {
      const std::string element = member.body->squeezed_element();
      if (!element.empty())
        squeezed += element + (members_.size() > 1 ? " of '" + member.body->model().name + "'" : "");
    }
    if (crossed_) {
      throw Error(ErrorKind::numerical,
                  where + ": thin bodies would pass through one another, in steps down to a " +
                      std::to_string(1 << kMaxStepSplits) + "th",
                  "raise frames.steps_per_frame, ask for slower motion, or make the thin bodies thicker");
    }
    throw Error(ErrorKind::numerical,
                where + ": the equations of motion were not solved (residual " +
                    number_text(records[0].residual_rel) + " of the weight, in steps down to a " +
                    std::to_string(1 << kMaxStepSplits) + "th" + squeezed + ")",
                "raise frames.steps_per_frame, ask for slower motion, or make the model stiffer");
  }

  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  for (std::size_t m = 0; m < members_.size(); ++m) {
    for (const PairMemory& touching : memory) {
      const auto [a, b] = std::pair(touching.identity.body_a, touching.identity.body_b);
      if (a != members_[m].index && b != members_[m].index) continue;
      ++records[m].contacts;
      records[m].max_penetration = std::max(records[m].max_penetration, -touching.distance);
    }
    members_[m].body->add_wall_seconds(seconds / static_cast<double>(members_.size()));
  }
  parallel_for(members_.size(),
               [&](std::size_t m) { members_[m].body->finish_record(step, colliders, records[m]); });
  note_step_time(processor_seconds() - processor_begin);
  return records;
}

// None until enough steps tell how long one takes.
double Island::step_deadline() const {
  if (step_seconds_.size() < kFewestTimedSteps) return INFINITY;
  std::vector<double> sorted = step_seconds_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return processor_seconds() + std::max(kTimeLimit * *middle, kLeastTimeLimit);
}

void Island::note_step_time(double seconds) {
  if (step_seconds_.size() == kTimedSteps) step_seconds_.erase(step_seconds_.begin());
  step_seconds_.push_back(seconds);
}

}  // namespace vivify::sim

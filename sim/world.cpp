#include "sim/world.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/parallel.h"
#include "sim/frame_report.h"
#include "sim/start_check.h"

namespace vivify::sim {
namespace {

constexpr int kTouchingColumns = 25;

Eigen::RowVectorXd row_of(const PairMemory& memory) {
  Eigen::RowVectorXd row(kTouchingColumns);
  const PairIdentity& id = memory.identity;
  row << id.body_a, id.body_b, id.kind, id.feature_a, id.feature_b, memory.a.points[0], memory.a.points[1],
      memory.a.points[2], memory.a.weights[0], memory.a.weights[1], memory.a.weights[2], memory.b.points[0],
      memory.b.points[1], memory.b.points[2], memory.b.weights[0], memory.b.weights[1], memory.b.weights[2],
      memory.offset.transpose(), memory.normal.transpose(), memory.normal_force, memory.distance;
  return row;
}

PairMemory memory_of(const Eigen::RowVectorXd& row) {
  const auto integer = [&](int i) { return static_cast<int>(row[i]); };
  return {{integer(0), integer(1), integer(2), integer(3), integer(4)},
          {{integer(5), integer(6), integer(7)}, {row[8], row[9], row[10]}},
          {{integer(11), integer(12), integer(13)}, {row[14], row[15], row[16]}},
          row.segment<3>(17).transpose(),
          row.segment<3>(20).transpose(),
          row[23],
          row[24]};
}

}  // namespace

World::World(const std::vector<BodyInput>& bodies, std::vector<Collider> colliders,
             const WorldSettings& settings)
    : settings_(settings), colliders_(std::move(colliders)) {
  for (const BodyInput& input : bodies) bodies_.push_back(std::make_unique<Body>(input, settings_));
  admit();
}

void World::list_members() {
  members_.clear();
  for (int b = 0; b < body_count(); ++b) {
    if (present(b)) members_.push_back({b, bodies_[b].get()});
  }
}

void World::admit() {
  const std::size_t before = members_.size();
  list_members();
  if (members_.size() == before || settings_.statics) return;
  check_start(members_, colliders_, steps_, time());
  near_.reset();
}

std::vector<BodyPairs> World::find_near() {
  if (bodies_.size() == 1 && !bodies_[0]->model().contact.self) return {};
  parallel_for(members_.size(),
               [&](std::size_t m) { members_[m].body->move_surface(members_[m].body->x()); });
  std::vector<Eigen::VectorXd> moves;
  for (const Member& member : members_) moves.push_back(settings_.h * member.body->v());
  return near_bodies(members_, moves, true);
}

std::vector<Body::Wish> World::wishes() {
  std::vector<double> loads(bodies_.size(), 0);  // by other bodies, upwards, N
  for (const PairMemory& touching : touching_) {
    const auto [a, b] = std::pair(touching.identity.body_a, touching.identity.body_b);
    if (a == b) continue;
    const double lift = touching.normal_force * touching.normal.y();  // of b on a
    loads[lift > 0 ? a : b] += std::abs(lift);
  }
  std::vector<OtherBody> seen;
  for (const Member& member : members_) seen.push_back(member.body->seen());
  std::vector<Body::Wish> wishes(bodies_.size());
  const double end = time(), begin = end - settings_.h;
  parallel_for(members_.size(), [&](std::size_t m) {
    const auto [b, body] = members_[m];
    Ground ground = ground_under(body->state().contacts, colliders_, begin, end);
    ground.load += loads[b];
    wishes[b] = body->wish(steps_, ground, seen);
  });
  return wishes;
}

std::vector<std::vector<int>> World::groups_of(const Links& links) const {
  std::vector<int> first(bodies_.size());  // of the island that a body is in
  std::iota(first.begin(), first.end(), 0);
  const auto root = [&](int b) {
    while (first[b] != b) b = first[b];
    return b;
  };
  for (const auto& [a, b] : links) {
    const auto [low, high] = std::minmax({root(a), root(b)});
    first[high] = low;
  }
  std::map<int, std::vector<int>> groups;
  for (const Member& member : members_) groups[root(member.index)].push_back(member.index);
  std::vector<std::vector<int>> list;
  for (auto& [low, group] : groups) list.push_back(std::move(group));
  return list;
}

World::IslandStep World::solve(const std::vector<int>& group, const std::vector<Body::Wish>& wishes,
                               const std::vector<BodyPairs>& near) {
  const auto in_group = [&](int b) { return std::binary_search(group.begin(), group.end(), b); };
  std::vector<Body::Wish> own_wishes;
  for (const int b : group) own_wishes.push_back(wishes[b]);
  std::vector<BodyPairs> own_near;
  std::copy_if(near.begin(), near.end(), std::back_inserter(own_near),
               [&](const BodyPairs& between) { return in_group(between.a) && in_group(between.b); });
  IslandStep result;
  std::copy_if(touching_.begin(), touching_.end(), std::back_inserter(result.touching),
               [&](const PairMemory& memory) {
                 return in_group(memory.identity.body_a) && in_group(memory.identity.body_b);
               });
  result.records = islands_.at(group)->step(steps_, colliders_, own_wishes, own_near, result.touching);
  return result;
}

World::Meetings World::met(const std::vector<Body::State>& before, const std::vector<BodyPairs>& near_after) {
  std::vector<int> island(bodies_.size());
  for (std::size_t i = 0; i < grouping_.size(); ++i) {
    for (const int b : grouping_[i]) island[b] = static_cast<int>(i);
  }
  const auto apart = [&](int a, int b) { return island[a] != island[b]; };
  Meetings meetings;
  Links& links = meetings.links;
  for (const BodyPairs& between : near_after) {
    if (!apart(between.a, between.b)) continue;
    const BodyModel &a = bodies_[between.a]->model(), &b = bodies_[between.b]->model();
    const double layer = std::max(a.contact.layer, b.contact.layer) + a.surface.radius + b.surface.radius;
    if (std::any_of(between.pairs.begin(), between.pairs.end(),
                    [&](const SurfacePair& pair) { return pair.distance < layer; }))
      links.emplace_back(between.a, between.b);
  }
  if (links.empty() && !has_thin(members_)) return meetings;

  std::vector<Eigen::VectorXd> moves;
  for (const auto& [b, body] : members_) {
    moves.push_back(body->x() - before[b].x);
    body->move_surface(before[b].x);
  }
  const Links crossing = crossing_bodies(members_, moves, apart);
  links.insert(links.end(), crossing.begin(), crossing.end());
  if (links.empty()) return meetings;
  meetings.near = near_bodies(members_, moves, true);
  std::erase_if(meetings.near, [&](const BodyPairs& between) {
    return std::find(links.begin(), links.end(), std::pair(between.a, between.b)) == links.end();
  });
  return meetings;
}

void World::step() {
  ++steps_;
  const std::vector<Body::Wish> wanted = wishes();
  std::vector<Body::State> before;
  for (const auto& body : bodies_) before.push_back(body->state());
  std::vector<BodyPairs> near = settings_.statics ? std::vector<BodyPairs>() : near_ ? *near_ : find_near();
  Links links;
  for (const BodyPairs& between : near) links.emplace_back(between.a, between.b);

  std::map<std::vector<int>, IslandStep> solved;
  for (;;) {
    grouping_ = groups_of(links);
    const auto is_current = [&](const std::vector<int>& group) {
      return std::binary_search(grouping_.begin(), grouping_.end(), group);
    };
    std::erase_if(solved, [&](const auto& entry) { return !is_current(entry.first); });
    std::erase_if(islands_,
                  [&](const auto& entry) { return entry.first.size() > 1 && !is_current(entry.first); });
    std::vector<const std::vector<int>*> open;
    for (const std::vector<int>& group : grouping_) {
      if (solved.contains(group)) continue;
      open.push_back(&group);
      for (const int b : group) bodies_[b]->state() = before[b];
      if (islands_.contains(group)) continue;
      std::vector<Member> members;
      for (const int b : group) members.push_back({b, bodies_[b].get()});
      islands_.emplace(group, std::make_unique<Island>(std::move(members), settings_));
    }
    std::vector<IslandStep> results(open.size());
    parallel_for(open.size(), [&](std::size_t i) { results[i] = solve(*open[i], wanted, near); });
    for (std::size_t i = 0; i < open.size(); ++i) solved[*open[i]] = std::move(results[i]);

    if (settings_.statics) break;
    near_ = find_near();
    if (grouping_.size() == 1) break;
    Meetings meetings = met(before, *near_);
    if (meetings.links.empty()) break;
    links.insert(links.end(), meetings.links.begin(), meetings.links.end());
    std::move(meetings.near.begin(), meetings.near.end(), std::back_inserter(near));
    std::sort(near.begin(), near.end(), [](const BodyPairs& a, const BodyPairs& b) {
      return std::pair(a.a, a.b) < std::pair(b.a, b.b);
    });
  }

  touching_.clear();
  std::map<int, StepRecord> in_order;
  for (auto& [group, result] : solved) {
    touching_.insert(touching_.end(), result.touching.begin(), result.touching.end());
    for (std::size_t m = 0; m < group.size(); ++m) in_order[group[m]] = std::move(result.records[m]);
  }
  std::sort(touching_.begin(), touching_.end(),
            [](const PairMemory& a, const PairMemory& b) { return a.identity < b.identity; });
  for (auto& [b, record] : in_order) records_.push_back(std::move(record));
  admit();
}

void World::save(Hdf5Writer& file) {
  file.put_attribute("schema_version", 1);
  file.put("/t", time());
  file.put("/step", static_cast<std::int64_t>(steps_));
  std::string lines;
  for (const StepRecord& record : records_) lines += csv_line(record);
  file.put("/steps", lines);
  records_.clear();
  for (const auto& [b, body] : members_) body->save(file, "/bodies/" + body->model().name);
  if (touching_.empty()) return;
  RowMatrixXd rows(static_cast<Eigen::Index>(touching_.size()), kTouchingColumns);
  for (std::size_t i = 0; i < touching_.size(); ++i)
    rows.row(static_cast<Eigen::Index>(i)) = row_of(touching_[i]);
  file.put("/touching", rows);
  put_contacts(file, "/contacts", {"body_a", "body_b"}, contact_forces(touching_, bodies_));
}

void World::restore(const Hdf5Reader& file) {
  steps_ = static_cast<long>(file.integer("/step"));
  records_.clear();
  touching_.clear();
  near_.reset();
  list_members();
  for (const auto& [b, body] : members_) body->restore(file, "/bodies/" + body->model().name);
  if (!file.has("/touching")) return;
  const RowMatrixXd rows = file.matrix("/touching");
  for (Eigen::Index i = 0; i < rows.rows(); ++i) touching_.push_back(memory_of(rows.row(i)));
}

}  // namespace vivify::sim

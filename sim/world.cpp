#include "sim/world.h"

#include <algorithm>
#include <numeric>

#include "common/error.h"
#include "common/parallel.h"
#include "common/text.h"

namespace vivify::sim {
namespace {

constexpr double kResolvedDepth = 0.02;  // of the smaller body
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
  if (!settings_.statics) require_apart();
}

// Contact pushes bodies apart that start a little inside each other; deeper ones would burst apart.
void World::require_apart() {
  for (const BodyPairs& between : near_bodies()) {
    if (between.a == between.b) continue;
    const BodyModel &a = bodies_[between.a]->model(), &b = bodies_[between.b]->model();
    double depth = 0;
    for (const SurfacePair& pair : between.pairs)
      depth = std::max(depth, a.surface.radius + b.surface.radius - pair.distance);
    if (depth <= kResolvedDepth * std::min(a.height, b.height)) continue;
    throw Error(ErrorKind::geometry,
                "bodies '" + a.name + "' and '" + b.name + "' start " + number_text(depth) +
                    " m inside each other; contact resolves at most " +
                    number_text(kResolvedDepth * std::min(a.height, b.height)) + " m",
                "move one of them away by that much");
  }
}

// Where bodies are near one another, in the order of the bodies.
std::vector<BodyPairs> World::near_bodies() {
  if (bodies_.size() == 1 && !bodies_[0]->model().contact.self) return {};
  std::vector<BoundingBox> boxes(bodies_.size());
  parallel_for(bodies_.size(), [&](std::size_t b) {
    Body& body = *bodies_[b];
    body.move_surface(body.x());
    boxes[b] = body.surface().box();
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(pair_reach(body, settings_.h));
    boxes[b].extend(boxes[b].max() + reach).extend(boxes[b].min() - reach);
  });
  std::vector<std::pair<int, int>> candidates;
  for (const auto& [a, b] : near_boxes(boxes, 0)) {
    if (bodies_[a]->model().dimension() == bodies_[b]->model().dimension()) candidates.emplace_back(a, b);
  }
  for (int b = 0; b < body_count(); ++b) {
    if (bodies_[b]->model().contact.self) candidates.emplace_back(b, b);
  }
  std::vector<BodyPairs> pairs(candidates.size());
  parallel_for(candidates.size(), [&](std::size_t i) {
    const auto [a, b] = candidates[i];
    pairs[i] = near_places({a, bodies_[a].get()}, {b, bodies_[b].get()}, settings_.h);
  });
  std::erase_if(pairs, [](const BodyPairs& between) { return between.pairs.empty(); });
  std::sort(pairs.begin(), pairs.end(),
            [](const BodyPairs& a, const BodyPairs& b) { return std::pair(a.a, a.b) < std::pair(b.a, b.b); });
  return pairs;
}

void World::group(const std::vector<BodyPairs>& pairs) {
  std::vector<int> first(bodies_.size());  // of the island that a body is in
  std::iota(first.begin(), first.end(), 0);
  const auto root = [&](int b) {
    while (first[b] != b) b = first[b];
    return b;
  };
  for (const BodyPairs& between : pairs) {
    const auto [low, high] = std::minmax({root(between.a), root(between.b)});
    first[high] = low;
  }
  std::map<int, std::vector<int>> groups;
  for (int b = 0; b < body_count(); ++b) groups[root(b)].push_back(b);
  grouping_.clear();
  for (auto& [low, group] : groups) grouping_.push_back(std::move(group));

  std::erase_if(islands_, [&](const auto& island) {
    return island.first.size() > 1 &&
           std::find(grouping_.begin(), grouping_.end(), island.first) == grouping_.end();
  });
  for (const std::vector<int>& group : grouping_) {
    if (islands_.contains(group)) continue;
    std::vector<Member> members;
    for (const int b : group) members.push_back({b, bodies_[b].get()});
    islands_.emplace(group, std::make_unique<Island>(std::move(members), settings_));
  }
}

void World::step() {
  ++steps_;
  const std::vector<BodyPairs> pairs = settings_.statics ? std::vector<BodyPairs>() : near_bodies();
  group(pairs);

  std::vector<std::vector<StepRecord>> records(grouping_.size());
  std::vector<std::vector<PairMemory>> touching(grouping_.size());
  parallel_for(grouping_.size(), [&](std::size_t i) {
    const std::vector<int>& group = grouping_[i];
    const auto in_group = [&](int b) { return std::binary_search(group.begin(), group.end(), b); };
    std::vector<BodyPairs> own;
    std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(own),
                 [&](const BodyPairs& between) { return in_group(between.a); });
    std::copy_if(touching_.begin(), touching_.end(), std::back_inserter(touching[i]),
                 [&](const PairMemory& memory) {
                   return in_group(memory.identity.body_a) && in_group(memory.identity.body_b);
                 });
    records[i] = islands_.at(group)->step(steps_, colliders_, own, touching[i]);
  });

  touching_.clear();
  std::vector<StepRecord> in_order(bodies_.size());
  for (std::size_t i = 0; i < grouping_.size(); ++i) {
    touching_.insert(touching_.end(), touching[i].begin(), touching[i].end());
    for (std::size_t m = 0; m < grouping_[i].size(); ++m)
      in_order[static_cast<std::size_t>(grouping_[i][m])] = std::move(records[i][m]);
  }
  std::sort(touching_.begin(), touching_.end(),
            [](const PairMemory& a, const PairMemory& b) { return a.identity < b.identity; });
  std::move(in_order.begin(), in_order.end(), std::back_inserter(records_));
}

void World::save(Hdf5Writer& file) {
  file.put_attribute("schema_version", 1);
  file.put("/t", time());
  file.put("/step", static_cast<std::int64_t>(steps_));
  std::string lines;
  for (const StepRecord& record : records_) lines += csv_line(record);
  file.put("/steps", lines);
  records_.clear();
  for (const auto& body : bodies_) body->save(file, "/bodies/" + body->model().name);
  if (touching_.empty()) return;
  RowMatrixXd rows(static_cast<Eigen::Index>(touching_.size()), kTouchingColumns);
  for (std::size_t i = 0; i < touching_.size(); ++i)
    rows.row(static_cast<Eigen::Index>(i)) = row_of(touching_[i]);
  file.put("/touching", rows);
}

void World::restore(const Hdf5Reader& file) {
  steps_ = static_cast<long>(file.integer("/step"));
  records_.clear();
  touching_.clear();
  for (const auto& body : bodies_) body->restore(file, "/bodies/" + body->model().name);
  if (!file.has("/touching")) return;
  const RowMatrixXd rows = file.matrix("/touching");
  for (Eigen::Index i = 0; i < rows.rows(); ++i) touching_.push_back(memory_of(rows.row(i)));
}

}  // namespace vivify::sim

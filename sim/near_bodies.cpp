#include "sim/near_bodies.h"

#include <algorithm>

#include "common/parallel.h"
#include "sim/contact/passing.h"
#include "sim/contact/step_bound.h"
#include "sim/control/rigid_motion.h"

namespace vivify::sim {
namespace {

constexpr double kMargin = 0.01;  // of the height of a body: how much farther than its move it is looked for
constexpr double kFast = 4;       // contact layers: places that close by less in a step never look like walls
constexpr double kApart = 0.2;    // contact layers: places that are nearer at the end of a move are met
constexpr double kCrossing = 1e-3;  // of their distance before: features that get so near would cross

// How a body moves in a step: its mean move, and how much farther than that one of its vertices moves (m).
struct Drift {
  Eigen::Vector3d mean;
  double spread;
};

// Length of the longest of the vectors of d coordinates that `x` is made of, less `from`.
double longest(const Eigen::VectorXd& x, int d, const Eigen::Vector3d& from = Eigen::Vector3d::Zero()) {
  double length = 0;
  for (Eigen::Index i = 0; i < x.size(); i += d)
    length = std::max(length, (x.segment(i, d) - from.head(d)).norm());
  return length;
}

Drift drift_of(const Body& body, const Eigen::VectorXd& moves) {
  const Eigen::Vector3d mean = centre_of_mass(body.model().mass, moves);
  return {mean, longest(moves, body.model().dimension(), mean)};
}

// How far from its surface a body touches, with a margin.
double touch_reach(const BodyModel& model) {
  return model.surface.radius + model.contact.layer + kMargin * model.height;
}

bool may_meet(const Body& a, const Body& b) {
  if (&a == &b) return a.model().contact.self;
  return a.model().dimension() == b.model().dimension();
}

// Pairs (i <= j) of places in the list of bodies whose boxes meet; with themselves where they have
// self-contact.
std::vector<std::pair<int, int>> candidates(const std::vector<Member>& members,
                                            const std::vector<BoundingBox>& boxes) {
  std::vector<std::pair<int, int>> pairs = near_boxes(boxes, 0);
  for (int m = 0; m < static_cast<int>(members.size()); ++m) pairs.emplace_back(m, m);
  std::erase_if(pairs, [&](const auto& pair) {
    return !may_meet(*members[pair.first].body, *members[pair.second].body);
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

// How the pair's place on a moves as seen from that on b, when their bodies move by `a` and `b`.
Eigen::Vector3d relative_move(const SurfacePair& pair, const ContactPoints& points_a,
                              const Eigen::VectorXd& a, const ContactPoints& points_b,
                              const Eigen::VectorXd& b) {
  Eigen::Vector3d move = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    if (pair.a[k] >= 0) move += pair.weight_a[k] * points_a.position(pair.a[k], a);
    if (pair.b[k] >= 0) move -= pair.weight_b[k] * points_b.position(pair.b[k], b);
  }
  return move;
}

// Puts right the pairs of members m and n that the bodies pass by. `beside`: of each member, those near it.
void pass_by(const std::vector<Member>& members, const std::vector<Eigen::VectorXd>& moves, bool ahead, int m,
             int n, const std::vector<std::vector<int>>& beside, std::vector<SurfacePair>& pairs) {
  const SurfaceState &a = members[m].body->surface(), &b = members[n].body->surface();
  const double layer =
      std::max(members[m].body->model().contact.layer, members[n].body->model().contact.layer);
  const auto covered = [&](int body, int other, const Eigen::Vector3d& y, const Eigen::Vector3d& normal) {
    return std::any_of(beside[body].begin(), beside[body].end(), [&](int cover) {
      return cover != other && is_covered(y, normal, members[body].body->surface(),
                                          members[cover].body->surface(), kFast * layer);
    });
  };
  std::erase_if(pairs, [&](SurfacePair& pair) {
    const Eigen::Vector3d move =
        relative_move(pair, a.surface().points, moves[m], b.surface().points, moves[n]);
    const auto closes = [&] { return pair.normal.dot(move) < -kFast * layer; };
    if (ahead && closes()) follow_passing(pair, a, b, move, kApart * layer);
    return closes() && (covered(m, n, place_of(a, pair.a, pair.weight_a), -pair.normal) ||
                        covered(n, m, place_of(b, pair.b, pair.weight_b), pair.normal));
  });
}

}  // namespace

std::vector<BodyPairs> near_bodies(const std::vector<Member>& members,
                                   const std::vector<Eigen::VectorXd>& moves, bool ahead) {
  std::vector<Drift> drifts;
  Eigen::Vector3d common = Eigen::Vector3d::Zero();
  for (std::size_t m = 0; m < members.size(); ++m) {
    drifts.push_back(drift_of(*members[m].body, moves[m]));
    common += drifts.back().mean / static_cast<double>(members.size());
  }
  std::vector<BoundingBox> boxes;
  for (std::size_t m = 0; m < members.size(); ++m) {
    BoundingBox box = members[m].body->surface().box();
    const double reach =
        touch_reach(members[m].body->model()) + (drifts[m].mean - common).norm() + drifts[m].spread;
    boxes.emplace_back(box.min().array() - reach, box.max().array() + reach);
  }
  const std::vector<std::pair<int, int>> near = candidates(members, boxes);
  std::vector<std::vector<int>> beside(members.size());
  for (const auto& [m, n] : near) {
    if (m == n) continue;
    beside[m].push_back(n);
    beside[n].push_back(m);
  }
  std::vector<BodyPairs> pairs(near.size());
  parallel_for(near.size(), [&](std::size_t i) {
    const auto [m, n] = near[i];
    const Body &a = *members[m].body, &b = *members[n].body;
    const double closing = (drifts[m].mean - drifts[n].mean).norm() + drifts[m].spread + drifts[n].spread;
    const double reach = touch_reach(a.model()) + touch_reach(b.model()) + closing;
    pairs[i] = {members[m].index, members[n].index, {}};
    if (m == n) {
      pairs[i].pairs = near_self_pairs(a.surface(), reach);
    } else if (boxes_near(a.surface(), b.surface(), reach)) {
      pairs[i].pairs = near_pairs(a.surface(), b.surface(), reach);
      pass_by(members, moves, ahead, m, n, beside, pairs[i].pairs);
    }
  });
  std::erase_if(pairs, [](const BodyPairs& between) { return between.pairs.empty(); });
  return pairs;
}

bool has_thin(const std::vector<Member>& members) {
  return std::any_of(members.begin(), members.end(),
                     [](const Member& member) { return member.body->model().surface.two_sided; });
}

std::vector<std::pair<int, int>> crossing_bodies(const std::vector<Member>& members,
                                                 const std::vector<Eigen::VectorXd>& moves,
                                                 const std::function<bool(int, int)>& wanted) {
  const auto thin = [&](int m) { return members[m].body->model().surface.two_sided; };
  std::vector<std::pair<int, int>> crossing;
  std::vector<BoundingBox> boxes;
  for (std::size_t m = 0; m < members.size(); ++m) {
    const BoundingBox box = members[m].body->surface().box();
    const double way = longest(moves[m], members[m].body->model().dimension());
    boxes.emplace_back(box.min().array() - way, box.max().array() + way);
  }
  for (const auto& [m, n] : candidates(members, boxes)) {
    if (!(thin(m) || thin(n)) || !wanted(members[m].index, members[n].index)) continue;
    const SurfaceState &a = members[m].body->surface(), &b = members[n].body->surface();
    const double bound =
        m == n ? self_step_bound(a, moves[m], kCrossing) : step_bound(a, moves[m], b, moves[n], kCrossing);
    if (bound < 1) crossing.emplace_back(members[m].index, members[n].index);
  }
  return crossing;
}

}  // namespace vivify::sim

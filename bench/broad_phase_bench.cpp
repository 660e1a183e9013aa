// Near features of many surfaces: the kept trees of boxes beside brute force and beside CGAL's AABB tree,
// which is rebuilt when its triangles move.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/bodies.h"
#include "bench/timing.h"
#include "common/rng.h"
#include "sim/contact/closest_points.h"
#include "sim/contact/surface_pairs.h"

namespace {

using namespace vivify;
using namespace vivify::bench;
using namespace vivify::sim;

using Kernel = CGAL::Simple_cartesian<double>;
using Triangle = Kernel::Triangle_3;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, std::vector<Triangle>::const_iterator>;
using CgalTree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

struct Pile {
  std::string name;
  double reach;
  std::vector<ContactSurface> surfaces;
  std::vector<Eigen::VectorXd> x;
  std::vector<SurfaceState> states;
  std::vector<std::vector<Triangle>> triangles;  // of the surfaces, for CGAL

  void add(const SimMesh& mesh, const Eigen::Vector3d& shift) {
    surfaces.push_back(boundary_of(mesh));
    const RowMatrixXd V = mesh.V.rowwise() + shift.transpose();
    x.emplace_back(V.reshaped<Eigen::RowMajor>());
  }
  void move() {
    for (std::size_t i = 0; i < states.size(); ++i) states[i].move_to(x[i]);
  }
  void start() {
    for (const ContactSurface& surface : surfaces) states.emplace_back(surface);
    move();
    triangles.resize(states.size());
    for (std::size_t i = 0; i < states.size(); ++i) {
      for (Eigen::Index f = 0; f < surfaces[i].faces.rows(); ++f) {
        const auto corner = [&](int k) {
          const Eigen::Vector3d p = states[i].point(surfaces[i].faces(f, k));
          return Kernel::Point_3(p.x(), p.y(), p.z());
        };
        triangles[i].emplace_back(corner(0), corner(1), corner(2));
      }
    }
  }
};

// Balls of radius 1 in a dense pile: neighbours overlap a little or just miss each other.
Pile pile_of_balls() {
  Pile pile{"50 balls of 162 points, 320 faces", 0.02, {}, {}, {}, {}};
  const SimMesh mesh = ball(1, 2, 2);
  CounterRng rng(1);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d jitter(rng.uniform(-0.03, 0.03), rng.uniform(-0.03, 0.03),
                                 rng.uniform(-0.03, 0.03));
    pile.add(mesh, 1.98 * Eigen::Vector3d(i % 4, i / 16, i / 4 % 4) + jitter);
  }
  pile.start();
  return pile;
}

Pile two_large_balls() {
  Pile pile{"2 balls of 2562 points, 5120 faces", 0.01, {}, {}, {}, {}};
  const SimMesh mesh = ball(1, 1, 4);
  pile.add(mesh, Eigen::Vector3d::Zero());
  pile.add(mesh, {1.96, 0.1, 0.2});
  pile.start();
  return pile;
}

std::vector<std::pair<int, int>> candidates(const Pile& pile) {
  std::vector<BoundingBox> boxes;
  for (const SurfaceState& state : pile.states) boxes.push_back(state.box());
  return near_boxes(boxes, pile.reach);
}

// Calls work(body, point) for the points of each body within reach of the box of another.
template <class Work>
void for_each_query(const Pile& pile, const Work& work) {
  for (const auto& [i, j] : candidates(pile)) {
    for (const auto& [a, b] : {std::pair(i, j), std::pair(j, i)}) {
      const BoundingBox box = pile.states[b].box();
      for (int p = 0; p < pile.states[a].points().rows(); ++p) {
        const Eigen::Vector3d y = pile.states[a].point(p);
        if (box.squaredExteriorDistance(y) <= pile.reach * pile.reach) work(b, y);
      }
    }
  }
}

double nearest_by_brute_force(const SurfaceState& state, const Eigen::Vector3d& y) {
  double least2 = INFINITY;
  const RowMatrixXi& F = state.surface().faces;
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    const TrianglePlace place =
        nearest_on_triangle(y, state.point(F(f, 0)), state.point(F(f, 1)), state.point(F(f, 2)));
    least2 = std::min(least2, (place.position - y).squaredNorm());
  }
  return std::sqrt(least2);
}

// Pairs of edges nearer than the reach, all tried.
long edges_by_brute_force(const Pile& pile) {
  long near = 0;
  for (std::size_t i = 0; i < pile.states.size(); ++i) {
    for (std::size_t j = i + 1; j < pile.states.size(); ++j) {
      const SurfaceState &a = pile.states[i], &b = pile.states[j];
      const RowMatrixXi &E = a.surface().edges, &G = b.surface().edges;
      for (Eigen::Index e = 0; e < E.rows(); ++e) {
        for (Eigen::Index g = 0; g < G.rows(); ++g) {
          near += nearest_on_segments(a.point(E(e, 0)), a.point(E(e, 1)), b.point(G(g, 0)), b.point(G(g, 1)))
                      .offset.squaredNorm() <= pile.reach * pile.reach;
        }
      }
    }
  }
  return near;
}

double median_seconds(int repetitions, const std::function<void()>& work) {
  std::vector<double> times;
  for (int k = 0; k < repetitions; ++k) times.push_back(seconds_of(work));
  return median(times);
}

void run(Pile pile) {
  std::printf("%s, reach %g m\n", pile.name.c_str(), pile.reach);
  constexpr int kOften = 15;
  const double refit = median_seconds(kOften, [&] { pile.move(); });
  const double rebuild = median_seconds(kOften, [&] {
    for (const SurfaceState& state : pile.states) {
      const BoxTree faces(state.surface().faces, state.points()),
          edges(state.surface().edges, state.points());
    }
  });
  std::size_t bodies = 0, found = 0;
  const double sweep = median_seconds(kOften, [&] { bodies = candidates(pile).size(); });
  const double pairs = median_seconds(kOften, [&] {
    found = 0;
    for (const auto& [i, j] : candidates(pile)) {
      found += near_pairs(pile.states[i], pile.states[j], pile.reach).size();
    }
  });
  std::printf(
      "  ours: refit of all trees %.3f ms (a rebuild: %.3f), sweep over boxes %.4f ms (%zu pairs of "
      "bodies),\n"
      "        all near features %.3f ms (%zu)\n",
      1e3 * refit, 1e3 * rebuild, 1e3 * sweep, bodies, 1e3 * pairs, found);

  // The nearest places of the same points.
  long queries = 0;
  double sum_ours = 0, sum_brute = 0, sum_cgal = 0;
  const double ours = median_seconds(kOften, [&] {
    queries = 0;
    sum_ours = 0;
    for_each_query(pile, [&](int b, const Eigen::Vector3d& y) {
      ++queries;
      sum_ours += std::abs(pile.states[b].nearest(y, INFINITY)->distance);
    });
  });
  const double brute = median_seconds(3, [&] {
    sum_brute = 0;
    for_each_query(pile, [&](int b, const Eigen::Vector3d& y) {
      sum_brute += nearest_by_brute_force(pile.states[b], y);
    });
  });
  std::vector<std::unique_ptr<CgalTree>> trees(pile.states.size());
  const auto build = [&](bool accelerate) {
    for (std::size_t i = 0; i < trees.size(); ++i) {
      trees[i] = std::make_unique<CgalTree>(pile.triangles[i].begin(), pile.triangles[i].end());
      if (!accelerate) trees[i]->do_not_accelerate_distance_queries();
      trees[i]->build();
      if (accelerate) trees[i]->accelerate_distance_queries();
    }
  };
  const auto query = [&] {
    sum_cgal = 0;
    for_each_query(pile, [&](int b, const Eigen::Vector3d& y) {
      sum_cgal += std::sqrt(trees[b]->squared_distance(Kernel::Point_3(y.x(), y.y(), y.z())));
    });
  };
  std::printf("  nearest places of %ld points: ours %.3f ms, brute force %.3f ms (%.1f x)\n", queries,
              1e3 * ours, 1e3 * brute, brute / ours);
  for (const bool accelerate : {true, false}) {
    const double cgal_build = median_seconds(kOften, [&] { build(accelerate); });
    const double cgal_query = median_seconds(kOften, query);
    std::printf("        CGAL%s: rebuild %.3f ms (%.1f x our refit), queries %.3f ms (%.2f x), both %.1f x\n",
                accelerate ? ", accelerated" : "", 1e3 * cgal_build, cgal_build / refit, 1e3 * cgal_query,
                cgal_query / ours, (cgal_build + cgal_query) / (refit + ours));
  }
  std::printf("        sums of the distances agree to %.1e (brute force), %.1e (CGAL)\n",
              std::abs(sum_brute / sum_ours - 1), std::abs(sum_cgal / sum_ours - 1));

  // Everything by brute force: each point with each face, each edge with each edge, of all pairs of bodies.
  const double all_points = seconds_of([&] {
    double sum = 0;
    for (std::size_t i = 0; i < pile.states.size(); ++i) {
      for (std::size_t j = 0; j < pile.states.size(); ++j) {
        if (i == j) continue;
        for (int p = 0; p < pile.states[i].points().rows(); ++p) {
          sum += nearest_by_brute_force(pile.states[j], pile.states[i].point(p));
        }
      }
    }
    if (!(sum > 0)) std::printf("nothing is apart\n");
  });
  long near_edges = 0;
  const double all_edges = seconds_of([&] { near_edges = edges_by_brute_force(pile); });
  std::printf(
      "  all features by brute force: %.0f ms, %.0f x ours with the refit (%ld pairs of edges in reach)\n",
      1e3 * (all_points + all_edges), (all_points + all_edges) / (refit + pairs), near_edges);
}

}  // namespace

int main() {
  run(pile_of_balls());
  run(two_large_balls());
}

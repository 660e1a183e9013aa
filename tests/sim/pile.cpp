#include "tests/sim/pile.h"

#include <cmath>
#include <numbers>

#include "bench/bodies.h"
#include "sim/control/rigid_motion.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

constexpr double kBowlRadius = 0.45, kBowlDepth = 0.35;

// A bowl of revolution, open to the top: height over the distance from the axis.
double bowl_height(double r) { return kBowlDepth * (r / kBowlRadius) * (r / kBowlRadius); }

Collider bowl() {
  const int rings = 24, sectors = 48;
  TriangleMesh mesh;
  mesh.V.resize(1 + rings * sectors, 3);
  mesh.V.row(0).setZero();
  for (int ring = 0; ring < rings; ++ring) {
    const double r = 1.6 * kBowlRadius * (ring + 1) / rings;
    for (int s = 0; s < sectors; ++s) {
      const double angle = 2 * std::numbers::pi * s / sectors;
      mesh.V.row(1 + ring * sectors + s) << r * std::cos(angle), bowl_height(r), r * std::sin(angle);
    }
  }
  std::vector<std::array<int, 3>> faces;
  for (int s = 0; s < sectors; ++s) {
    const int next = (s + 1) % sectors;
    faces.push_back({0, 1 + next, 1 + s});
    for (int ring = 0; ring + 1 < rings; ++ring) {
      const int a = 1 + ring * sectors + s, b = 1 + ring * sectors + next;
      faces.push_back({a, b, a + sectors});
      faces.push_back({b, b + sectors, a + sectors});
    }
  }
  mesh.F.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (int k = 0; k < 3; ++k) mesh.F(static_cast<Eigen::Index>(f), k) = faces[f][k];
  return Collider("bowl", std::move(mesh), 0.5);
}

BodyInput sphere(int i) {
  SimMesh mesh = bench::ball(kPileRadius, 1, 1);
  // Layers of five by five, every other one shifted by half a distance.
  const int layer = i / 16, place = i % 16;
  const double step = 2.3 * kPileRadius, shift = layer % 2 == 0 ? 0 : 0.5 * step;
  const Eigen::RowVector3d middle = 0.5 * (mesh.V.colwise().minCoeff() + mesh.V.colwise().maxCoeff());
  mesh.V.rowwise() += Eigen::RowVector3d((place % 4 - 1.5) * step + shift, 0.42 + layer * step,
                                         (place / 4 - 1.5) * step + 0.3 * shift) -
                      middle;
  return bench::body_input(
      "sphere" + std::to_string(i), std::move(mesh),
      "{type: solid3d, density: 300, stiffness: 40000, volume_stiffness: 40000, damping_s: 0.005}",
      "{type: rest}");
}

// Above the spheres.
BodyInput sheet(int i, int spheres) {
  SimMesh mesh = bench::card(4, 5, 0.03);
  const Eigen::RowVector3d middle = 0.5 * (mesh.V.colwise().minCoeff() + mesh.V.colwise().maxCoeff());
  mesh.V.rowwise() +=
      Eigen::RowVector3d(0.05 * (i % 3 - 1), 0.55 + 2.3 * kPileRadius * ((spheres + 15) / 16) + 0.05 * i,
                         0.04 * (i % 2)) -
      middle;
  return bench::body_input("card" + std::to_string(i), std::move(mesh),
                           "{type: shell3d, density: 1, stiffness: 3000, bending_stiffness: 0.02, thickness: "
                           "0.004, damping_s: 0.005}",
                           "{type: rest}");
}

}  // namespace

World pile_world(const Pile& pile, double h) {
  std::vector<BodyInput> bodies;
  for (int i = 0; i < pile.spheres; ++i) bodies.push_back(sphere(i));
  for (int i = 0; i < pile.cards; ++i) bodies.push_back(sheet(i, pile.spheres));
  for (BodyInput& body : bodies) body.velocity = {0, -pile.speed, 0};
  return World(bodies, one(bowl()), {{0, -9.81, 0}, h});
}

PileResult settle_pile(const Pile& pile) {
  const double h = 0.01;
  World world = pile_world(pile, h);
  PileResult result;
  const int steps = static_cast<int>(pile.seconds / h);
  for (int step = 0; step < steps; ++step) {
    world.step();
    const bool last = step >= 0.9 * steps;
    for (auto record = world.records().end() - world.body_count(); record != world.records().end();
         ++record) {
      result.residual = std::max(result.residual, record->residual_rel);
      result.deepest = std::max(result.deepest, record->max_penetration);
      if (last) {
        result.deepest_at_rest = std::max(result.deepest_at_rest, record->max_penetration);
        result.fastest_at_rest = std::max(result.fastest_at_rest, record->vel.norm());
      }
    }
    for (const std::vector<int>& island : world.islands())
      result.largest_island = std::max(result.largest_island, static_cast<int>(island.size()));
  }
  for (int b = 0; b < world.body_count(); ++b) {
    const Eigen::Vector3d centre = centre_of_mass(world.body(b).model().mass, world.body(b).x());
    const double r = std::hypot(centre.x(), centre.z());
    if (r > 1.6 * kBowlRadius || centre.y() < bowl_height(r)) ++result.escaped;
  }
  return result;
}

}  // namespace vivify::sim

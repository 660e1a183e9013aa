#include "bench/pile.h"

#include <array>
#include <cmath>
#include <numbers>

#include "bench/bodies.h"
#include "common/text.h"

namespace vivify::bench {

double bowl_height(double r) { return 1.73 * r * r; }

namespace {

// A surface of revolution, open to the top.
sim::Collider bowl() {
  const int rings = 24, sectors = 48;
  TriangleMesh mesh;
  mesh.V.resize(1 + rings * sectors, 3);
  mesh.V.row(0).setZero();
  for (int ring = 0; ring < rings; ++ring) {
    const double r = kBowlRim * (ring + 1) / rings;
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
  return sim::Collider("bowl", std::move(mesh), 0.5);
}

sim::BodyInput sphere(int i, double stiffness) {
  SimMesh mesh = ball(kPileRadius, 1, 1);
  // Layers of five by five, every other one shifted by half a distance.
  const int layer = i / 16, place = i % 16;
  const double step = 2.3 * kPileRadius, shift = layer % 2 == 0 ? 0 : 0.5 * step;
  const Eigen::RowVector3d middle = 0.5 * (mesh.V.colwise().minCoeff() + mesh.V.colwise().maxCoeff());
  mesh.V.rowwise() += Eigen::RowVector3d((place % 4 - 1.5) * step + shift, 0.42 + layer * step,
                                         (place / 4 - 1.5) * step + 0.3 * shift) -
                      middle;
  return body_input("sphere" + std::to_string(i), std::move(mesh),
                    "{type: solid3d, density: 300, stiffness: " + number_text(stiffness) +
                        ", volume_stiffness: " + number_text(stiffness) + ", damping_s: 0.005}",
                    "{type: rest}");
}

// Upright and side by side above the spheres.
sim::BodyInput sheet(int i, int spheres) {
  SimMesh mesh = card(4, 5, 0.03);
  const Eigen::RowVector3d middle = 0.5 * (mesh.V.colwise().minCoeff() + mesh.V.colwise().maxCoeff());
  mesh.V.rowwise() += Eigen::RowVector3d(0.05 * (i % 3 - 1),
                                         0.55 + 2.3 * kPileRadius * ((spheres + 15) / 16) + 0.05 * (i % 2),
                                         0.03 * i - 0.135) -
                      middle;
  return body_input("card" + std::to_string(i), std::move(mesh),
                    "{type: shell3d, density: 1, stiffness: 3000, bending_stiffness: 0.02, thickness: "
                    "0.004, damping_s: 0.005}",
                    "{type: rest}");
}

}  // namespace

sim::World pile_world(const Pile& pile, double h) {
  std::vector<sim::BodyInput> bodies;
  for (int i = 0; i < pile.spheres; ++i) bodies.push_back(sphere(i, pile.stiffness));
  for (int i = 0; i < pile.cards; ++i) bodies.push_back(sheet(i, pile.spheres));
  for (sim::BodyInput& body : bodies) body.velocity = {0, -pile.speed, 0};
  std::vector<sim::Collider> colliders;
  colliders.push_back(bowl());
  return sim::World(bodies, std::move(colliders), {{0, -9.81, 0}, h});
}

sim::World apart_world(int spheres, double h) {
  std::vector<sim::BodyInput> bodies;
  for (int i = 0; i < spheres; ++i) {
    sim::BodyInput body = sphere(0, Pile().stiffness);
    body.name = "sphere" + std::to_string(i);
    const double bottom = body.rest.V.col(1).minCoeff();
    body.rest.V.rowwise() += Eigen::RowVector3d(i % 10, 0.01 - bottom, i / 10);
    bodies.push_back(std::move(body));
  }
  return sim::World(bodies, ground(), {{0, -9.81, 0}, h});
}

}  // namespace vivify::bench

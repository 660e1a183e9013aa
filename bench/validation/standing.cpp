#include "bench/validation/standing.h"

#include <algorithm>
#include <numbers>

#include "bench/validation/lattice.h"
#include "sim/contact/contact_surface.h"
#include "sim/control/rigid_motion.h"
#include "sim/settings.h"

namespace vivify::validation {

using namespace sim;

std::vector<Sample> blocks(const std::string& keys) {
  std::vector<Sample> list = {
      {"rod2d", chain(6, 0, 0.5), {}},
      {"solid2d", rectangle(4, 2, 0.5, 0.2), {}},
      {"solid2d_printed", rectangle(4, 2, 0.5, 0.2), {}},
      {"shell3d", equilateral_strip(2, 0.3, 0, 0.5), {}},
      {"solid3d", box(4, 2, 2, 0.5, 0.2, 0.3), {}},
      {"solid3d_stvk", box(4, 2, 2, 0.5, 0.2, 0.3), {}},
  };
  for (Sample& sample : list) {
    RowMatrixXd& V = sample.mesh.V;
    const Eigen::RowVectorXd low = V.colwise().minCoeff();
    Eigen::RowVectorXd shift = -0.5 * (low + V.colwise().maxCoeff());
    shift[1] = -low[1];
    V.rowwise() += shift;
    sample.yaml = "{type: " + sample.model + keys + "}";
  }
  return list;
}

BodyInput standing_body(const SimMesh& mesh, const std::string& model, const std::string& name,
                        const std::string& contact) {
  BodyInput input = body_input(mesh, model, "strains");
  input.name = name;
  input.contact = settings(contact_schema(), contact);
  input.contact_points = boundary_of(mesh, 1).points;  // the thickness does not move them
  return input;
}

std::vector<Collider> inclined_plane(double friction, double degrees) {
  ShapePlace place;
  place.pose.rotate(Eigen::AngleAxisd(-degrees * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()));
  std::vector<Collider> colliders;
  colliders.emplace_back(
      "plane", make_collider_shape(settings(collider_shape_schema(), "{type: plane}"), place), friction);
  return colliders;
}

SimMesh inclined(SimMesh mesh, double degrees) {
  const Eigen::Rotation2Dd turn(-degrees * std::numbers::pi / 180);
  mesh.V.leftCols<2>() *= turn.toRotationMatrix().transpose();
  return mesh;
}

SimMesh moved(SimMesh mesh, const Eigen::Vector3d& by) {
  mesh.V.rowwise() += by.head(mesh.dimension()).transpose();
  return mesh;
}

Eigen::Vector3d centre(const World& world, int b) {
  return centre_of_mass(world.body(b).model().mass, world.body(b).x());
}

Eigen::Vector3d velocity(const World& world, int b) {
  return centre_of_mass(world.body(b).model().mass, world.body(b).v());
}

double mass(const World& world, int b) { return world.body(b).model().mass.sum(); }

const StepRecord& record(const World& world, int b) {
  return world.records()[world.records().size() - static_cast<std::size_t>(world.body_count() - b)];
}

Standing watch_standing(World& world, double h, int key) {
  constexpr double kSettled = 1, kSeconds = 6;
  const int count = world.body_count();
  std::vector<Eigen::Vector3d> settled(static_cast<std::size_t>(count));
  Standing standing;
  standing.start = centre(world, key).y();
  while (world.time() < kSeconds - 0.5 * h) {
    world.step();
    for (int b = 0; b < count; ++b) {
      Eigen::Vector3d& from = settled[static_cast<std::size_t>(b)];
      if (world.time() < kSettled + 0.5 * h) from = centre(world, b);
      standing.drift = std::max(standing.drift, (centre(world, b) - from).norm());
      standing.penetration = std::max(standing.penetration, record(world, b).max_penetration);
    }
    standing.height.add(world.time(), centre(world, key).y());
  }
  standing.sunk = standing.start - centre(world, key).y();
  return standing;
}

}  // namespace vivify::validation

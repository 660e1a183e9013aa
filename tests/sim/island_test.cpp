// Bodies that touch one another: the laws of their motion, and the islands they form.
#include <gtest/gtest.h>

#include <unistd.h>
#include <Eigen/Geometry>
#include <filesystem>
#include <numbers>

#include "common/parallel.h"
#include "sim/control/rigid_motion.h"
#include "sim/island.h"
#include "sim/settings.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

constexpr const char* kSoft = "{type: solid3d, stiffness: 8000, volume_stiffness: 80000}";

constexpr const char* kStiff =
    "{type: solid3d, stiffness: 200000, volume_stiffness: 200000, damping_s: 0.01}";

// A passive box of 0.5 m whose centre is at `centre`.
BodyInput box(const std::string& name, const Eigen::Vector3d& centre, const Scene& scene = {.model = kSoft}) {
  TetMesh mesh = small_box();
  const Eigen::RowVector3d middle = 0.5 * (mesh.V.colwise().minCoeff() + mesh.V.colwise().maxCoeff());
  mesh.V.rowwise() += centre.transpose() - middle;
  BodyInput input = box_input(mesh, scene);
  input.name = name;
  return input;
}

Eigen::Vector3d momentum(const World& world) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int b = 0; b < world.body_count(); ++b) {
    const Body& body = world.body(b);
    sum += body.model().mass.sum() * centre_of_mass(body.model().mass, body.v());
  }
  return sum;
}

double mechanical_energy(const World& world) {
  double sum = 0;
  for (auto record = world.records().end() - world.body_count(); record != world.records().end(); ++record)
    sum += record->kinetic + record->elastic;
  // The contacts are springs f = k d² too.
  const BodyModel& model = world.body(0).model();
  const double k = model.weight / (model.contact.layer * model.contact.layer);
  for (const PairMemory& touching : world.touching())
    sum += touching.normal_force * std::sqrt(touching.normal_force / k) / 3;
  return sum;
}

TEST(Island, ApartBodiesAreAlone) {
  World world({box("a", {0, 0, 0}), box("b", {2, 0, 0})}, {}, {{0, 0, 0}, 0.01});
  world.step();
  EXPECT_EQ(world.islands(), (std::vector<std::vector<int>>{{0}, {1}}));
}

TEST(Island, BodiesThatFlySideBySideAreAlone) {
  BodyInput a = box("a", {0, 0, 0}), b = box("b", {0.55, 0, 0});
  a.velocity = b.velocity = {3, -20, 1};
  World world({a, b}, {}, {{0, -9.81, 0}, 0.02});
  for (int step = 0; step < 5; ++step) {
    world.step();
    EXPECT_EQ(world.islands().size(), 2u) << step;
  }
}

// A wall knocks the first box into the second within one step; both were at rest and apart.
TEST(Island, BodiesThatMeetWithinAStepAreSolvedAgainAsOne) {
  const double gap = 0.02, h = 0.02;
  const RigidPath knock({{0, {0, 0, 0}, {0, 0, 0}, {}}, {h, {0.1, 0, 0}, {0, 0, 0}, {}}}, false);
  ShapePlace wall;
  wall.pose.linear() = Eigen::AngleAxisd(-std::numbers::pi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  wall.pose.translation().x() = -0.202;
  std::vector<Collider> colliders;
  colliders.emplace_back(
      "wall", make_collider_shape(settings(collider_shape_schema(), "{type: plane}"), wall), 0.0, knock);
  World world({box("a", {0, 0, 0}, {.model = kStiff}), box("b", {0.4 + gap, 0, 0}, {.model = kStiff}),
               box("far", {9, 0, 0})},
              std::move(colliders), {{0, 0, 0}, h});
  world.step();
  EXPECT_EQ(world.islands(), (std::vector<std::vector<int>>{{0, 1}, {2}}));
  EXPECT_FALSE(world.touching().empty());
  ASSERT_EQ(world.records().size(), 3u);
  for (const StepRecord& record : world.records()) {
    EXPECT_EQ(record.step, 1);
    EXPECT_LE(record.residual_rel, 1e-8);
  }
  for (const PairMemory& touching : world.touching()) EXPECT_GT(touching.distance, -0.005);
  EXPECT_GT(centre_of_mass(world.body(1).model().mass, world.body(1).v()).x(), 0.1);
}

TEST(Island, BodiesThatFallOnOneAnotherStackAndRest) {
  World world(
      {box("lower", {0, 0.255, 0}, {.model = kStiff}), box("upper", {0.02, 0.765, 0.03}, {.model = kStiff})},
      one(plane(1)), {});
  double residual = 0;
  for (int step = 0; step < 150; ++step) {
    world.step();
    for (auto record = world.records().end() - 2; record != world.records().end(); ++record)
      residual = std::max(residual, record->residual_rel);
  }
  const Body &lower = world.body(0), &upper = world.body(1);
  EXPECT_EQ(world.islands().size(), 1u);
  EXPECT_LE(residual, 1e-8);
  EXPECT_LE(lower.v().lpNorm<Eigen::Infinity>(), 1e-2);
  EXPECT_LE(upper.v().lpNorm<Eigen::Infinity>(), 1e-2);
  const double gap =
      centre_of_mass(upper.model().mass, upper.x()).y() - centre_of_mass(lower.model().mass, lower.x()).y();
  EXPECT_NEAR(gap, 0.5, 0.05);
  double load = 0;
  for (const PairMemory& touching : world.touching())
    load += touching.normal_force * std::abs(touching.normal.y());
  EXPECT_NEAR(load, 9.81 * upper.model().mass.sum(), 0.02 * 9.81 * upper.model().mass.sum());
}

// Two boxes that meet off-centre in free space.
World collision(double speed = 1) {
  BodyInput a = box("a", {0, 0, 0}), b = box("b", {0.7, 0.17, 0.11});
  a.velocity = {speed, 0, 0};
  b.velocity = {-0.5 * speed, 0.1 * speed, 0};
  return World({a, b}, {}, {{0, 0, 0}, 0.005});
}

TEST(Island, CollisionInFreeSpaceKeepsMomentumAndGainsNoEnergy) {
  World world = collision();
  const Eigen::Vector3d before = momentum(world);
  Eigen::Vector3d spin_before = Eigen::Vector3d::Zero();
  const auto angular = [&] {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int b = 0; b < 2; ++b) {
      const Body& body = world.body(b);
      const double mass = body.model().mass.sum();
      sum +=
          angular_momentum(body.model().mass, body.x(), body.v()) +
          mass *
              centre_of_mass(body.model().mass, body.x()).cross(centre_of_mass(body.model().mass, body.v()));
    }
    return sum;
  };
  spin_before = angular();
  world.step();
  const double initial = mechanical_energy(world);
  double energy = initial;
  bool touched = false;
  for (int step = 0; step < 160; ++step) {
    world.step();
    touched |= !world.touching().empty();
    for (auto record = world.records().end() - 2; record != world.records().end(); ++record)
      EXPECT_LE(record->residual_rel, 1e-8);
    EXPECT_LE((momentum(world) - before).norm(), 1e-10 * before.norm()) << step;
    const double now = mechanical_energy(world);
    EXPECT_LE(now, initial * (1 + 1e-12)) << step;
    // Where the nearest features change from one step to the next, so does the potential of the contacts.
    EXPECT_LE(now, energy + 0.005 * initial) << step;
    energy = now;
  }
  EXPECT_TRUE(touched);
  // Implicit Euler loses angular momentum at the rate of the step size.
  EXPECT_LE((angular() - spin_before).norm(), 0.03 * spin_before.norm());
  // They bounced.
  const auto speed = [&](int b) { return centre_of_mass(world.body(b).model().mass, world.body(b).v()).x(); };
  EXPECT_LT(speed(0), speed(1));
}

// A passive card of 0.2 by 0.3 m, its plane turned by `tilt` about x from lying flat.
BodyInput card(const std::string& name, const Eigen::Vector3d& centre, double tilt,
               const Scene& scene = {.model = "{type: shell3d, density: 1, stiffness: 3000, "
                                              "bending_stiffness: 0.01, thickness: 0.004, damping_s: 0.005}",
                                     .contact = "{self: false}"}) {
  const int nx = 4, nz = 6;
  BodyInput input;
  input.name = name;
  input.rest.V.resize((nx + 1) * (nz + 1), 3);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()).toRotationMatrix();
  for (int i = 0; i <= nx; ++i) {
    for (int k = 0; k <= nz; ++k) {
      const Eigen::Vector3d flat(0.2 * (double(i) / nx - 0.5), 0, 0.3 * (double(k) / nz - 0.5));
      input.rest.V.row(i * (nz + 1) + k) = (centre + R * flat).transpose();
    }
  }
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i < nx; ++i) {
    for (int k = 0; k < nz; ++k) {
      const int a = i * (nz + 1) + k, b = a + nz + 1;
      if ((i + k) % 2 == 0) {
        triangles.push_back({a, a + 1, b});
        triangles.push_back({b, a + 1, b + 1});
      } else {
        triangles.push_back({a, a + 1, b + 1});
        triangles.push_back({a, b + 1, b});
      }
    }
  }
  input.rest.E.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) input.rest.E(static_cast<Eigen::Index>(t), k) = triangles[t][k];
  input.rest_space = "full";
  input.contact_points = vertex_contacts(input.rest);
  input.model = settings(model_schema(), scene.model);
  input.regularizer = settings(regularizer_schema(), scene.regularizer);
  input.contact = settings(contact_schema(), scene.contact);
  input.controller = settings(controller_schema(), scene.controller);
  input.solver = settings(solver_schema(), scene.solver);
  return input;
}

double highest(const Body& body) {
  double y = -INFINITY;
  for (Eigen::Index i = 1; i < body.x().size(); i += 3) y = std::max(y, body.x()[i]);
  return y;
}
double lowest(const Body& body) { return lowest_height(body.x(), 3); }

// Whether an edge of a goes through a triangle of b.
bool crosses(const Body& a, const Body& b) {
  const auto point = [](const Body& body, int v) { return Eigen::Vector3d(body.x().segment<3>(3 * v)); };
  const RowMatrixXi& F = b.model().mesh.E;
  const RowMatrixXi edges = edges_of(a.model().mesh.E);
  for (Eigen::Index e = 0; e < edges.rows(); ++e) {
    const Eigen::Vector3d p = point(a, edges(e, 0)), q = point(a, edges(e, 1));
    for (Eigen::Index f = 0; f < F.rows(); ++f) {
      const Eigen::Vector3d o = point(b, F(f, 0)), u = point(b, F(f, 1)) - o, w = point(b, F(f, 2)) - o;
      Eigen::Matrix3d M;
      M << u, w, p - q;
      if (std::abs(M.determinant()) < 1e-15) continue;
      const Eigen::Vector3d at = M.inverse() * (p - o);
      if (at.minCoeff() >= 0 && at.z() <= 1 && at.x() + at.y() <= 1) return true;
    }
  }
  return false;
}

TEST(Island, ThinBodiesNeverPassThroughOneAnother) {
  for (const double speed : {1.0, 4.0, 10.0}) {
    BodyInput lower = card("lower", {0, 0, 0}, 0), upper = card("upper", {0.03, 0.15, 0.04}, 0.3);
    upper.velocity = {0, -speed, 0};
    World world({lower, upper}, {}, {{0, 0, 0}, 0.005});
    bool touched = false;
    for (int step = 0; step < 60; ++step) {
      world.step();
      touched |= !world.touching().empty();
      ASSERT_FALSE(crosses(world.body(0), world.body(1))) << "at " << speed << " m/s, step " << step;
      ASSERT_FALSE(crosses(world.body(1), world.body(0))) << "at " << speed << " m/s, step " << step;
    }
    EXPECT_TRUE(touched);
  }
}

TEST(Island, ACardDroppedEdgeOnStaysAboveTheFloor) {
  for (const double speed : {0.0, 10.0}) {
    BodyInput input = card("card", {0, 0.3, 0}, 0.5 * std::numbers::pi);
    input.velocity = {0, -speed, 0};
    World world({input}, one(plane(0.5)), {{0, -9.81, 0}, 0.005});
    for (int step = 0; step < 200; ++step) {
      world.step();
      ASSERT_GT(lowest(world.body(0)), -0.004) << "at " << speed << " m/s, step " << step;
    }
  }
}

TEST(Island, ABoxRestsOnACardOnTheFloor) {
  BodyInput below = card("card", {0, 0.003, 0}, 0);
  World world({below, box("box", {0, 0.27, 0}, {.model = kStiff})}, one(plane(0.5)), {});
  for (int step = 0; step < 100; ++step) world.step();
  EXPECT_LE(world.body(1).v().lpNorm<Eigen::Infinity>(), 1e-2);
  EXPECT_GT(lowest(world.body(1)), -1e-3);
  EXPECT_LE(highest(world.body(0)), lowest(world.body(1)) + 0.003);
}

// Two boxes that will touch, and others far away when asked for.
World with_others(int others) {
  std::vector<BodyInput> bodies = {box("a", {0, 0.26, 0}), box("b", {0.1, 0.80, 0.05})};
  for (int i = 0; i < others; ++i) bodies.push_back(box("other" + std::to_string(i), {3.0 + 2 * i, 0.3, 0}));
  return World(bodies, one(plane(1)), {});
}

TEST(Island, AFarAwayBodyChangesNothing) {
  World alone = with_others(0), in_company = with_others(2);
  bool touched = false;
  for (int step = 0; step < 40; ++step) {
    alone.step();
    touched |= !alone.touching().empty();
    in_company.step();
  }
  EXPECT_TRUE(touched);
  for (int b = 0; b < 2; ++b) EXPECT_EQ(alone.body(b).x(), in_company.body(b).x());
}

TEST(Island, ResultsDoNotDependOnTheNumberOfThreads) {
  std::vector<Vector> results;
  for (const int threads : {1, 2, 4}) {
    set_thread_count(threads);
    World world = with_others(3);
    for (int step = 0; step < 30; ++step) world.step();
    Vector all;
    for (int b = 0; b < world.body_count(); ++b) {
      all.conservativeResize(all.size() + world.body(b).x().size());
      all.tail(world.body(b).x().size()) = world.body(b).x();
    }
    results.push_back(all);
  }
  set_thread_count(0);
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

TEST(Island, RestartsToTheBit) {
  const auto path =
      std::filesystem::temp_directory_path() / ("vivify_island_" + std::to_string(getpid()) + ".h5");
  World whole = with_others(1), cut = with_others(1);
  for (int step = 0; step < 30; ++step) {
    whole.step();
    if (step < 20) cut.step();
  }
  ASSERT_FALSE(cut.touching().empty());
  Hdf5Writer file;
  cut.save(file);
  file.save(path);
  World resumed = with_others(1);
  resumed.restore(Hdf5Reader(path));
  std::filesystem::remove(path);
  for (int step = 20; step < 30; ++step) resumed.step();
  for (int b = 0; b < 3; ++b) EXPECT_EQ(resumed.body(b).x(), whole.body(b).x());
}

TEST(Island, TwoHoppersShoveEachOtherWithinTheLawsOfPhysics) {
  const Scene hopper = {.model = "{type: solid3d, stiffness: 60000, volume_stiffness: 60000}",
                        .controller = "{type: hop, height: 0.15, pace: 0.3, heading_deg: 90}"};
  Scene other = hopper;
  other.controller = "{type: hop, height: 0.15, pace: 0.3, heading_deg: 270}";
  World world({box("left", {-0.33, 0.2501, 0}, hopper), box("right", {0.33, 0.2501, 0.04}, other)},
              one(plane(1)), {});
  Eigen::Vector3d before = momentum(world);
  bool shoved = false,
       on_ground_before = true;  // friction lasts for the step in which a foot leaves the ground
  for (int step = 0; step < 150; ++step) {
    world.step();
    shoved |= !world.touching().empty();
    bool on_ground = false;
    for (auto record = world.records().end() - 2; record != world.records().end(); ++record) {
      EXPECT_LE(record->residual_rel, 1e-8);
      EXPECT_LE(record->internal_force, 1e-8);
    }
    for (int b = 0; b < 2; ++b)
      for (const ContactMemory& contact : world.body(b).state().contacts) on_ground |= contact.touching;
    const Eigen::Vector3d after = momentum(world);
    if (!on_ground && !on_ground_before) {
      const double mass = world.body(0).model().mass.sum() + world.body(1).model().mass.sum();
      const Eigen::Vector3d fall = mass * Eigen::Vector3d(0, -9.81, 0) / 48;
      EXPECT_LE((after - before - fall).norm(), 1e-7 * fall.norm()) << step;
    }
    before = after;
    on_ground_before = on_ground;
  }
  EXPECT_TRUE(shoved);
}

}  // namespace
}  // namespace vivify::sim

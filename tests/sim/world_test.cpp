// Laws that whole runs obey.
#include "sim/world.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>

#include "common/text.h"
#include "sim/contact/normal_force.h"
#include "sim/control/rigid_motion.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

constexpr double kGravity = 9.81;

struct ScratchFile {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("vivify_world_test_" + std::to_string(getpid()) + ".h5");
  ~ScratchFile() { std::filesystem::remove(path); }
};

// The height of potential energy is that of the centre of mass; contacts store energy, too.
double contact_energy(const Body& body, const std::vector<Collider>& colliders) {
  const BodyModel& model = body.model();
  const NormalForce normal{model.contact.normal_stiffness, model.contact.layer};
  double sum = 0;
  for (int i = 0; i < model.contact_points.size(); ++i) {
    for (const Collider& collider : colliders) {
      sum += normal.energy(collider.nearest(model.contact_points.position(i, body.x())).distance);
    }
  }
  return sum;
}

class HopRun : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    world = std::make_unique<World>(
        std::vector<BodyInput>{box_input(
            standing_box(),
            {.controller = "{type: hop, heading_deg: 90, height: 0.25, pace: 0.6, crouch_s: 0.25}"})},
        one(plane(1)), WorldSettings{});
    for (int step = 0; step < 84; ++step) world->step();
  }
  static void TearDownTestSuite() { world.reset(); }
  static const std::vector<StepRecord>& records() { return world->records(); }
  static std::unique_ptr<World> world;
};
std::unique_ptr<World> HopRun::world;

TEST_F(HopRun, EveryStepSolvesTheEquationsOfMotion) {
  for (const StepRecord& r : records()) {
    EXPECT_LE(r.residual_rel, 1e-8) << "step " << r.step;
    EXPECT_EQ(r.fallback, 0) << "step " << r.step;
    EXPECT_GT(r.min_element_ratio, 0.05);
  }
}

TEST_F(HopRun, InternalForcesAndTorquesVanish) {
  const BodyModel& model = world->body(0).model();
  for (const StepRecord& r : records()) {
    EXPECT_LE(r.internal_force, 1e-9 * model.weight) << "step " << r.step;
    EXPECT_LE(r.internal_torque, 1e-9 * model.weight * model.height) << "step " << r.step;
  }
}

TEST_F(HopRun, FliesAlongTheDiscreteParabola) {
  const double h = WorldSettings().h;
  int longest = 0, moving = 0;
  for (std::size_t begin = 0; begin < records().size(); ++begin) {
    if (records()[begin].contacts > 0 || (begin > 0 && records()[begin - 1].contacts == 0)) continue;
    const StepRecord& start = records()[begin];
    int n = 1;
    for (; begin + n < records().size() && records()[begin + n].contacts == 0; ++n) {
      const StepRecord& r = records()[begin + n];
      const Eigen::Vector3d expected =
          start.com + n * h * start.vel - Eigen::Vector3d(0, kGravity * h * h * n * (n + 1) / 2, 0);
      EXPECT_LE((r.com - expected).norm(), 1e-8) << "step " << r.step;
      moving += r.p_rate > 1e-3;
    }
    longest = std::max(longest, n);
  }
  EXPECT_GE(longest * h, 0.2) << "no hop";
  EXPECT_GE(moving, 1) << "the rest shape must change in flight for this to say something";
}

TEST_F(HopRun, HopsToTheHeadingAndStaysUpright) {
  const StepRecord& last = records().back();
  EXPECT_GT(last.com.x(), 0.2);
  EXPECT_LE(std::abs(last.com.z()), 0.1);
  for (const StepRecord& r : records()) {
    EXPECT_LE(r.tilt_deg, 45);
    EXPECT_LE(r.max_penetration, 0.02);
  }
}

// From the rest points themselves.
TEST(RestShape, RecordsTellHowItChanges) {
  for (const char* settings : {"{type: solid3d}", "{type: solid3d_stvk}"}) {
    World world({box_input(small_box(), {.model = settings, .controller = "{type: hop, height: 0.2}"})},
                one(plane(1)), {});
    const Body& body = world.body(0);
    const auto& space = dynamic_cast<const ShapeSpace&>(*body.model().rest);
    const Vector sizes = element_sizes(body.model().mesh);
    double slowest = INFINITY, fastest = 0;
    for (int step = 0; step < 40; ++step) {
      const Vector before = space.shape(body.state().q);
      world.step();
      const StepRecord& r = world.records().back();
      SimMesh rest = body.model().mesh;
      const Vector X = space.shape(body.state().q);
      rest.V = Eigen::Map<const RowMatrixXd>(X.data(), rest.V.rows(), 3);
      const Vector now = element_sizes(rest);
      EXPECT_NEAR(r.rest_volume_ratio, now.sum() / sizes.sum(), 1e-12);
      EXPECT_NEAR(r.min_rest_element_ratio, std::min(1.0, now.cwiseQuotient(sizes).minCoeff()), 1e-12);
      const double rms = (X - before).norm() / std::sqrt(static_cast<double>(rest.V.rows()));
      if (r.substeps == 1) {
        EXPECT_NEAR(r.rest_rate, rms / body.model().height * 48, 1e-9);
      }
      slowest = std::min(slowest, r.rest_rate);
      fastest = std::max(fastest, r.rest_rate);
    }
    EXPECT_GT(fastest, 10 * slowest) << "it thrusts";
  }
}

TEST_F(HopRun, RecordsDescribeTheState) {
  const Body& body = world->body(0);
  const StepRecord& last = records().back();
  EXPECT_EQ(last.step, 84);
  EXPECT_NEAR(last.t, 84.0 / 48, 1e-12);
  EXPECT_LE((last.com - centre_of_mass(body.model().mass, body.x())).norm(), 1e-14);
  EXPECT_LE((last.vel - centre_of_mass(body.model().mass, body.v())).norm(), 1e-14);
  EXPECT_NEAR(last.p_norm, body.p().norm(), 1e-14);
  // As many columns as the header, and numbers that read back exactly.
  const std::string header = csv_header(), line = csv_line(last);
  EXPECT_EQ(std::count(header.begin(), header.end(), ','), std::count(line.begin(), line.end(), ','));
  EXPECT_NE(line.find(',' + number_text(last.objective) + ','), std::string::npos);
}

// A second world, and one that goes on from a saved frame, pass through the same bits.
TEST(World, RestartsAndRepeatsExactly) {
  const BodyInput input = box_input(small_box(), {.controller = "{type: hop, heading_deg: 30}"});
  const auto make = [&] { return World({input}, one(plane(0.8)), {}); };
  World first = make(), again = make();
  for (int step = 0; step < 25; ++step) {
    first.step();
    again.step();
  }
  ScratchFile file;
  Hdf5Writer saved;
  first.save(saved);
  saved.save(file.path);
  EXPECT_TRUE(first.records().empty());
  World resumed = make();
  resumed.restore(Hdf5Reader(file.path));
  EXPECT_EQ(resumed.steps(), 25);
  for (int step = 0; step < 20; ++step) {
    first.step();
    again.step();
    resumed.step();
    ASSERT_EQ(first.body(0).x(), again.body(0).x());
    ASSERT_EQ(first.body(0).x(), resumed.body(0).x());
    ASSERT_EQ(first.body(0).v(), resumed.body(0).v());
    ASSERT_EQ(first.body(0).p(), resumed.body(0).p());
    ASSERT_EQ(csv_line(first.records().back()), csv_line(resumed.records().back()));
  }
}

TEST(World, ABodyFarAwayChangesNothing) {
  const BodyInput input = box_input(small_box(), {.controller = "{type: hop}"});
  BodyInput far = input;
  far.name = "far";
  far.rest.V.rowwise() += Eigen::RowVector3d(20, 1, 0);
  World alone({input}, one(plane(0.8)), {}), both({input, far}, one(plane(0.8)), {});
  for (int step = 0; step < 20; ++step) {
    alone.step();
    both.step();
  }
  EXPECT_EQ(alone.body(0).x(), both.body(0).x());
  EXPECT_EQ(both.records().size(), 40u);
}

TEST(Passive, ADroppedBoxLosesEnergyAndComesToRestInTheContactLayer) {
  TetMesh mesh = small_box();
  mesh.V.col(1).array() += 0.1;
  World world({box_input(mesh)}, one(plane(0)), {});
  const std::vector<Collider> colliders = one(plane(0));
  const BodyModel& model = world.body(0).model();
  double last = INFINITY;
  bool lifted_again = false, landed = false;
  for (int step = 0; step < 144; ++step) {
    world.step();
    const StepRecord& r = world.records().back();
    const double energy =
        r.kinetic + r.elastic + model.weight * r.com.y() + contact_energy(world.body(0), colliders);
    EXPECT_LE(energy, last + 1e-9 * model.weight * model.height) << "step " << step;
    last = energy;
    EXPECT_EQ(r.p_norm, 0);
    lifted_again = lifted_again || (landed && r.contacts == 0);
    landed = landed || r.contacts > 0;
  }
  EXPECT_TRUE(landed);
  const StepRecord& rest = world.records().back();
  EXPECT_LE(std::sqrt(2 * rest.kinetic / model.mass.sum()), 1e-3);
  EXPECT_GT(rest.contacts, 0);
  // The springs carry the weight, and k was chosen so that they do it a layer deep: on the drawn surface.
  const NormalForce normal{model.contact.normal_stiffness, model.contact.layer};
  double carried = 0;
  for (int i = 0; i < model.contact_points.size(); ++i) {
    carried += normal.force(model.contact_points.position(i, world.body(0).x()).y());
  }
  EXPECT_NEAR(carried, model.weight, 1e-2 * model.weight);
  EXPECT_LE(std::abs(rest.min_clearance), model.contact.layer);
  EXPECT_EQ(rest.max_penetration, std::max(0.0, -rest.min_clearance));
}

// Coulomb on a slope of atan(0.5) ≈ 26.6°. The soft block rocks for two seconds before it stands still.
class Slope : public ::testing::Test {
 protected:
  static constexpr double kSlope = 0.5;
  // Distance slid along the slope after each step (m).
  static std::vector<double> slide(double friction, int steps) {
    const Eigen::Matrix3d tilt =
        Eigen::AngleAxisd(std::atan(kSlope), Eigen::Vector3d::UnitZ()).toRotationMatrix();
    TetMesh mesh = small_box();
    mesh.V = rows(rigid(tilt, {0, 0, 0}, flat(mesh.V)));
    World world({box_input(mesh)}, one(plane(friction, tilt.col(1))), {});
    std::vector<double> travelled;
    for (int step = 0; step < steps; ++step) {
      world.step();
      travelled.push_back(-world.records().back().com.dot(tilt.col(0)));
    }
    return travelled;
  }
};

TEST_F(Slope, HoldsAboveTheCriticalFriction) {
  const std::vector<double> travelled = slide(0.6, 240);
  EXPECT_LE(std::abs(travelled[239] - travelled[95]), 1e-3);
}

TEST_F(Slope, HoldsWithUnlimitedFriction) {
  const std::vector<double> travelled = slide(INFINITY, 240);
  EXPECT_LE(std::abs(travelled[239] - travelled[95]), 1e-4);
}

TEST_F(Slope, SlidesBelowItWithCoulombsAcceleration) {
  const std::vector<double> travelled = slide(0.4, 96);
  const double h = WorldSettings().h, angle = std::atan(kSlope);
  const double first = (travelled[36] - travelled[35]) / h, second = (travelled[95] - travelled[94]) / h;
  const double acceleration = (second - first) / (59 * h);
  const double expected = kGravity * (std::sin(angle) - 0.4 * std::cos(angle));
  EXPECT_NEAR(acceleration, expected, 0.03 * expected);
}

// Without colliders: the centre of mass falls, and linear implicit Euler loses angular momentum in first
// order of h.
TEST(Free, MomentumInFlight) {
  const auto drift = [](double h) {
    World world({box_input(small_box())}, {}, {.h = h});
    const BodyModel& model = world.body(0).model();
    const Vector x = world.body(0).x();
    const Eigen::Vector3d spin(1, 3, -2), shift(0.5, 2, 1), centre = centre_of_mass(model.mass, x);
    Vector v(x.size());
    for (Eigen::Index i = 0; i < x.size(); i += 3) {
      v.segment<3>(i) = spin.cross(Eigen::Vector3d(x.segment<3>(i)) - centre) + shift;
    }
    set_motion(world, x, v);
    const Eigen::Vector3d start = angular_momentum(model.mass, x, v);
    const int steps = static_cast<int>(std::lround(0.2 / h));
    for (int n = 1; n <= steps; ++n) {
      world.step();
      const StepRecord& r = world.records().back();
      const Eigen::Vector3d expected =
          centre + n * h * shift - Eigen::Vector3d(0, kGravity * h * h * n * (n + 1) / 2, 0);
      EXPECT_LE((r.com - expected).norm(), 1e-10);
      EXPECT_LE((r.vel - shift + Eigen::Vector3d(0, kGravity * n * h, 0)).norm(), 1e-9);
      EXPECT_LE(r.internal_torque, 1e-9 * model.weight * model.height);
    }
    const Eigen::Vector3d end = angular_momentum(model.mass, world.body(0).x(), world.body(0).v());
    EXPECT_GT(end.dot(start), 0);
    return (end - start).norm() / start.norm();
  };
  const double coarse = drift(0.005), fine = drift(0.0025);
  EXPECT_LE(coarse, 0.1);
  EXPECT_NEAR(coarse / fine, 2, 0.2);
}

// No internal force moves the centre of mass, whatever the rest shape does.
TEST(Free, WildRestShapesDoNotMoveTheCentreOfMass) {
  const BodyModel body = make_body_model(box_input(small_box()), {});
  StepWorkspace workspace(*body.pattern);
  const double h = 1.0 / 48;
  const ContactSet none;
  CounterRng rng(1);
  Vector x = flat(small_box().V), v = Vector::Zero(x.size()), q = Vector::Zero(body.rest->free_parameters());
  const Eigen::Vector3d start = centre_of_mass(body.mass, x);
  double largest = 0;
  for (int n = 1; n <= 24; ++n) {
    const Goals goals = make_goals({}, x, h);
    Vector x_tilde = x + h * v;
    for (Eigen::Index i = 1; i < x.size(); i += 3) x_tilde[i] -= kGravity * h * h;
    const StepProblem problem(body, none, goals, x, x_tilde, q, h);
    q = random_vector(q.size(), 0.03, rng);
    const RestPoint rest = problem.rest_point(q, false);
    const ForwardResult forward = forward_step(problem, rest, x, kFinishTolerance, workspace);
    ASSERT_TRUE(forward.converged);
    v = (forward.at.x - x) / h;
    x = forward.at.x;
    largest = std::max(largest, problem.internal_gradient(0, forward.at, rest).norm());
    const Eigen::Vector3d expected = start - Eigen::Vector3d(0, kGravity * h * h * n * (n + 1) / 2, 0);
    EXPECT_LE((centre_of_mass(body.mass, x) - expected).norm(), 1e-10) << "step " << n;
  }
  EXPECT_GT(largest, body.weight);
}

// A single vibration mode loses exactly the factor 1 + ω²h² of its energy in every step.
TEST(Free, ImplicitEulerDampsAModeByItsLaw) {
  TetMesh tet{Points(4, 3), Tetrahedra(1, 4)};
  tet.V << 0, 0, 0, 1, 0, 0, 0.5, std::sqrt(3) / 2, 0, 0.5, std::sqrt(3) / 6, std::sqrt(2.0 / 3);
  tet.T << 0, 1, 2, 3;
  const double h = WorldSettings().h;
  World world({box_input(tet)}, {}, {});
  const BodyModel& model = world.body(0).model();
  const Vector X = world.body(0).x();
  const ContactSet none;
  const Goals goals = make_goals({}, X, h);
  const Vector zero = Vector::Zero(model.rest->free_parameters());
  const StepProblem problem(model, none, goals, X, X, zero, h);
  SymmetricMatrix D(*model.pattern);
  problem.stiffness(problem.deformed_point(X), problem.rest_point(zero, false), D);
  const double m = model.mass[0];
  const Eigen::SelfAdjointEigenSolver<Matrix> modes((dense(D) - Matrix::Identity(12, 12) * m / (h * h)) / m);
  for (int mode = 0; mode < 6; ++mode) EXPECT_LE(std::abs(modes.eigenvalues()[mode]), 1e-6);
  for (const int mode : {6, 9, 11}) {
    const double omega2 = modes.eigenvalues()[mode];
    ASSERT_GT(omega2, 1);
    set_motion(world, X + 1e-5 * modes.eigenvectors().col(mode), Vector::Zero(12));
    const auto energy = [&] {
      const Body& body = world.body(0);
      const Eigen::Vector3d drift = centre_of_mass(model.mass, body.v());
      double sum =
          problem.elastic_energy(0, problem.deformed_point(body.x()), problem.rest_point(zero, false));
      for (int i = 0; i < 4; ++i) sum += 0.5 * m * (body.v().segment<3>(3 * i) - drift).squaredNorm();
      return sum;
    };
    double last = energy();
    for (int step = 0; step < 4; ++step) {
      world.step();
      const double now = energy();
      EXPECT_NEAR(now / last, 1 / (1 + omega2 * h * h), 1e-3 / (1 + omega2 * h * h)) << "mode " << mode;
      last = now;
    }
  }
}

TEST(Free, WorldsWithoutGravityWork) {
  World world({box_input(small_box())}, {}, {.gravity = {0, 0, 0}});
  const Vector x = world.body(0).x();
  Vector v(x.size());
  for (Eigen::Index i = 0; i < x.size(); i += 3) v.segment<3>(i) = Eigen::Vector3d(1, 0.5, -x[i]);
  set_motion(world, x, v);
  for (int step = 0; step < 20; ++step) world.step();
  EXPECT_NEAR(world.records().back().com.x(), centre_of_mass(world.body(0).model().mass, x).x() + 20.0 / 48,
              1e-9);
}

// Thrown, spun, turned over, soft and stiff: a run goes on with finite numbers or ends with an error.
TEST(Robustness, ViolentScenesEndOneWayOrTheOther) {
  int finished = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    CounterRng rng(seed);
    const double stiffness = std::pow(10, rng.uniform(3.5, 6.5));
    const Eigen::Matrix3d R = random_rotation(rng);
    Scene scene;
    scene.model = "{type: solid3d, stiffness: " + number_text(stiffness) +
                  ", volume_stiffness: " + number_text(stiffness) + "}";
    scene.controller = seed % 2 == 0 ? "{type: hop, pace: 2}" : "{type: rest}";
    World world({box_input(small_box(), scene)}, one(plane(rng.uniform(0, 2))), {});
    const Eigen::Vector3d omega = random_vector(3, 15, rng), shift = random_vector(3, 5, rng);
    const Vector x = rigid(R, {0, 0.5, 0}, world.body(0).x());
    Vector v(x.size());
    for (Eigen::Index i = 0; i < x.size(); i += 3) {
      v.segment<3>(i) = omega.cross(Eigen::Vector3d(x.segment<3>(i)) - Eigen::Vector3d(0, 0.5, 0)) + shift;
    }
    set_motion(world, x, v);
    try {
      for (int step = 0; step < 24; ++step) {
        world.step();
        const StepRecord& r = world.records().back();
        ASSERT_TRUE(std::isfinite(r.kinetic) && std::isfinite(r.elastic) && r.com.allFinite())
            << "seed " << seed;
        ASSERT_LE(r.residual_rel, 1e-8) << "seed " << seed;
      }
      ++finished;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::numerical) << "seed " << seed;
    }
  }
  EXPECT_GE(finished, 8);
}

TEST(World, SavedStatesOfAnotherMeshAreRefused) {
  World small({box_input(small_box())}, {}, {}), large({box_input(standing_box())}, {}, {});
  ScratchFile file;
  Hdf5Writer saved;
  large.save(saved);
  saved.save(file.path);
  EXPECT_THROW(small.restore(Hdf5Reader(file.path)), Error);
}

}  // namespace
}  // namespace vivify::sim

// What frames tell of contacts and goals.
#include "sim/frame_report.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <filesystem>

#include "sim/control/rigid_motion.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

constexpr const char* kStiff =
    "{type: solid3d, stiffness: 200000, volume_stiffness: 200000, damping_s: 0.01}";

// A box of 0.5 m that stands on y = `bottom`.
BodyInput box(const std::string& name, double bottom, const Scene& scene = {.model = kStiff}) {
  TetMesh mesh = small_box();
  mesh.V.col(1).array() += bottom - mesh.V.col(1).minCoeff();
  BodyInput input = box_input(mesh, scene);
  input.name = name;
  return input;
}

// The frame that the world stands at.
class SavedFrame {
 public:
  explicit SavedFrame(World& world) {
    Hdf5Writer writer;
    world.save(writer);
    writer.save(path_);
  }
  ~SavedFrame() { std::filesystem::remove(path_); }
  Hdf5Reader read() const { return Hdf5Reader(path_); }

 private:
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("vivify_frame_report_" + std::to_string(getpid()) + ".h5");
};

Eigen::Vector3d sum(const Hdf5Reader& frame, const std::string& path) {
  return frame.matrix(path).colwise().sum().transpose();
}
Eigen::Vector3d total_force(const Hdf5Reader& frame, const std::string& group) {
  return sum(frame, group + "/normal_force") + sum(frame, group + "/friction_force");
}

TEST(FrameReport, ForcesBearTheWeightsAtRest) {
  World world({box("lower", 0.002), box("upper", 0.505)}, one(plane(0.8)), {});
  const SavedFrame start(world);
  EXPECT_FALSE(start.read().has("/contacts"));
  EXPECT_FALSE(start.read().has("/bodies/lower/contacts"));
  for (int step = 0; step < 300; ++step) world.step();
  const Hdf5Reader frame = SavedFrame(world).read();
  const double lower = world.body(0).model().weight, upper = world.body(1).model().weight;
  const Eigen::Vector3d on_ground = total_force(frame, "/bodies/lower/contacts");
  EXPECT_LE((on_ground - Eigen::Vector3d(0, lower + upper, 0)).norm(), 1e-3 * (lower + upper));
  // The forces are those on body a, the lower one.
  const Eigen::Vector3d on_lower = total_force(frame, "/contacts");
  EXPECT_LE((on_lower + Eigen::Vector3d(0, upper, 0)).norm(), 1e-3 * upper);
  EXPECT_EQ(frame.int_vector("/contacts/body_a"),
            Eigen::VectorXi::Zero(frame.vector("/contacts/slip").size()));
  EXPECT_EQ(frame.int_vector("/contacts/body_b").minCoeff(), 1);
  EXPECT_FALSE(frame.has("/bodies/upper/contacts"));

  // All points lie on the ground, stand still, and hang on anchors that do.
  const RowMatrixXd at = frame.matrix("/bodies/lower/contacts/position"),
                    anchor = frame.matrix("/bodies/lower/contacts/anchor");
  const double layer = world.body(0).model().contact.layer;
  EXPECT_LE(at.col(1).cwiseAbs().maxCoeff(), 3 * layer);
  EXPECT_LE((at - anchor).leftCols<1>().cwiseAbs().maxCoeff(), layer);
  EXPECT_EQ(frame.vector("/bodies/lower/contacts/slip").maxCoeff(), 0);
  EXPECT_LE((frame.vector("/bodies/lower/contacts/distance") - at.col(1)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(frame.int_vector("/bodies/lower/contacts/collider").maxCoeff(), 0);
  const Eigen::VectorXi point = frame.int_vector("/bodies/lower/contacts/point");
  for (Eigen::Index i = 0; i < point.size(); ++i) {
    const Eigen::Vector3d y = world.body(0).model().contact_points.position(point[i], world.body(0).x());
    EXPECT_EQ(y, at.row(i).transpose());
  }
}

TEST(FrameReport, SlidingIsToldWithItsForce) {
  constexpr double kFriction = 0.3;
  BodyInput input = box("box", 0);
  input.velocity = {1.5, 0, 0};
  World world({input}, one(plane(kFriction)), {});
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  double normal = 0;
  for (int step = 0; step < 12; ++step) {
    normal = 0;
    for (const ContactMemory& memory : world.body(0).state().contacts) normal += memory.normal_force;
    before = centre_of_mass(world.body(0).model().mass, world.body(0).x());
    world.step();
  }
  const double way = (centre_of_mass(world.body(0).model().mass, world.body(0).x()) - before).x();
  ASSERT_GT(way, 0.005);
  const Hdf5Reader frame = SavedFrame(world).read();
  const Eigen::VectorXd slip = frame.vector("/bodies/box/contacts/slip");
  EXPECT_GT(slip.minCoeff(), 0.5 * way);
  EXPECT_NEAR(slip.mean(), way, 0.2 * way);
  // Coulomb's limit, with the normal forces of the step before.
  const Eigen::Vector3d friction = sum(frame, "/bodies/box/contacts/friction_force");
  EXPECT_NEAR(friction.x(), -kFriction * normal, 0.02 * kFriction * normal);
}

TEST(FrameReport, GoalsAreToldAsMotionsInSpace) {
  World world({box("box", 0, {.model = kStiff, .controller = "{type: hop, heading_deg: 90}"})}, one(plane(1)),
              {});
  for (int step = 0; step < 4; ++step) world.step();
  ASSERT_EQ(world.body(0).controller().phase(), "crouch");
  const Hdf5Reader frame = SavedFrame(world).read();
  const std::string goals = "/bodies/box/goals/";
  const Eigen::VectorXd &mass = world.body(0).model().mass, &x = world.body(0).x(), &v = world.body(0).v();
  const Eigen::Vector3d centre = centre_of_mass(mass, x), velocity = centre_of_mass(mass, v);
  const Eigen::Vector3d spin = inertia_tensor(mass, x).ldlt().solve(angular_momentum(mass, x, v));
  const Eigen::VectorXi turns = frame.int_vector(goals + "turns");
  const Eigen::VectorXd value = frame.vector(goals + "value"), rate = frame.vector(goals + "rate"),
                        target = frame.vector(goals + "value_target"),
                        weight = frame.vector(goals + "value_weight");
  ASSERT_EQ(turns.size(), 6);
  EXPECT_EQ(turns.sum(), 3);
  Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
  for (Eigen::Index i = 0; i < turns.size(); ++i) {
    const Eigen::Vector3d axis = frame.matrix(goals + "axis").row(i),
                          place = frame.matrix(goals + "place").row(i);
    EXPECT_NEAR(axis.norm(), 1, 1e-12);
    EXPECT_LE((place - centre).norm(), 1e-9);
    if (turns[i] != 0) {
      EXPECT_NEAR(rate[i], axis.dot(spin), 0.02 * spin.norm() + 1e-9);  // the arms are those of the start
    } else {
      EXPECT_NEAR(value[i], axis.dot(centre), 1e-12);
      EXPECT_NEAR(rate[i], axis.dot(velocity), 1e-12);
      axes += axis * axis.transpose();
    }
    if (weight[i] > 0) {
      EXPECT_LE((axis - Eigen::Vector3d::UnitY()).norm(), 1e-9);
      EXPECT_LT(target[i], value[i]);  // it crouches
    }
  }
  EXPECT_LE((axes - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  EXPECT_GT(weight.maxCoeff(), 0);
}

}  // namespace
}  // namespace vivify::sim

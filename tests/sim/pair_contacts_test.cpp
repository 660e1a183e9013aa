// Contacts between bodies: derivatives, equal and opposite forces, and what they remember.
#include "sim/contact/pair_contacts.h"

#include <gtest/gtest.h>

#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

// Two triangles' worth of loose points that touch in two places: a point on a face and an edge on an edge.
// Each point is a vertex of its own in an island of twelve vertices.
struct Touching {
  explicit Touching(int dimension, double depth, double friction, double slip) : contacts(dimension) {
    CounterRng rng(7);
    ContactPoints own;
    own.dimension = dimension;
    own.vertices.resize(6, 1);
    own.weights = RowMatrixXd::Ones(6, 1);
    for (int i = 0; i < 6; ++i) own.vertices(i, 0) = i;
    x = random_vector(12 * dimension, 0.3, rng);
    Eigen::Vector3d normal = Eigen::Vector3d(random_vector(3, 1, rng));
    if (dimension == 2) normal.z() = 0;
    normal.normalize();
    const MaterialPlace point{{0, -1, -1}, {1, 0, 0}}, face{{0, 1, 2}, {0.2, 0.5, 0.3}};
    const MaterialPlace edge_a{{3, 4, -1}, {0.3, 0.7, 0}}, edge_b{{4, 5, -1}, {0.6, 0.4, 0}};
    for (const auto& [a, b, kind] : {std::tuple(point, face, 0), std::tuple(edge_a, edge_b, 2)}) {
      PairContact contact{{0, 1, kind, 0, -1},    a, b, a, b, {}, {}, normal, 0, {5e4, 0.01}, {},
                          Friction(900, friction)};
      if (kind == 0) contact.anchor_b = {{0, 1, 2}, {0.1, 0.4, 0.5}};  // it has slid over the face
      contact.gap.add(own, contact.place_a, 0, 1);
      contact.gap.add(own, contact.place_b, 6, -1);
      contact.slip.add(own, contact.anchor_a, 0, 1);
      contact.slip.add(own, contact.anchor_b, 6, -1);
      // Shift the surfaces so that they overlap by `depth`, and the anchors so that they have slipped.
      contact.thickness = normal.dot(contact.gap.position(x, dimension)) - 0.01 + depth;
      Eigen::Vector3d along = normal.unitOrthogonal();
      if (dimension == 2) along = {-normal.y(), normal.x(), 0};
      contact.offset = contact.slip.position(x, dimension) - slip * along;
      contacts.add(std::move(contact));
    }
    pattern = std::make_unique<SymmetricPattern>(12, dimension);
    for (int i = 0; i < 12; ++i) pattern->couple(&i, 1);
    for (const std::vector<int>& vertices : contacts.couplings())
      pattern->couple(vertices.data(), static_cast<int>(vertices.size()));
    pattern->finish();
    contacts.bind(*pattern);
  }

  PairContacts contacts;
  std::unique_ptr<SymmetricPattern> pattern;
  Vector x;
};

struct Regime {
  double depth, friction, slip;
};
void PrintTo(const Regime& regime, std::ostream* out) {
  *out << "depth " << regime.depth << " friction " << regime.friction << " slip " << regime.slip;
}

class PairContactDerivatives : public ::testing::TestWithParam<std::tuple<int, Regime>> {};

TEST_P(PairContactDerivatives, MatchFiniteDifferences) {
  const auto [dimension, regime] = GetParam();
  const Touching touching(dimension, regime.depth, regime.friction, regime.slip);
  const PairContacts& contacts = touching.contacts;
  const auto energy = [&](const Vector& x) { return Vector::Constant(1, contacts.energy(x)); };
  const auto gradient = [&](const Vector& x) {
    Vector g = Vector::Zero(x.size());
    contacts.add_gradient(x, g);
    return g;
  };
  const auto hessian = [&](const Vector& x) {
    SymmetricMatrix H(*touching.pattern);
    contacts.add_hessian(x, H);
    return dense(H);
  };
  const double eps = 1e-7;
  EXPECT_LE(relative(gradient(touching.x).transpose(), differences(energy, touching.x, eps)), 1e-6);
  EXPECT_LE(relative(hessian(touching.x), differences(gradient, touching.x, eps)), 1e-6);
  CounterRng rng(3);
  const Vector l = random_vector(touching.x.size(), 1, rng);
  SymmetricMatrix A(*touching.pattern);
  contacts.add_block_a(touching.x, l, A);
  const Matrix expected = (hessian(touching.x + eps * l) - hessian(touching.x - eps * l)) / (2 * eps);
  EXPECT_LE((dense(A) - expected).norm(), 1e-6 * expected.norm() + 1e-7 * hessian(touching.x).norm());
}

// Pressed and apart; sticking, slipping, unlimited and without friction; both sides of each switch.
INSTANTIATE_TEST_SUITE_P(
    Every, PairContactDerivatives,
    ::testing::Combine(::testing::Values(2, 3),
                       ::testing::Values(Regime{0.004, 2, 0.001}, Regime{0.004, 2, 0.009},
                                         Regime{0.004, 2, 0.00443}, Regime{0.004, 2, 0.00446},
                                         Regime{0.004, INFINITY, 0.002}, Regime{0.004, 0, 0.002},
                                         Regime{1e-5, 2, 0.001}, Regime{-1e-5, 2, 0.001})));

TEST(PairContacts, ForcesAreEqualAndOpposite) {
  const Touching touching(3, 0.004, 2, 0.003);
  Vector g = Vector::Zero(touching.x.size());
  touching.contacts.add_gradient(touching.x, g);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), on_a = Eigen::Vector3d::Zero();
  for (int i = 0; i < 12; ++i) {
    sum += g.segment<3>(3 * i);
    if (i < 6) on_a -= g.segment<3>(3 * i);
  }
  EXPECT_LE(sum.norm(), 1e-14 * g.norm());
  Eigen::Vector3d told = Eigen::Vector3d::Zero();
  for (const PairContact& contact : touching.contacts.contacts())
    told += touching.contacts.force_on_a(contact, touching.x);
  EXPECT_LE((told - on_a).norm(), 1e-13 * told.norm());
}

TEST(PairContacts, AnchorsStayWhileTheyStickAndFollowWhenTheySlip) {
  const Touching sticks(3, 0.004, 2, 0.001), slips(3, 0.004, 2, 0.02), apart(3, -0.001, 2, 0.001);
  const auto memory = sticks.contacts.memory(sticks.x);
  ASSERT_EQ(memory.size(), 2u);
  EXPECT_EQ(memory[0].b.weights, sticks.contacts.contacts()[0].anchor_b.weights);
  EXPECT_EQ(memory[0].offset, sticks.contacts.contacts()[0].offset);
  const auto moved = slips.contacts.memory(slips.x);
  EXPECT_EQ(moved[0].b.weights, slips.contacts.contacts()[0].place_b.weights);
  // The remaining offset is the largest that friction bears.
  const PairContact& contact = slips.contacts.contacts()[0];
  const Eigen::Vector3d gap = contact.gap.position(slips.x, 3);
  const Eigen::Vector3d left = gap - contact.normal * contact.normal.dot(gap) - moved[0].offset;
  EXPECT_NEAR(left.norm(), contact.friction.slip_limit(), 1e-12);
  EXPECT_TRUE(apart.contacts.memory(apart.x).empty());
}

}  // namespace
}  // namespace vivify::sim

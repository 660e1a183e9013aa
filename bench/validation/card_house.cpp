#include <cmath>
#include <numbers>

#include "bench/validation/problem.h"
#include "bench/validation/standing.h"

namespace vivify::validation {
namespace {

constexpr double kLength = 0.2, kWidth = 0.14, kThickness = 0.004;  // of a card, m
constexpr double kLean = 20;                                        // ° from the vertical

// A card whose middle line runs from `from` to `to` (x, y), of cells across z.
SimMesh card(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  constexpr int kAlong = 4, kAcross = 3;
  SimMesh mesh{RowMatrixXd((kAlong + 1) * (kAcross + 1), 3), RowMatrixXi(2 * kAlong * kAcross, 3)};
  int t = 0;
  for (int i = 0; i <= kAlong; ++i) {
    for (int k = 0; k <= kAcross; ++k) {
      const Eigen::Vector2d y = from + (to - from) * i / kAlong;
      const int a = i * (kAcross + 1) + k, b = a + kAcross + 1;
      mesh.V.row(a) << y.x(), y.y(), kWidth * k / kAcross - kWidth / 2;
      if (i == kAlong || k == kAcross) continue;
      if ((i + k) % 2 == 0) {
        mesh.E.row(t++) << a, a + 1, b;
        mesh.E.row(t++) << b, a + 1, b + 1;
      } else {
        mesh.E.row(t++) << a, a + 1, b + 1;
        mesh.E.row(t++) << a, b + 1, b;
      }
    }
  }
  return mesh;
}

// Two cards that lean against one another over x at height y.
void lean(double x, double y, std::vector<SimMesh>& cards) {
  const double angle = kLean * std::numbers::pi / 180, apart = kThickness / (2 * std::cos(angle));
  const Eigen::Vector2d reach(kLength * std::sin(angle), kLength * std::cos(angle));
  for (const double side : {-1.0, 1.0}) {
    cards.push_back(card({x + side * (apart + reach.x()), y}, {x + side * apart, y + reach.y()}));
  }
}

// Storeys of leaning pairs with one flat card over each but the last, from the ground up.
std::vector<SimMesh> house(int storeys) {
  const double angle = kLean * std::numbers::pi / 180;
  const double pitch = 2 * kLength * std::sin(angle) + 3 * kThickness, rise = kLength * std::cos(angle);
  std::vector<SimMesh> cards;
  double y = 0;
  for (int pairs = storeys; pairs > 0; --pairs) {
    for (int i = 0; i < pairs; ++i) lean((i - 0.5 * (pairs - 1)) * pitch, y, cards);
    y += rise + kThickness;
    if (pairs > 1) {
      const double half = 0.5 * (pairs - 2) * pitch + 0.5 * kLength;
      cards.push_back(card({-half, y}, {half, y}));
    }
    y += kThickness;
  }
  return cards;
}

Standing stand(int storeys, double h) {
  std::vector<sim::BodyInput> bodies;
  for (const SimMesh& mesh : house(storeys)) {
    bodies.push_back(
        standing_body(mesh,
                      "{type: shell3d, density: 1, stiffness: 3000, bending_stiffness: 1, thickness: "
                      "0.004, damping_s: 0.01}",
                      "card" + std::to_string(bodies.size())));
  }
  sim::World world(bodies, inclined_plane(1), {{0, -kGravity, 0}, h});
  return watch_standing(world, h, world.body_count() - 1);
}

}  // namespace

Result card_house(Effort effort) {
  Result result;
  result.title = "A house of cards";
  result.text =
      "Cards (`shell3d`, 0.2 m by 0.14 m, 4 mm thick) that lean against one another at 20° to the "
      "vertical, with a flat card between two storeys; μ = 1. After one second of settling no centre "
      "of a card may move by more than 1 mm in 5 s.";
  Plot plot{"card_house", "Height of the highest card of a house", "t (s)", "height (m)"};
  const std::vector<int> storeys = effort == Effort::full ? std::vector<int>{1, 2, 3} : std::vector<int>{2};
  for (const int count : storeys) {
    Standing standing = stand(count, 0.01);
    const std::string name = std::to_string(count) + (count == 1 ? " storey" : " storeys");
    result.figure(name + ": largest motion of a centre in 5 s, m", standing.drift, 0, 1e-3);
    result.figure(name + ": sinking of the highest card, m", standing.sunk, 0, 0.01);
    standing.height.name = name;
    plot.curves.push_back(std::move(standing.height));
  }
  result.plots.push_back(std::move(plot));
  return result;
}

}  // namespace vivify::validation

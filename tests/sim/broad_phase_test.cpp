// Trees of boxes and the sweep over bodies against all pairs.
#include "sim/contact/broad_phase.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/sim/contact_shapes.h"

namespace vivify::sim {
namespace {

BoundingBox box_of(const Shape& shape, int face) {
  BoundingBox box;
  for (int k = 0; k < 3; ++k) box.extend(shape.V.row(shape.F(face, k)).transpose());
  return box;
}

// Triangles with corners of their own, each about `size` large, in a box of edge 2.
Shape soup(int count, double size, CounterRng& rng) {
  Shape shape{Points(3 * count, 3), RowMatrixXi(count, 3)};
  for (int f = 0; f < count; ++f) {
    const Eigen::Vector3d centre = random_point(1, rng);
    for (int k = 0; k < 3; ++k) {
      shape.V.row(3 * f + k) = (centre + random_point(size, rng)).transpose();
      shape.F(f, k) = 3 * f + k;
    }
  }
  return shape;
}

TEST(BoxTree, VisitsExactlyTheNearPairs) {
  CounterRng rng(1);
  for (const int count : {1, 2, 3, 50, 121}) {
    Shape a = soup(count, 0.1, rng), b = soup(70, 0.2, rng);
    BoxTree tree_a(a.F, a.V);
    const BoxTree tree_b(b.F, b.V);
    for (const double reach : {0.0, 0.07}) {
      a = soup(count, 0.1, rng);  // the tree stays, the points move
      tree_a.refit(a.F, a.V);
      std::multiset<std::pair<int, int>> found, expected;
      BoxTree::visit_pairs(tree_a, tree_b, reach, [&](int i, int j) { found.emplace(i, j); });
      for (int i = 0; i < count; ++i) {
        for (int j = 0; j < 70; ++j) {
          if (std::sqrt(box_distance2(box_of(a, i), box_of(b, j))) <= reach) expected.emplace(i, j);
        }
      }
      EXPECT_EQ(found, expected);
    }
  }
}

TEST(BoxTree, VisitsTheNearestAndFewOthers) {
  CounterRng rng(2);
  const Shape shape = soup(400, 0.05, rng);
  const BoxTree tree(shape.F, shape.V);
  int visits = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Vector3d p = random_point(1.5, rng);
    double expected = INFINITY, bound2 = INFINITY;
    for (int f = 0; f < 400; ++f) expected = std::min(expected, box_of(shape, f).squaredExteriorDistance(p));
    tree.visit_near(p, bound2, [&](int f) {
      bound2 = std::min(bound2, box_of(shape, f).squaredExteriorDistance(p));
      ++visits;
    });
    EXPECT_EQ(bound2, expected);
  }
  EXPECT_LT(visits, 200 * 40);
}

TEST(BoxTree, VisitsTheElementsThatABoxMeets) {
  CounterRng rng(5);
  const Shape shape = soup(150, 0.1, rng);
  const BoxTree tree(shape.F, shape.V);
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Vector3d centre = random_point(1, rng), half = random_point(0.3, rng).cwiseAbs();
    const BoundingBox box(centre - half, centre + half);
    std::multiset<int> found, expected;
    tree.visit_near(box, [&](int f) { found.insert(f); });
    for (int f = 0; f < 150; ++f) {
      if (box_of(shape, f).intersects(box)) expected.insert(f);
    }
    EXPECT_EQ(found, expected);
  }
}

TEST(BoxTree, OfAMotionHoldsItsBeginningAndItsEnd) {
  CounterRng rng(3);
  const Shape begin = soup(60, 0.05, rng), end = soup(60, 0.05, rng), other = soup(60, 0.05, rng);
  BoxTree tree(begin.F, begin.V);
  tree.refit(begin.F, begin.V, end.V);
  std::set<std::pair<int, int>> found, expected;
  BoxTree::visit_pairs(tree, BoxTree(other.F, other.V), 0, [&](int i, int j) { found.emplace(i, j); });
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 60; ++j) {
      if (box_of(begin, i).merged(box_of(end, i)).intersects(box_of(other, j))) expected.emplace(i, j);
    }
  }
  EXPECT_EQ(found, expected);
}

TEST(BoxTree, OfNothing) {
  const BoxTree nothing(RowMatrixXi(0, 3), Points(0, 3));
  EXPECT_TRUE(nothing.empty() && nothing.box().isEmpty());
  BoxTree::visit_pairs(nothing, nothing, 1, [](int, int) { FAIL(); });
  nothing.visit_near(Eigen::Vector3d::Zero(), INFINITY, [](int) { FAIL(); });
}

TEST(NearBoxes, AreThoseOfAllPairs) {
  CounterRng rng(4);
  for (const int count : {0, 1, 2, 200}) {
    std::vector<BoundingBox> boxes;
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d centre = random_point(1, rng), half = random_point(0.15, rng).cwiseAbs();
      boxes.emplace_back(centre - half, centre + half);
    }
    if (count == 200) {
      boxes[7] = BoundingBox();                                                          // empty
      boxes[9] = BoundingBox(boxes[8].max(), boxes[8].max() + Eigen::Vector3d::Ones());  // touch in a corner
      boxes[10] = boxes[11];
    }
    for (const double reach : {0.0, 0.1}) {
      std::vector<std::pair<int, int>> expected;
      for (int i = 0; i < count; ++i) {
        for (int j = i + 1; j < count; ++j) {
          if (boxes[i].isEmpty() || boxes[j].isEmpty()) continue;
          if (std::sqrt(boxes[i].squaredExteriorDistance(boxes[j])) <= reach) expected.emplace_back(i, j);
        }
      }
      EXPECT_EQ(near_boxes(boxes, reach), expected);
    }
  }
}

}  // namespace
}  // namespace vivify::sim

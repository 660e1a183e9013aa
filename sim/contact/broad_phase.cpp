#include "sim/contact/broad_phase.h"

#include <algorithm>
#include <numeric>

namespace vivify::sim {
namespace {

BoundingBox box_of(const RowMatrixXi& elements, Eigen::Index element, const Points& points) {
  BoundingBox box;
  for (Eigen::Index k = 0; k < elements.cols(); ++k) {
    box.extend(points.row(elements(element, k)).transpose());
  }
  return box;
}

}  // namespace

BoxTree::BoxTree(const RowMatrixXi& elements, const Points& points) {
  const auto count = static_cast<int>(elements.rows());
  if (count == 0) return;
  std::vector<Eigen::Vector3d> centres(static_cast<std::size_t>(count));
  for (int e = 0; e < count; ++e) centres[e] = box_of(elements, e, points).center();
  std::vector<int> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  nodes_.reserve(static_cast<std::size_t>(2 * count - 1));
  build(0, count, order, centres);
  refit(elements, points);
}

void BoxTree::build(int first, int count, std::vector<int>& order,
                    const std::vector<Eigen::Vector3d>& centres) {
  const std::size_t node = nodes_.size();
  nodes_.emplace_back();
  if (count == 1) {
    nodes_[node].element = order[first];
    return;
  }
  BoundingBox spread;
  for (int i = first; i < first + count; ++i) spread.extend(centres[order[i]]);
  Eigen::Index axis = 0;
  spread.sizes().maxCoeff(&axis);
  const int half = count / 2;
  const auto begin = order.begin() + first;
  std::nth_element(begin, begin + half, begin + count, [&](int a, int b) {
    return std::pair(centres[a][axis], a) < std::pair(centres[b][axis], b);
  });
  build(first, half, order, centres);
  nodes_[node].right = static_cast<int>(nodes_.size());
  build(first + half, count - half, order, centres);
}

template <class BoxOf>
void BoxTree::refit_boxes(const BoxOf& element_box) {
  for (std::size_t i = nodes_.size(); i-- > 0;) {  // children follow their parents
    Node& node = nodes_[i];
    node.box = node.right < 0 ? element_box(node.element) : nodes_[i + 1].box.merged(nodes_[node.right].box);
  }
}

void BoxTree::refit(const RowMatrixXi& elements, const Points& points) {
  refit_boxes([&](int element) { return box_of(elements, element, points); });
}

void BoxTree::refit(const RowMatrixXi& elements, const Points& begin, const Points& end) {
  refit_boxes(
      [&](int element) { return box_of(elements, element, begin).merged(box_of(elements, element, end)); });
}

std::vector<std::pair<int, int>> near_boxes(const std::vector<BoundingBox>& boxes, double reach) {
  BoundingBox spread;
  std::vector<int> order;
  for (int i = 0; i < static_cast<int>(boxes.size()); ++i) {
    if (boxes[i].isEmpty()) continue;
    order.push_back(i);
    spread.extend(boxes[i].center());
  }
  std::vector<std::pair<int, int>> pairs;
  if (order.empty()) return pairs;
  Eigen::Index axis = 0;
  spread.sizes().maxCoeff(&axis);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return std::pair(boxes[a].min()[axis], a) < std::pair(boxes[b].min()[axis], b);
  });
  std::vector<int> open;  // boxes that the sweep has entered and not yet left
  for (const int i : order) {
    std::erase_if(open, [&](int j) { return boxes[j].max()[axis] + reach < boxes[i].min()[axis]; });
    for (const int j : open) {
      if (box_distance2(boxes[i], boxes[j]) <= reach * reach) pairs.emplace_back(std::minmax(i, j));
    }
    open.push_back(i);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace vivify::sim

#include "sim/solve/elimination_fronts.h"

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <limits>
#include <numeric>

#include "common/rng.h"

namespace vivify::sim {
namespace {

// Minimum degree decides ties by the numbers of the vertices, to very different fill: the best of some
// numberings is kept.
constexpr int kNumberings = 12;

using Graph = std::vector<std::vector<int>>;  // neighbours of every vertex, without itself

Graph vertex_graph(const Eigen::SparseMatrix<double>& lower, int dim) {
  Graph graph(static_cast<std::size_t>(lower.cols() / dim));
  for (int column = 0; column < lower.cols(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(lower, column); it; ++it) {
      const int a = static_cast<int>(it.row()) / dim, b = column / dim;
      if (a == b) continue;
      graph[a].push_back(b);
      graph[b].push_back(a);
    }
  }
  for (std::vector<int>& neighbours : graph) {
    std::sort(neighbours.begin(), neighbours.end());
    neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
  }
  return graph;
}

// Vertices in the order of approximate minimum degree; `numbering` lists the vertices in the order that
// decides ties.
std::vector<int> minimum_degree_order(const Graph& graph, const std::vector<int>& numbering) {
  const int count = static_cast<int>(graph.size());
  std::vector<int> number(graph.size());
  for (int i = 0; i < count; ++i) number[numbering[i]] = i;
  std::vector<Eigen::Triplet<double>> entries;
  for (int v = 0; v < count; ++v) {
    entries.emplace_back(v, v, 1.0);
    for (const int u : graph[v]) entries.emplace_back(number[u], number[v], 1.0);
  }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(matrix, permutation);
  std::vector<int> order(graph.size());
  for (int i = 0; i < count; ++i) order[i] = numbering[permutation.indices()[i]];
  return order;
}

struct TreeFront : Front {
  std::vector<int> children;
};

// The elimination tree with the rows of every column of L, one vertex to a front.
std::vector<TreeFront> elimination_tree(const Graph& graph, const std::vector<int>& order) {
  const int count = static_cast<int>(graph.size());
  std::vector<int> position(graph.size()), seen(graph.size(), -1);
  for (int i = 0; i < count; ++i) position[order[i]] = i;
  std::vector<TreeFront> fronts(graph.size());
  for (int j = 0; j < count; ++j) {
    TreeFront& front = fronts[j];
    front.columns = {j};
    const auto add = [&](int row) {
      if (row <= j || seen[row] == j) return;
      seen[row] = j;
      front.rows.push_back(row);
    };
    for (const int neighbour : graph[order[j]]) add(position[neighbour]);
    for (const int child : front.children) {
      std::for_each(fronts[child].rows.begin(), fronts[child].rows.end(), add);
    }
    if (front.rows.empty()) continue;
    fronts[*std::min_element(front.rows.begin(), front.rows.end())].children.push_back(j);
  }
  return fronts;
}

// Estimated time of a front in processor cycles: its handling, writing and reading its entries, the products,
// and adding the update of the rows below to other fronts.
double front_cost(const Front& front, std::size_t more_columns, int dim) {
  constexpr double kHandling = 250, kEntry = 3, kFlop = 1.0 / 12, kUpdate = 0.75;
  const double width = dim * static_cast<double>(front.columns.size() + more_columns);
  const double below = dim * static_cast<double>(front.rows.size());
  return kHandling + kEntry * width * (width + below) + kFlop * elimination_flops(width, below) +
         kUpdate * below * below;
}

// Merges fronts into their parents wherever that is estimated to save time; fronts without columns are left.
void merge_fronts(std::vector<TreeFront>& fronts, int dim) {
  for (TreeFront& parent : fronts) {
    for (;;) {
      const double own_cost = front_cost(parent, 0, dim);
      double best_gain = 0;
      auto best = parent.children.end();
      for (auto child = parent.children.begin(); child != parent.children.end(); ++child) {
        const double gain = own_cost + front_cost(fronts[*child], 0, dim) -
                            front_cost(parent, fronts[*child].columns.size(), dim);
        if (gain <= best_gain) continue;
        best_gain = gain;
        best = child;
      }
      if (best == parent.children.end()) break;
      TreeFront merged = std::move(fronts[*best]);
      fronts[*best] = {};
      parent.children.erase(best);
      parent.children.insert(parent.children.end(), merged.children.begin(), merged.children.end());
      parent.columns.insert(parent.columns.begin(), merged.columns.begin(), merged.columns.end());
    }
  }
}

double total_cost(const std::vector<TreeFront>& fronts, int dim) {
  double cost = 0;
  for (const Front& front : fronts) {
    if (!front.columns.empty()) cost += front_cost(front, 0, dim);
  }
  return cost;
}

// Numbers of the fronts, children right before their parents.
std::vector<int> postorder(const std::vector<TreeFront>& fronts) {
  std::vector<int> result, open;
  for (std::size_t root = 0; root < fronts.size(); ++root) {
    if (!fronts[root].columns.empty() && fronts[root].rows.empty()) open.push_back(static_cast<int>(root));
  }
  while (!open.empty()) {  // parents before their children, then turned round
    result.push_back(open.back());
    open.pop_back();
    const std::vector<int>& children = fronts[result.back()].children;
    open.insert(open.end(), children.begin(), children.end());
  }
  std::reverse(result.begin(), result.end());
  return result;
}

}  // namespace

double elimination_flops(double width, double below) {
  return width * width * width / 3 + width * width * below + width * below * below;
}

Elimination order_elimination(const Eigen::SparseMatrix<double>& lower, int dim) {
  const Graph graph = vertex_graph(lower, dim);
  std::vector<int> numbering(graph.size()), order;
  std::iota(numbering.begin(), numbering.end(), 0);
  std::vector<TreeFront> fronts;
  double least_cost = std::numeric_limits<double>::infinity();
  CounterRng rng(0);
  for (int i = 0; i < kNumberings; ++i) {
    const std::vector<int> candidate = minimum_degree_order(graph, numbering);
    std::vector<TreeFront> merged = elimination_tree(graph, candidate);
    merge_fronts(merged, dim);
    const double cost = total_cost(merged, dim);
    if (cost < least_cost) {
      least_cost = cost;
      order = candidate;
      fronts = std::move(merged);
    }
    for (std::size_t k = graph.size(); k > 1; --k) std::swap(numbering[k - 1], numbering[rng.next() % k]);
  }

  Elimination result;
  std::vector<int> renumbered(graph.size());  // from the order of minimum degree to that of the fronts
  result.position.resize(graph.size());
  int next = 0;
  for (const int index : postorder(fronts)) {
    result.fronts.push_back(std::move(fronts[index]));
    for (int& vertex : result.fronts.back().columns) {
      result.position[order[vertex]] = next;
      renumbered[vertex] = next;
      vertex = next++;
    }
  }
  for (Front& front : result.fronts) {
    for (int& vertex : front.rows) vertex = renumbered[vertex];
    std::sort(front.rows.begin(), front.rows.end());
  }
  return result;
}

}  // namespace vivify::sim

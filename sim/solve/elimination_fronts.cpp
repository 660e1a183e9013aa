#include "sim/solve/elimination_fronts.h"

#include <metis.h>

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <limits>
#include <mutex>
#include <numeric>

#include "common/error.h"
#include "common/rng.h"

namespace vivify::sim {
namespace {

// Minimum degree decides ties by the numbers of the vertices, to very different fill: the best of some
// numberings is kept.
constexpr int kNumberings = 12;
// Of graphs of so many vertices, dissection is tried too, and finds less fill in solids; few numberings then.
constexpr int kDissected = 1500, kNumberingsOfDissected = 2;
constexpr int kLeaf = 120;  // vertices that are not dissected further

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

enum Part { kFirst, kSecond, kSeparator, kParts };

// The Part of every vertex: no edge joins the first and the second, which are about equal.
std::vector<idx_t> separate(const Graph& graph) {
  std::vector<idx_t> begins = {0}, neighbours;
  for (const std::vector<int>& of_vertex : graph) {
    neighbours.insert(neighbours.end(), of_vertex.begin(), of_vertex.end());
    begins.push_back(static_cast<idx_t>(neighbours.size()));
  }
  idx_t count = static_cast<idx_t>(graph.size()), separator_size = 0;
  std::vector<idx_t> weights(graph.size(), 1), parts(graph.size());
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  options[METIS_OPTION_UFACTOR] = 200;  // parts up to 1.2 times as large as even ones
  // METIS seeds and draws the random numbers of the C library, which are those of the whole process.
  static std::mutex random_numbers;
  const std::lock_guard lock(random_numbers);
  if (METIS_ComputeVertexSeparator(&count, begins.data(), neighbours.data(), weights.data(), options,
                                   &separator_size, parts.data()) != METIS_OK) {
    throw Error(
        ErrorKind::numerical, "no order of elimination was found",
        "METIS failed on a graph of " + std::to_string(count) + " vertices; there may be too little memory");
  }
  return parts;
}

// Vertices in the order of nested dissection (George 1973): both sides of a separator, each dissected
// likewise, before the separator.
std::vector<int> dissection_order(const Graph& graph) {
  std::vector<int> order, local(graph.size(), -1);
  std::vector<std::vector<int>> open(1, std::vector<int>(graph.size()));
  std::iota(open[0].begin(), open[0].end(), 0);
  while (!open.empty()) {  // from the last vertices to the first
    const std::vector<int> vertices = std::move(open.back());
    open.pop_back();
    const int count = static_cast<int>(vertices.size());
    for (int i = 0; i < count; ++i) local[vertices[i]] = i;
    Graph part(vertices.size());
    for (int i = 0; i < count; ++i) {
      for (const int neighbour : graph[vertices[i]]) {
        if (local[neighbour] >= 0) part[i].push_back(local[neighbour]);
      }
    }
    for (const int vertex : vertices) local[vertex] = -1;
    std::vector<int> parts[kParts];
    if (count > kLeaf) {
      const std::vector<idx_t> part_of = separate(part);
      for (int i = 0; i < count; ++i) parts[part_of[i]].push_back(vertices[i]);
    }
    if (parts[kFirst].empty() || parts[kSecond].empty()) {
      std::vector<int> numbering(vertices.size());
      std::iota(numbering.begin(), numbering.end(), 0);
      const std::vector<int> leaf = minimum_degree_order(part, numbering);
      std::for_each(leaf.rbegin(), leaf.rend(), [&](int i) { order.push_back(vertices[i]); });
    } else {
      order.insert(order.end(), parts[kSeparator].rbegin(), parts[kSeparator].rend());
      open.push_back(std::move(parts[kFirst]));
      open.push_back(std::move(parts[kSecond]));
    }
  }
  std::reverse(order.begin(), order.end());
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
  const auto compare = [&](const std::vector<int>& candidate) {
    std::vector<TreeFront> merged = elimination_tree(graph, candidate);
    merge_fronts(merged, dim);
    const double cost = total_cost(merged, dim);
    if (cost >= least_cost) return;
    least_cost = cost;
    order = candidate;
    fronts = std::move(merged);
  };
  const bool dissected = static_cast<int>(graph.size()) >= kDissected;
  if (dissected) compare(dissection_order(graph));
  CounterRng rng(0);
  for (int i = 0; i < (dissected ? kNumberingsOfDissected : kNumberings); ++i) {
    compare(minimum_degree_order(graph, numbering));
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

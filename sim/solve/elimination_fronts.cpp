#include "sim/solve/elimination_fronts.h"

#include <metis.h>

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <mutex>
#include <numeric>

#include "common/error.h"
#include "common/parallel.h"
#include "common/rng.h"

namespace vivify::sim {
namespace {

// Minimum degree decides ties by the numbers of the vertices, to very different fill: the best of some
// numberings is kept.
constexpr int kNumberings = 12;
// Of graphs of so many vertices, dissection is tried too, and finds less fill in solids; few numberings then.
constexpr int kDissected = 1500, kNumberingsOfDissected = 2;
constexpr int kLeaf = 120;  // vertices that are not dissected further
// An elimination that costs so many cycles is divided into subtrees that cost between two shares of it.
constexpr double kDividedCost = 2e6, kLeastShare = 0.01, kMostShare = 0.25;

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

// Moves the fronts of the subtrees to the beginning of the order, and returns where each ends.
std::vector<int> divide(const std::vector<TreeFront>& fronts, int dim, double total,
                        std::vector<int>& order) {
  if (total < kDividedCost) return {};
  std::vector<double> cost(fronts.size(), 0);  // of everything below
  std::vector<int> root_of(fronts.size(), -1);
  for (const int i : order) {
    cost[i] += front_cost(fronts[i], 0, dim);
    for (const int child : fronts[i].children) cost[i] += cost[child];
  }
  for (auto i = order.rbegin(); i != order.rend(); ++i) {
    if (root_of[*i] < 0 && cost[*i] >= kLeastShare * total && cost[*i] <= kMostShare * total)
      root_of[*i] = *i;
    for (const int child : fronts[*i].children) root_of[child] = root_of[*i];
  }
  const auto outside =
      std::stable_partition(order.begin(), order.end(), [&](int i) { return root_of[i] >= 0; });
  std::vector<int> ends;
  for (auto i = order.begin(); i != outside; ++i) {
    if (root_of[*i] == *i) ends.push_back(static_cast<int>(i - order.begin()) + 1);
  }
  return ends;
}

}  // namespace

double elimination_flops(double width, double below) {
  return width * width * width / 3 + width * width * below + width * below * below;
}

Elimination order_elimination(const Eigen::SparseMatrix<double>& lower, int dim) {
  const Graph graph = vertex_graph(lower, dim);
  const bool dissected = static_cast<int>(graph.size()) >= kDissected;
  std::vector<std::vector<int>> numberings(dissected ? kNumberingsOfDissected : kNumberings,
                                           std::vector<int>(graph.size()));
  std::iota(numberings[0].begin(), numberings[0].end(), 0);
  CounterRng rng(0);
  for (std::size_t i = 1; i < numberings.size(); ++i) {
    numberings[i] = numberings[i - 1];
    for (std::size_t k = graph.size(); k > 1; --k)
      std::swap(numberings[i][k - 1], numberings[i][rng.next() % k]);
  }
  struct Candidate {
    std::vector<int> order;
    std::vector<TreeFront> fronts;
    double cost;
  };
  std::vector<Candidate> candidates(numberings.size() + (dissected ? 1 : 0));
  parallel_for(candidates.size(), [&](std::size_t i) {
    Candidate& candidate = candidates[i];
    const bool by_degree = !dissected || i > 0;
    candidate.order =
        by_degree ? minimum_degree_order(graph, numberings[dissected ? i - 1 : i]) : dissection_order(graph);
    candidate.fronts = elimination_tree(graph, candidate.order);
    merge_fronts(candidate.fronts, dim);
    candidate.cost = total_cost(candidate.fronts, dim);
  });
  auto& [order, fronts, cost] =
      *std::min_element(candidates.begin(), candidates.end(),
                        [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });

  Elimination result;
  std::vector<int> renumbered(graph.size());  // from the order of minimum degree to that of the fronts
  result.position.resize(graph.size());
  int next = 0;
  std::vector<int> front_order = postorder(fronts);
  result.subtree_ends = divide(fronts, dim, cost, front_order);
  for (const int index : front_order) {
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

#include "meshing/embedding.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <unsupported/Eigen/BVH>
#include <vector>

#include "common/error.h"
#include "common/parallel.h"
#include "meshing/enclosure.h"

namespace vivify::meshing {
namespace {

using AlignedBox = Eigen::AlignedBox3d;
using Tree = Eigen::KdBVH<double, 3, int>;

// Rest shape of the tetrahedra, prepared for barycentric coordinates.
class TetSet {
 public:
  explicit TetSet(const TetMesh& mesh) : mesh_(mesh), inverse_(static_cast<std::size_t>(mesh.T.rows())) {
    const double diagonal = bounding_box(mesh.V).diagonal();
    const Eigen::VectorXd volumes = tet_volumes(mesh);
    std::vector<int> ids;
    std::vector<AlignedBox> boxes;
    for (int t = 0; t < mesh.T.rows(); ++t) {
      if (!(volumes[t] > 1e-15 * diagonal * diagonal * diagonal)) continue;
      Eigen::Matrix3d edges;
      AlignedBox box(corner(t, 0));
      for (int k = 1; k < 4; ++k) {
        edges.col(k - 1) = corner(t, k) - corner(t, 0);
        box.extend(corner(t, k));
      }
      inverse_[static_cast<std::size_t>(t)] = edges.inverse();
      ids.push_back(t);
      boxes.push_back(box);
    }
    if (ids.empty()) {
      throw Error(ErrorKind::geometry, "the simulation mesh has no tetrahedron of positive volume");
    }
    tree_.init(ids.begin(), ids.end(), boxes.begin(), boxes.end());
  }

  const Tree& tree() const { return tree_; }

  Eigen::RowVector4d barycentric(int t, const Eigen::Vector3d& p) const {
    const Eigen::Matrix3d& inverse = inverse_[static_cast<std::size_t>(t)];
    Eigen::Vector3d b = inverse * (p - corner(t, 0));
    // One refinement step: flat tetrahedra lose digits in the inverse.
    Eigen::Vector3d residual = p - corner(t, 0);
    for (int k = 1; k < 4; ++k) residual -= b[k - 1] * (corner(t, k) - corner(t, 0));
    b += inverse * residual;
    return {1 - b.sum(), b[0], b[1], b[2]};
  }

  // Squared distance of p to tetrahedron t, 0 inside.
  double squared_distance(int t, const Eigen::Vector3d& p) const {
    const Eigen::RowVector4d b = barycentric(t, p);
    double nearest = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 4; ++k) {
      if (b[k] >= 0) continue;  // only faces seen from p hold the closest point
      const Eigen::Vector3d q =
          closest_on_triangle(p, corner(t, (k + 1) % 4), corner(t, (k + 2) % 4), corner(t, (k + 3) % 4));
      nearest = std::min(nearest, (q - p).squaredNorm());
    }
    return b.minCoeff() >= 0 ? 0 : nearest;
  }

 private:
  Eigen::Vector3d corner(int t, int k) const { return mesh_.V.row(mesh_.T(t, k)); }

  const TetMesh& mesh_;
  std::vector<Eigen::Matrix3d> inverse_;
  Tree tree_;
};

// Visitors of Eigen's bounding volume hierarchy.
struct Nearest {
  using Scalar = double;
  const TetSet& tets;
  Eigen::Vector3d p;
  int best = -1;
  double best_distance = std::numeric_limits<double>::infinity();

  double minimumOnVolume(const AlignedBox& box) const { return box.squaredExteriorDistance(p); }
  double minimumOnObject(int t) {
    const double distance = tets.squared_distance(t, p);
    if (distance < best_distance || (distance == best_distance && t < best)) {
      best = t;
      best_distance = distance;
    }
    return distance;
  }
};

struct SmallestWeights {
  const TetSet& tets;
  Eigen::Vector3d p;
  double within;  // squared distance
  int best = -1;
  double best_weight = std::numeric_limits<double>::infinity();

  bool intersectVolume(const AlignedBox& box) const { return box.squaredExteriorDistance(p) <= within; }
  bool intersectObject(int t) {
    if (tets.squared_distance(t, p) > within) return false;
    const double weight = tets.barycentric(t, p).cwiseAbs().maxCoeff();
    if (weight < best_weight || (weight == best_weight && t < best)) {
      best = t;
      best_weight = weight;
    }
    return false;  // look at all of them
  }
};

}  // namespace

Embedding embed(const TetMesh& mesh, const Points& points) {
  if (!points.allFinite()) throw Error(ErrorKind::geometry, "a point to be embedded is not finite");
  const TetSet tets(mesh);
  Embedding embedding;
  embedding.tet.resize(points.rows());
  embedding.weights.resize(points.rows(), 4);
  constexpr Eigen::Index kChunk = 256;
  parallel_for(static_cast<std::size_t>((points.rows() + kChunk - 1) / kChunk), [&](std::size_t chunk) {
    const Eigen::Index begin = static_cast<Eigen::Index>(chunk) * kChunk;
    for (Eigen::Index i = begin; i < std::min(points.rows(), begin + kChunk); ++i) {
      Nearest nearest{tets, points.row(i)};
      Eigen::BVMinimize(tets.tree(), nearest);
      int t = nearest.best;
      if (nearest.best_distance > 0) {
        SmallestWeights smallest{tets, points.row(i), nearest.best_distance * (1 + 1e-12)};
        Eigen::BVIntersect(tets.tree(), smallest);
        t = smallest.best;
      }
      embedding.tet[i] = t;
      embedding.weights.row(i) = tets.barycentric(t, points.row(i));
    }
  });
  return embedding;
}

Points interpolate(const Embedding& embedding, const Tetrahedra& T, const Points& x) {
  Points points(embedding.tet.size(), 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const auto tet = T.row(embedding.tet[i]);
    points.row(i) = embedding.weights(i, 0) * x.row(tet[0]) + embedding.weights(i, 1) * x.row(tet[1]) +
                    embedding.weights(i, 2) * x.row(tet[2]) + embedding.weights(i, 3) * x.row(tet[3]);
  }
  return points;
}

}  // namespace vivify::meshing

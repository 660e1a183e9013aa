#include "meshing/embedding.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/BVH>
#include <vector>

#include "common/error.h"
#include "common/parallel.h"
#include "meshing/enclosure.h"
#include "meshing/polygons.h"

namespace vivify::meshing {
namespace {

// Squared distance of p to the facet of a simplex that lies opposite to its corner k.
double squared_distance_to_facet(const Eigen::Vector3d& p, const std::array<Eigen::Vector3d, 4>& corners,
                                 std::size_t k) {
  const Eigen::Vector3d q =
      closest_on_triangle(p, corners[(k + 1) % 4], corners[(k + 2) % 4], corners[(k + 3) % 4]);
  return (q - p).squaredNorm();
}
double squared_distance_to_facet(const Eigen::Vector2d& p, const std::array<Eigen::Vector2d, 3>& corners,
                                 std::size_t k) {
  const double distance = distance_to_segment(p, corners[(k + 1) % 3], corners[(k + 2) % 3]);
  return distance * distance;
}

// Rest shape of triangles in the plane or tetrahedra (kDim 2 or 3), prepared for barycentric coordinates.
template <int kDim>
class Simplices {
 public:
  using Vector = Eigen::Matrix<double, kDim, 1>;
  using Matrix = Eigen::Matrix<double, kDim, kDim>;
  using Weights = Eigen::Matrix<double, 1, kDim + 1>;
  using Box = Eigen::AlignedBox<double, kDim>;
  using Tree = Eigen::KdBVH<double, kDim, int>;
  using Vertices = Eigen::Matrix<double, Eigen::Dynamic, kDim, Eigen::RowMajor>;
  using Elements = Eigen::Matrix<int, Eigen::Dynamic, kDim + 1, Eigen::RowMajor>;

  // Elements of no size (`sizes`: #E, m² or m³) are left out.
  Simplices(const Vertices& V, const Elements& E, const Eigen::VectorXd& sizes)
      : V_(V), E_(E), inverse_(static_cast<std::size_t>(E.rows())) {
    const double diagonal = (V.colwise().maxCoeff() - V.colwise().minCoeff()).norm();
    std::vector<int> ids;
    std::vector<Box> boxes;
    for (int t = 0; t < E.rows(); ++t) {
      if (!(sizes[t] > 1e-15 * std::pow(diagonal, kDim))) continue;
      Matrix edges;
      Box box(corner(t, 0));
      for (int k = 1; k <= kDim; ++k) {
        edges.col(k - 1) = corner(t, k) - corner(t, 0);
        box.extend(corner(t, k));
      }
      inverse_[static_cast<std::size_t>(t)] = edges.inverse();
      ids.push_back(t);
      boxes.push_back(box);
    }
    if (ids.empty()) {
      throw Error(ErrorKind::geometry, kDim == 3 ? "the simulation mesh has no tetrahedron of positive volume"
                                                 : "the simulation mesh has no triangle of positive area");
    }
    tree_.init(ids.begin(), ids.end(), boxes.begin(), boxes.end());
  }

  const Tree& tree() const { return tree_; }

  Weights barycentric(int t, const Vector& p) const {
    const Matrix& inverse = inverse_[static_cast<std::size_t>(t)];
    Vector b = inverse * (p - corner(t, 0));
    // One refinement step: flat elements lose digits in the inverse.
    Vector residual = p - corner(t, 0);
    for (int k = 1; k <= kDim; ++k) residual -= b[k - 1] * (corner(t, k) - corner(t, 0));
    b += inverse * residual;
    Weights weights;
    weights << 1 - b.sum(), b.transpose();
    return weights;
  }

  // Squared distance of p to element t, 0 inside.
  double squared_distance(int t, const Vector& p) const {
    const Weights b = barycentric(t, p);
    if (b.minCoeff() >= 0) return 0;
    std::array<Vector, kDim + 1> corners;
    for (int k = 0; k <= kDim; ++k) corners[static_cast<std::size_t>(k)] = corner(t, k);
    double nearest = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= kDim; ++k) {
      if (b[k] >= 0) continue;  // only facets seen from p hold the closest point
      nearest = std::min(nearest, squared_distance_to_facet(p, corners, static_cast<std::size_t>(k)));
    }
    return nearest;
  }

 private:
  Vector corner(int t, int k) const { return V_.row(E_(t, k)); }

  const Vertices& V_;
  const Elements& E_;
  std::vector<Matrix> inverse_;
  Tree tree_;
};

// Visitors of Eigen's bounding volume hierarchy.
template <int kDim>
struct Nearest {
  using Scalar = double;
  const Simplices<kDim>& simplices;
  typename Simplices<kDim>::Vector p;
  int best = -1;
  double best_distance = std::numeric_limits<double>::infinity();

  double minimumOnVolume(const typename Simplices<kDim>::Box& box) const {
    return box.squaredExteriorDistance(p);
  }
  double minimumOnObject(int t) {
    const double distance = simplices.squared_distance(t, p);
    if (distance < best_distance || (distance == best_distance && t < best)) {
      best = t;
      best_distance = distance;
    }
    return distance;
  }
};

template <int kDim>
struct SmallestWeights {
  const Simplices<kDim>& simplices;
  typename Simplices<kDim>::Vector p;
  double within;  // squared distance
  int best = -1;
  double best_weight = std::numeric_limits<double>::infinity();

  bool intersectVolume(const typename Simplices<kDim>::Box& box) const {
    return box.squaredExteriorDistance(p) <= within;
  }
  bool intersectObject(int t) {
    if (simplices.squared_distance(t, p) > within) return false;
    const double weight = simplices.barycentric(t, p).cwiseAbs().maxCoeff();
    if (weight < best_weight || (weight == best_weight && t < best)) {
      best = t;
      best_weight = weight;
    }
    return false;  // look at all of them
  }
};

template <int kDim>
Embedding embed_in(const typename Simplices<kDim>::Vertices& V, const typename Simplices<kDim>::Elements& E,
                   const Eigen::VectorXd& sizes, const typename Simplices<kDim>::Vertices& points) {
  if (!points.allFinite()) throw Error(ErrorKind::geometry, "a point to be embedded is not finite");
  const Simplices<kDim> simplices(V, E, sizes);
  Embedding embedding;
  embedding.element.resize(points.rows());
  embedding.weights.resize(points.rows(), kDim + 1);
  constexpr Eigen::Index kChunk = 256;
  parallel_for(static_cast<std::size_t>((points.rows() + kChunk - 1) / kChunk), [&](std::size_t chunk) {
    const Eigen::Index begin = static_cast<Eigen::Index>(chunk) * kChunk;
    for (Eigen::Index i = begin; i < std::min(points.rows(), begin + kChunk); ++i) {
      Nearest<kDim> nearest{simplices, points.row(i)};
      Eigen::BVMinimize(simplices.tree(), nearest);
      int t = nearest.best;
      if (nearest.best_distance > 0) {
        SmallestWeights<kDim> smallest{simplices, points.row(i), nearest.best_distance * (1 + 1e-12)};
        Eigen::BVIntersect(simplices.tree(), smallest);
        t = smallest.best;
      }
      embedding.element[i] = t;
      const typename Simplices<kDim>::Weights weights = simplices.barycentric(t, points.row(i));
      for (int k = 0; k <= kDim; ++k) embedding.weights(i, k) = weights[k];
    }
  });
  return embedding;
}

}  // namespace

Embedding embed(const TetMesh& mesh, const Points& points) {
  return embed_in<3>(mesh.V, mesh.T, tet_volumes(mesh), points);
}

Embedding embed(const Points2& V, const Triangles& F, const Points2& points) {
  return embed_in<2>(V, F, element_sizes({V, F}), points);
}

RowMatrixXd interpolate(const Embedding& embedding, const Eigen::Ref<const RowMatrixXi>& E,
                        const Eigen::Ref<const RowMatrixXd>& x) {
  RowMatrixXd points(embedding.element.size(), x.cols());
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const auto corners = E.row(embedding.element[i]);
    points.row(i) = embedding.weights(i, 0) * x.row(corners[0]);
    for (Eigen::Index k = 1; k < corners.size(); ++k) {
      points.row(i) += embedding.weights(i, k) * x.row(corners[k]);
    }
  }
  return points;
}

}  // namespace vivify::meshing

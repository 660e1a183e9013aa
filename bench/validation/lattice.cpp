#include "bench/validation/lattice.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "common/rng.h"

namespace vivify::validation {

SimMesh chain(int edges, double from, double to) {
  SimMesh mesh;
  mesh.V.setZero(edges + 1, 2);
  mesh.E.resize(edges, 2);
  for (int i = 0; i <= edges; ++i) mesh.V(i, 0) = from + (to - from) * i / edges;
  for (int e = 0; e < edges; ++e) mesh.E.row(e) << e, e + 1;
  return mesh;
}

SimMesh rectangle(int nx, int ny, double length, double height) {
  SimMesh mesh;
  const auto index = [nx](int i, int j) { return i + (nx + 1) * j; };
  mesh.V.resize((nx + 1) * (ny + 1), 2);
  for (int j = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) mesh.V.row(index(i, j)) << length * i / nx, height * j / ny - height / 2;
  }
  mesh.E.resize(2 * nx * ny, 3);
  int t = 0;
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      const int a = index(i, j), b = index(i + 1, j), c = index(i + 1, j + 1), d = index(i, j + 1);
      if ((i + j) % 2 == 0) {
        mesh.E.row(t++) << a, b, c;
        mesh.E.row(t++) << a, c, d;
      } else {
        mesh.E.row(t++) << a, b, d;
        mesh.E.row(t++) << b, c, d;
      }
    }
  }
  return mesh;
}

SimMesh box(int nx, int ny, int nz, double length, double height, double width) {
  static constexpr std::array<std::array<int, 4>, 5> kTets = {
      {{0, 3, 5, 6}, {1, 0, 3, 5}, {2, 0, 3, 6}, {4, 0, 5, 6}, {7, 3, 5, 6}}};
  const auto index = [=](int i, int j, int k) { return i + (nx + 1) * (j + (ny + 1) * k); };
  SimMesh mesh;
  mesh.V.resize((nx + 1) * (ny + 1) * (nz + 1), 3);
  for (int k = 0; k <= nz; ++k) {
    for (int j = 0; j <= ny; ++j) {
      for (int i = 0; i <= nx; ++i) {
        mesh.V.row(index(i, j, k)) << length * i / nx, height * j / ny - height / 2,
            width * k / nz - width / 2;
      }
    }
  }
  mesh.E.resize(5 * nx * ny * nz, 4);
  int t = 0;
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        const int mirror = (i + j + k) % 2 == 0 ? 0 : 7;
        for (const auto& tet : kTets) {
          for (std::size_t c = 0; c < 4; ++c) {
            const int bits = tet[c] ^ mirror;
            mesh.E(t, static_cast<Eigen::Index>(c)) =
                index(i + (bits & 1), j + (bits >> 1 & 1), k + (bits >> 2));
          }
          const auto edge = [&](int c) -> Eigen::Vector3d {
            return (mesh.V.row(mesh.E(t, c)) - mesh.V.row(mesh.E(t, 0))).transpose();
          };
          if (edge(1).dot(edge(2).cross(edge(3))) < 0) std::swap(mesh.E(t, 2), mesh.E(t, 3));
          ++t;
        }
      }
    }
  }
  return mesh;
}

SimMesh equilateral_strip(int rows, double width, double from, double to) {
  const double height = width / rows, edge = height / std::sqrt(0.75);
  const int columns = static_cast<int>(std::lround((to - from) / edge));
  const auto index = [columns](int i, int j) { return i + (columns + 1) * j; };
  SimMesh mesh;
  mesh.V.resize((columns + 1) * (rows + 1), 3);
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      mesh.V.row(index(i, j)) << from + edge * (i + (j % 2) * 0.5), 0, height * j - width / 2;
    }
  }
  mesh.E.resize(2 * columns * rows, 3);
  int t = 0;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      // In the plane of x and z, seen from above (−y is down), x × z points down: rows are wound accordingly.
      const int a = index(i, j), b = index(i + 1, j), c = index(i + 1, j + 1), d = index(i, j + 1);
      if (j % 2 == 0) {
        mesh.E.row(t++) << a, d, b;
        mesh.E.row(t++) << b, d, c;
      } else {
        mesh.E.row(t++) << a, d, c;
        mesh.E.row(t++) << a, c, b;
      }
    }
  }
  return mesh;
}

double shortest_edge(const SimMesh& mesh) {
  double shortest = INFINITY;
  for (Eigen::Index e = 0; e < mesh.E.rows(); ++e) {
    for (Eigen::Index a = 0; a < mesh.E.cols(); ++a) {
      for (Eigen::Index b = 0; b < a; ++b) {
        shortest = std::min(shortest, (mesh.V.row(mesh.E(e, a)) - mesh.V.row(mesh.E(e, b))).norm());
      }
    }
  }
  return shortest;
}

SimMesh roughened(SimMesh mesh, double share, std::uint64_t seed) {
  CounterRng rng(seed);
  const double reach = share * shortest_edge(mesh);
  const bool flat_shell = mesh.V.cols() == 3 && mesh.E.cols() == 3;
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
    for (Eigen::Index k = 0; k < mesh.V.cols(); ++k) {
      const double move = rng.uniform(-reach, reach);
      if (!(flat_shell && k == 1)) mesh.V(i, k) += move;
    }
  }
  return mesh;
}

Eigen::VectorXd flat(const RowMatrixXd& V) { return Eigen::Map<const Eigen::VectorXd>(V.data(), V.size()); }

std::vector<bool> boundary_vertices(const SimMesh& mesh) {
  std::map<std::vector<int>, int> faces;
  for (Eigen::Index e = 0; e < mesh.E.rows(); ++e) {
    for (Eigen::Index without = 0; without < mesh.E.cols(); ++without) {
      std::vector<int> face;
      for (Eigen::Index c = 0; c < mesh.E.cols(); ++c) {
        if (c != without) face.push_back(mesh.E(e, c));
      }
      std::sort(face.begin(), face.end());
      ++faces[face];
    }
  }
  std::vector<bool> boundary(static_cast<std::size_t>(mesh.V.rows()), false);
  for (const auto& [face, count] : faces) {
    if (count > 1) continue;
    for (const int v : face) boundary[static_cast<std::size_t>(v)] = true;
  }
  return boundary;
}

}  // namespace vivify::validation

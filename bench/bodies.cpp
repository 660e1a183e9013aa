#include "bench/bodies.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "common/text.h"
#include "sim/contact/contact_points.h"
#include "sim/settings.h"

namespace vivify::bench {

using sim::BodyInput;

namespace {

RowMatrixXi index_rows(const std::vector<int>& corners, int columns) {
  return Eigen::Map<const RowMatrixXi>(corners.data(), static_cast<Eigen::Index>(corners.size()) / columns,
                                       columns);
}

RowMatrixXd point_rows(const std::vector<double>& coordinates, int columns) {
  return Eigen::Map<const RowMatrixXd>(coordinates.data(),
                                       static_cast<Eigen::Index>(coordinates.size()) / columns, columns);
}

// Onto y = 0, centred over the origin.
void stand(RowMatrixXd& V) {
  const Eigen::RowVectorXd low = V.colwise().minCoeff(), high = V.colwise().maxCoeff();
  Eigen::RowVectorXd shift = -0.5 * (low + high);
  shift[1] = -low[1];
  V.rowwise() += shift;
}

// Elements whose points turn the wrong way round are turned.
void orient(SimMesh& mesh) {
  const Eigen::VectorXd sizes = element_sizes(mesh);
  for (Eigen::Index e = 0; e < sizes.size(); ++e) {
    if (sizes[e] < 0) std::swap(mesh.E(e, 1), mesh.E(e, 2));
  }
}

// Vertices on the outside: of boundary faces of solids, of all elements otherwise.
std::vector<int> surface_vertices(const SimMesh& mesh) {
  std::set<int> found;
  if (mesh.element_points() == 4) {
    const Triangles faces = boundary_faces({mesh.V, mesh.E});
    found.insert(faces.data(), faces.data() + faces.size());
  } else if (mesh.element_points() == 3 && mesh.dimension() == 2) {
    std::map<std::pair<int, int>, int> uses;
    for (Eigen::Index t = 0; t < mesh.E.rows(); ++t) {
      for (int k = 0; k < 3; ++k) ++uses[std::minmax(mesh.E(t, k), mesh.E(t, (k + 1) % 3))];
    }
    for (const auto& [edge, count] : uses) {
      if (count == 1) found.insert({edge.first, edge.second});
    }
  } else {
    found.insert(mesh.E.data(), mesh.E.data() + mesh.E.size());
  }
  return {found.begin(), found.end()};
}

sim::ContactPoints contact_points(const SimMesh& mesh) {
  static constexpr int kPoints = 160;
  const std::vector<int> touching = surface_vertices(mesh);
  std::vector<int> element_of(static_cast<std::size_t>(mesh.V.rows()));
  for (Eigen::Index e = 0; e < mesh.E.rows(); ++e) {
    for (int k = 0; k < mesh.E.cols(); ++k) element_of[mesh.E(e, k)] = static_cast<int>(e);
  }
  const Eigen::Index count = static_cast<Eigen::Index>(touching.size());
  Points surface = Points::Zero(count, 3);
  RowMatrixXi vertices(count, mesh.E.cols());
  RowMatrixXd weights = RowMatrixXd::Zero(count, mesh.E.cols());
  for (Eigen::Index i = 0; i < count; ++i) {
    const int v = touching[static_cast<std::size_t>(i)];
    surface.row(i).head(mesh.dimension()) = mesh.V.row(v);
    vertices.row(i) = mesh.E.row(element_of[static_cast<std::size_t>(v)]);
    for (int k = 0; k < mesh.E.cols(); ++k) weights(i, k) = vertices(i, k) == v ? 1 : 0;
  }
  return sim::select_contact_points(surface, vertices, weights, mesh.dimension(), kPoints);
}

}  // namespace

SimMesh cells(int nx, int ny, int nz, double cell, const std::function<bool(int, int, int)>& inside) {
  static constexpr int kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  std::map<std::array<int, 3>, int> numbers;
  std::vector<int> corners;
  std::vector<double> points;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [found, fresh] = numbers.try_emplace(at, static_cast<int>(numbers.size()));
    if (fresh) {
      for (const int coordinate : at) points.push_back(cell * coordinate);
    }
    return found->second;
  };
  for (int z = 0; z < nz; ++z) {
    for (int y = 0; y < ny; ++y) {
      for (int x = 0; x < nx; ++x) {
        if (!inside(x, y, z)) continue;
        for (const auto& order : kOrders) {
          std::array<int, 3> at = {x, y, z};
          corners.push_back(vertex(at));
          for (const int axis : order) {
            ++at[static_cast<std::size_t>(axis)];
            corners.push_back(vertex(at));
          }
        }
      }
    }
  }
  SimMesh mesh{point_rows(points, 3), index_rows(corners, 4)};
  stand(mesh.V);
  orient(mesh);
  return mesh;
}

SimMesh box(int nx, int ny, int nz, double cell) {
  return cells(nx, ny, nz, cell, [](int, int, int) { return true; });
}

SimMesh cross(int thick, const std::vector<int>& arms, double cell) {
  const auto in = [&](int at, int axis) { return at >= arms[2 * axis] && at < arms[2 * axis] + thick; };
  SimMesh mesh = cells(arms[0] + thick + arms[1], arms[2] + thick + arms[3], arms[4] + thick + arms[5], cell,
                       [&](int x, int y, int z) { return in(x, 0) + in(y, 1) + in(z, 2) >= 2; });
  const Eigen::Matrix3d R =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d(1, 1, 1), Eigen::Vector3d::UnitY())
          .toRotationMatrix();
  mesh.V = (mesh.V * R.transpose()).eval();
  stand(mesh.V);
  return mesh;
}

SimMesh ball(double radius, int layers, int subdivisions) {
  const double g = std::numbers::phi;
  std::vector<Eigen::Vector3d> points = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                         {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                         {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  for (Eigen::Vector3d& point : points) point.normalize();
  std::vector<std::array<int, 3>> faces = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                           {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                           {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                           {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int round = 0; round < subdivisions; ++round) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [found, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<int>(points.size()));
      if (fresh) points.push_back((points[a] + points[b]).normalized());
      return found->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const std::array<int, 3>& face : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) {
        finer.push_back(face);
      }
    }
    faces = std::move(finer);
  }
  const int shell = static_cast<int>(points.size());
  SimMesh mesh;
  mesh.V.resize(1 + layers * shell, 3);
  mesh.V.row(0).setZero();
  for (int layer = 0; layer < layers; ++layer) {
    for (int i = 0; i < shell; ++i) {
      mesh.V.row(1 + layer * shell + i) = (layer + 1) * radius / layers * points[i].transpose();
    }
  }
  std::vector<int> corners;
  for (std::array<int, 3> face : faces) {
    std::sort(face.begin(), face.end());  // the same diagonal on both sides of a wall
    const auto at = [&](int layer, int k) { return 1 + layer * shell + face[static_cast<std::size_t>(k)]; };
    corners.insert(corners.end(), {0, at(0, 0), at(0, 1), at(0, 2)});
    for (int layer = 0; layer + 1 < layers; ++layer) {
      for (int k = 0; k < 3; ++k) {
        std::array<int, 4> tet;
        for (int n = 0; n < 4; ++n) tet[n] = n <= k ? at(layer + 1, n) : at(layer, n - 1);
        corners.insert(corners.end(), tet.begin(), tet.end());
      }
    }
  }
  mesh.E = index_rows(corners, 4);
  stand(mesh.V);
  orient(mesh);
  return mesh;
}

SimMesh letter(const std::vector<std::string>& picture, int split, double cell) {
  std::map<std::pair<int, int>, int> numbers;
  std::vector<int> corners;
  std::vector<double> points;
  const auto vertex = [&](int x, int y) {
    const auto [found, fresh] = numbers.try_emplace({x, y}, static_cast<int>(numbers.size()));
    if (fresh) points.insert(points.end(), {cell / split * x, cell / split * y});
    return found->second;
  };
  const int rows = static_cast<int>(picture.size()) * split;
  for (int y = 0; y < rows; ++y) {
    const std::string& row = picture[static_cast<std::size_t>((rows - 1 - y) / split)];
    for (int x = 0; x < static_cast<int>(row.size()) * split; ++x) {
      if (row[static_cast<std::size_t>(x / split)] != '#') continue;
      const int a = vertex(x, y), b = vertex(x + 1, y), c = vertex(x + 1, y + 1), d = vertex(x, y + 1);
      if ((x + y) % 2 == 0) {
        corners.insert(corners.end(), {a, b, c, a, c, d});
      } else {
        corners.insert(corners.end(), {a, b, d, b, c, d});
      }
    }
  }
  SimMesh mesh{point_rows(points, 2), index_rows(corners, 3)};
  stand(mesh.V);
  return mesh;
}

SimMesh rectangle(int nx, int ny, double cell) {
  const std::string row(static_cast<std::size_t>(nx), '#');
  return letter(std::vector<std::string>(static_cast<std::size_t>(ny), row), 1, cell);
}

SimMesh disc(double radius, int rings) {
  SimMesh mesh;
  mesh.V = RowMatrixXd::Zero(1 + 3 * rings * (rings + 1), 2);
  // Ring r has 6 r vertices; sector s of six runs from its vertex s r.
  const auto vertex = [](int ring, int k) {
    return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1) + k % (6 * ring);
  };
  std::vector<int> corners;
  for (int ring = 1; ring <= rings; ++ring) {
    for (int k = 0; k < 6 * ring; ++k) {
      const double angle = 2 * std::numbers::pi * k / (6 * ring);
      mesh.V.row(vertex(ring, k)) << radius * ring / rings * std::cos(angle),
          radius * ring / rings * std::sin(angle);
    }
    for (int sector = 0; sector < 6; ++sector) {
      for (int k = 0; k < ring; ++k) {
        const int outer = sector * ring + k, inner = sector * (ring - 1) + k;
        corners.insert(corners.end(),
                       {vertex(ring, outer), vertex(ring, outer + 1), vertex(ring - 1, inner)});
        if (k + 1 < ring) {
          corners.insert(corners.end(),
                         {vertex(ring - 1, inner), vertex(ring, outer + 1), vertex(ring - 1, inner + 1)});
        }
      }
    }
  }
  mesh.E = index_rows(corners, 3);
  stand(mesh.V);
  return mesh;
}

SimMesh closed_rod(int n, double width, double height) {
  SimMesh mesh{RowMatrixXd(n, 2), RowMatrixXi(n, 2)};
  const double around = 2 * (width + height);
  for (int i = 0; i < n; ++i) {
    double s = around * i / n;
    auto at = mesh.V.row(i);
    if (s < width) {
      at << s, 0;
    } else if ((s -= width) < height) {
      at << width, s;
    } else if ((s -= height) < width) {
      at << width - s, height;
    } else {
      at << 0, height - (s - width);
    }
    mesh.E.row(i) << i, (i + 1) % n;
  }
  stand(mesh.V);
  return mesh;
}

SimMesh card(int nx, int ny, double cell) {
  SimMesh mesh{RowMatrixXd((nx + 1) * (ny + 1), 3), RowMatrixXi(2 * nx * ny, 3)};
  const double radius = nx * cell / 1.5;  // an arc of 1.5 radians
  for (int y = 0; y <= ny; ++y) {
    for (int x = 0; x <= nx; ++x) {
      const double angle = (x * cell - 0.5 * nx * cell) / radius;
      mesh.V.row(y * (nx + 1) + x) << radius * std::sin(angle), y * cell, radius * std::cos(angle);
    }
  }
  for (int y = 0; y < ny; ++y) {
    for (int x = 0; x < nx; ++x) {
      const int a = y * (nx + 1) + x, b = a + 1, d = a + nx + 1, c = d + 1, t = 2 * (y * nx + x);
      if ((x + y) % 2 == 0) {
        mesh.E.row(t) << a, b, c;
        mesh.E.row(t + 1) << a, c, d;
      } else {
        mesh.E.row(t) << a, b, d;
        mesh.E.row(t + 1) << b, c, d;
      }
    }
  }
  stand(mesh.V);
  return mesh;
}

Eigen::MatrixXd corner_weights(const RowMatrixXd& V) {
  const Eigen::Index d = V.cols(), corners = Eigen::Index(1) << d;
  const Eigen::RowVectorXd low = V.colwise().minCoeff(), size = V.colwise().maxCoeff() - low;
  Eigen::MatrixXd weights = Eigen::MatrixXd::Ones(V.rows(), corners);
  for (Eigen::Index i = 0; i < V.rows(); ++i) {
    const Eigen::ArrayXd t = ((V.row(i) - low).array() / size.array() + 0.1) / 1.2;  // a margin of a tenth
    for (Eigen::Index c = 0; c < corners; ++c) {
      for (Eigen::Index axis = 0; axis < d; ++axis) weights(i, c) *= c >> axis & 1 ? t[axis] : 1 - t[axis];
    }
  }
  return weights;
}

Eigen::MatrixXd spread_weights(const RowMatrixXd& V, int count) {
  std::vector<Eigen::Index> nodes = {0};  // each the vertex farthest from all before it
  Eigen::VectorXd distance2 = (V.rowwise() - V.row(0)).rowwise().squaredNorm();
  while (static_cast<int>(nodes.size()) < count) {
    Eigen::Index farthest = 0;
    distance2.maxCoeff(&farthest);
    nodes.push_back(farthest);
    distance2 = distance2.cwiseMin((V.rowwise() - V.row(farthest)).rowwise().squaredNorm());
  }
  const Eigen::Index d = V.cols();
  const double extent = (V.colwise().maxCoeff() - V.colwise().minCoeff()).norm();
  const double reach = 1.2 * extent / std::pow(count, 1.0 / static_cast<double>(d));
  Eigen::MatrixXd weights(V.rows(), count);
  Eigen::MatrixXd basis(d + 1, count);
  for (Eigen::Index i = 0; i < V.rows(); ++i) {
    Eigen::VectorXd bell(count);
    for (int c = 0; c < count; ++c) {
      const Eigen::VectorXd arm = (V.row(nodes[static_cast<std::size_t>(c)]) - V.row(i)).transpose() / reach;
      bell[c] = std::exp(-2 * arm.squaredNorm());
      basis.col(c) << 1, arm;
    }
    const Eigen::MatrixXd moments = basis * bell.asDiagonal() * basis.transpose();
    const Eigen::VectorXd share = moments.fullPivLu().solve(Eigen::VectorXd::Unit(d + 1, 0));
    weights.row(i) = (basis.transpose() * share).cwiseProduct(bell).transpose();
  }
  return weights;
}

std::vector<sim::ExamplePose> waves(const RowMatrixXd& V, int count) {
  const Eigen::Index d = V.cols();
  const Eigen::RowVectorXd low = V.colwise().minCoeff();
  const double extent = (V.colwise().maxCoeff() - low).maxCoeff();
  std::vector<sim::ExamplePose> poses;
  for (int k = 0; k < count; ++k) {
    const Eigen::Index direction = k % d, along = (k / d + direction + 1) % d;
    const double turns = 1 + 0.5 * (k / (d * d));  // NOLINT(bugprone-integer-division)
    sim::ExamplePose pose{"wave" + std::to_string(k), "all", V};
    for (Eigen::Index i = 0; i < V.rows(); ++i) {
      const double phase = std::numbers::pi * turns * (V(i, along) - low[along]) / extent;
      pose.V(i, direction) += 0.12 * extent * (k % 2 == 0 ? std::sin(phase) : std::cos(phase));
    }
    poses.push_back(std::move(pose));
  }
  return poses;
}

Value settings(const Schema& schema, const std::string& yaml) {
  std::vector<Error> errors;
  Value value = resolve(schema, parse_yaml(yaml, "bench", errors), errors);
  if (!errors.empty()) throw errors.front();
  return value;
}

BodyInput body_input(const std::string& name, SimMesh mesh, const std::string& model,
                     const std::string& controller) {
  BodyInput input;
  input.name = name;
  input.cage_weights = corner_weights(mesh.V);
  input.contact_points = contact_points(mesh);
  input.model = settings(sim::model_schema(), model);
  input.regularizer = settings(sim::regularizer_schema(), "{}");
  input.contact = settings(sim::contact_schema(), "{}");
  input.controller = settings(sim::controller_schema(), controller);
  input.solver = settings(sim::solver_schema(), "{}");
  input.rest = std::move(mesh);
  return input;
}

std::string lively_model(const std::string& type, const SimMesh& mesh, double lively) {
  static constexpr double kDensity = 300;
  const double height = mesh.V.col(1).maxCoeff() - mesh.V.col(1).minCoeff();
  const std::string k = number_text(lively * kDensity * 9.81 * height);
  return "{type: " + type + ", density: " + number_text(kDensity) + ", stiffness: " + k +
         ", volume_stiffness: " + k + "}";
}

std::vector<sim::Collider> ground() {
  TriangleMesh square;
  square.V.resize(4, 3);
  square.V << -50, 0, -50, -50, 0, 50, 50, 0, 50, 50, 0, -50;
  square.F.resize(2, 3);
  square.F << 0, 1, 2, 0, 2, 3;
  std::vector<sim::Collider> colliders;
  colliders.emplace_back("ground", square, 1);
  return colliders;
}

}  // namespace vivify::bench

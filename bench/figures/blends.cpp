#include "bench/figures/blends.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/error.h"
#include "common/hdf5_file.h"
#include "common/mesh.h"
#include "sim/control/rigid_motion.h"

namespace vivify::figures {
namespace {

Eigen::VectorXd flat(const RowMatrixXd& V) { return Eigen::Map<const Eigen::VectorXd>(V.data(), V.size()); }

struct BlendedBody {
  BlendedBody(const std::filesystem::path& out, std::string body_name) : name(std::move(body_name)) {
    const Hdf5Reader mesh(out / "mesh" / (name + ".h5")), weights(out / "weights" / (name + ".h5"));
    rest = mesh.matrix("/X0");
    elements = mesh.int_matrix("/elements");
    mass = mesh.vector("/mass");
    example = weights.matrix("/examples/0/V");
  }
  RowMatrixXd at(const Hdf5Reader& frame) const { return frame.matrix("/bodies/" + name + "/x"); }
  double weight(const Hdf5Reader& frame) const {
    const Eigen::VectorXd p = frame.vector("/bodies/" + name + "/p");
    if (p.size() != 1) throw Error(ErrorKind::usage, name + " has " + std::to_string(p.size()) + " examples");
    return p[0];
  }

  // Largest relative error of an edge of x at this weight.
  double edge_error(const RowMatrixXd& x, double weight) const {
    double largest = 0;
    for (const auto& element : elements.rowwise()) {
      for (Eigen::Index i = 0; i < element.size(); ++i) {
        for (Eigen::Index j = 0; j < i; ++j) {
          const auto length = [&](const RowMatrixXd& V) {
            return (V.row(element[i]) - V.row(element[j])).norm();
          };
          const double wanted = (1 - weight) * length(rest) + weight * length(example);
          largest = std::max(largest, std::abs(length(x) / wanted - 1));
        }
      }
    }
    return largest;
  }

  std::string name;
  RowMatrixXd rest, example;
  RowMatrixXi elements;
  Eigen::VectorXd mass;
};

// Largest distance of a vertex of A and B after the best rigid alignment.
double distance(const Eigen::VectorXd& mass, const RowMatrixXd& A, const RowMatrixXd& B) {
  const Eigen::VectorXd a = flat(A), b = flat(B);
  const Eigen::Matrix3d R = sim::best_rotation(mass, a, b);
  const Eigen::RowVector3d from = sim::centre_of_mass(mass, a).transpose(),
                           to = sim::centre_of_mass(mass, b).transpose();
  return (((A.rowwise() - from) * R.transpose()).rowwise() + to - B).rowwise().norm().maxCoeff();
}

std::string frame_file(int frame) {
  char name[32];
  std::snprintf(name, sizeof name, "sim/frames/%04d.h5", frame);
  return name;
}

}  // namespace

Blend compare_blends(const std::filesystem::path& out, const std::string& first, const std::string& second) {
  const BlendedBody a(out, first), b(out, second);
  Blend blend;
  blend.vertices = static_cast<int>(a.rest.rows());
  blend.elements = static_cast<int>(a.elements.rows());
  blend.length = (a.rest.colwise().maxCoeff() - a.rest.colwise().minCoeff()).maxCoeff();
  if (a.elements != b.elements || distance(a.mass, a.rest, b.rest) > 1e-9 * blend.length ||
      distance(a.mass, a.example, b.example) > 1e-6 * blend.length) {
    throw Error(ErrorKind::usage, first + " and " + second + " are not the same mesh with the same example");
  }
  for (int frame = 1; std::filesystem::exists(out / frame_file(frame)); ++frame) {
    const Hdf5Reader file(out / frame_file(frame));
    const RowMatrixXd x = a.at(file), y = b.at(file);
    const double weight = a.weight(file);
    if (std::abs(weight - b.weight(file)) > 1e-12) {
      throw Error(ErrorKind::usage, first + " and " + second + " have different weights");
    }
    blend.frames.push_back(
        {weight, distance(a.mass, x, y) / blend.length, a.edge_error(x, weight), b.edge_error(y, weight)});
    blend.end_distance = distance(a.mass, x, a.example) / blend.length;
  }
  if (blend.frames.empty()) throw Error(ErrorKind::io, out.string() + " holds no simulated frame");
  return blend;
}

const BlendFrame& worst(const Blend& blend, double BlendFrame::*value) {
  return *std::max_element(blend.frames.begin(), blend.frames.end(),
                           [&](const BlendFrame& a, const BlendFrame& b) { return a.*value < b.*value; });
}

}  // namespace vivify::figures

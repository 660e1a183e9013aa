#include "pipeline/camera_path.h"

#include <cmath>
#include <numbers>

#include "common/hdf5_file.h"
#include "pipeline/stages/stages.h"

namespace vivify::pipeline {

Points camera_displacements(const Points& path, double window, bool follow_height) {
  const Eigen::Index count = path.rows();
  const Eigen::Index last = count - 1;
  // Beyond an end the path is turned about its end point; beyond its whole length it rests there.
  const auto at = [&](Eigen::Index i) -> Eigen::RowVector3d {
    if (i < 0) return 2 * path.row(0) - path.row(std::min(-i, last));
    if (i > last) return 2 * path.row(last) - path.row(std::max<Eigen::Index>(2 * last - i, 0));
    return path.row(i);
  };
  const auto reach = static_cast<Eigen::Index>(std::ceil(window / 2)) - 1;
  Points displacements(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    Eigen::RowVector3d sum = at(i);
    double weights = 1;
    for (Eigen::Index k = 1; k <= reach; ++k) {
      const double weight = 0.5 + 0.5 * std::cos(2 * std::numbers::pi * static_cast<double>(k) / window);
      sum += weight * (at(i - k) + at(i + k));
      weights += 2 * weight;
    }
    displacements.row(i) = sum / weights - path.row(0);
  }
  if (!follow_height) displacements.col(1).setZero();
  return displacements;
}

std::vector<render::Camera> frame_cameras(const Value& scene, const std::filesystem::path& out,
                                          int frame_count) {
  const Value& settings = scene["camera"];
  std::vector<render::Camera> cameras(static_cast<std::size_t>(frame_count), render::make_camera(settings));
  if (!settings.has("follow")) return cameras;
  const std::string& body = settings["follow"].as_string();
  const Eigen::VectorXd mass = Hdf5Reader(out / ("mesh/" + body + ".h5")).vector("/mass");
  Points path = Points::Zero(frame_count, 3);
  int first = 0;  // frame with the body
  for (int frame = 1; frame <= frame_count; ++frame) {
    const Hdf5Reader state(out / simulation_file(frame));
    if (!state.has("/bodies/" + body + "/x")) continue;
    const RowMatrixXd x = state.matrix("/bodies/" + body + "/x");
    path.row(frame - 1).head(x.cols()) = (mass.transpose() * x) / mass.sum();
    if (first == 0) first = frame;
  }
  for (int frame = 1; frame < first; ++frame) path.row(frame - 1) = path.row(first - 1);
  const double window = settings["follow_smooth_s"].as_number() * scene["frames"]["fps"].as_number();
  const Points moved = camera_displacements(path, window, settings["follow_height"].as_bool());
  for (int i = 0; i < frame_count; ++i) {
    cameras[static_cast<std::size_t>(i)].position += moved.row(i).transpose();
    cameras[static_cast<std::size_t>(i)].target += moved.row(i).transpose();
  }
  return cameras;
}

}  // namespace vivify::pipeline

#include "render/view_transform.h"

#include <OpenColorIO/OpenColorIO.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/parallel.h"

namespace vivify::render {
namespace {

namespace ocio = OCIO_NAMESPACE;

constexpr float kLargestLight = 65504.0f;  // of a half float
constexpr std::size_t kPixelsPerTask = 16384;

// CIE xy of a colour space.
struct Chromaticities {
  Eigen::Vector2d red, green, blue, white;
};

// XYZ of chromaticity xy with Y = 1.
Eigen::Vector3d xyz(const Eigen::Vector2d& xy) {
  return {xy.x() / xy.y(), 1, (1 - xy.x() - xy.y()) / xy.y()};
}

// RGB to XYZ such that RGB = (1, 1, 1) is the white with Y = 1 (SMPTE RP 177).
Eigen::Matrix3d rgb_to_xyz(const Chromaticities& c) {
  Eigen::Matrix3d primaries;
  primaries << xyz(c.red), xyz(c.green), xyz(c.blue);
  const Eigen::Vector3d scale = primaries.inverse() * xyz(c.white);
  return primaries * scale.asDiagonal();
}

// Bradford's chromatic adaptation of XYZ from one white to another (K. M. Lam 1985).
Eigen::Matrix3d bradford(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  Eigen::Matrix3d cone;
  cone << 0.8951, 0.2664, -0.1614,  //
      -0.7502, 1.7135, 0.0367,      //
      0.0389, -0.0685, 1.0296;
  const Eigen::Vector3d gain = (cone * xyz(to)).cwiseQuotient(cone * xyz(from));
  return cone.inverse() * gain.asDiagonal() * cone;
}

float sane(float light) { return light > 0 ? std::min(light, kLargestLight) : 0.0f; }  // NaN is not > 0

ocio::ConstTransformRcPtr builtin(const char* style) {
  const ocio::BuiltinTransformRcPtr transform = ocio::BuiltinTransform::Create();
  transform->setStyle(style);
  return transform;
}

ocio::ConstCPUProcessorRcPtr make_processor(Display display, double exposure_stops) {
  const Eigen::Matrix3d to_aces = std::exp2(exposure_stops) * rec709_to_aces();
  Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = to_aces;

  const ocio::MatrixTransformRcPtr scene = ocio::MatrixTransform::Create();
  scene->setMatrix(matrix.data());
  const ocio::GroupTransformRcPtr all = ocio::GroupTransform::Create();
  all->appendTransform(scene);
  all->appendTransform(std::const_pointer_cast<ocio::Transform>(
      builtin("ACES-OUTPUT - ACES2065-1_to_CIE-XYZ-D65 - SDR-VIDEO_1.0")));
  all->appendTransform(std::const_pointer_cast<ocio::Transform>(
      builtin(display == Display::srgb ? "DISPLAY - CIE-XYZ-D65_to_sRGB"
                                       : "DISPLAY - CIE-XYZ-D65_to_REC.1886-REC.709")));
  return ocio::Config::CreateRaw()->getProcessor(all)->getDefaultCPUProcessor();
}

}  // namespace

struct ViewTransform::Processor {
  ocio::ConstCPUProcessorRcPtr cpu;
};

ViewTransform::ViewTransform(Display display, double exposure_stops)
    : processor_(std::make_unique<Processor>()) {
  try {
    processor_->cpu = make_processor(display, exposure_stops);
  } catch (const ocio::Exception& error) {
    throw Error(ErrorKind::internal, std::string("the view transform cannot be made: ") + error.what(),
                "OpenColorIO 2.1 or newer is needed");
  }
}

ViewTransform::~ViewTransform() = default;
ViewTransform::ViewTransform(ViewTransform&&) noexcept = default;
ViewTransform& ViewTransform::operator=(ViewTransform&&) noexcept = default;

void ViewTransform::apply(std::span<float> rgb) const {
  if (rgb.size() % 3 != 0) throw Error(ErrorKind::internal, "view transform: the values are not RGB triples");
  if (rgb.empty()) return;
  for (float& light : rgb) light = sane(light);
  ocio::PackedImageDesc image(rgb.data(), static_cast<long>(rgb.size() / 3), 1, 3);
  processor_->cpu->apply(image);
  for (float& value : rgb) value = value > 0 ? std::min(value, 1.0f) : 0.0f;
}

std::vector<std::uint8_t> ViewTransform::pixels(std::span<const float> rgb) const {
  std::vector<std::uint8_t> result(rgb.size());
  constexpr std::size_t kValues = 3 * kPixelsPerTask;
  parallel_for((rgb.size() + kValues - 1) / kValues, [&](std::size_t task) {
    const std::size_t begin = task * kValues;
    const std::size_t end = std::min(begin + kValues, rgb.size());
    std::vector<float> values(rgb.begin() + static_cast<std::ptrdiff_t>(begin),
                              rgb.begin() + static_cast<std::ptrdiff_t>(end));
    apply(values);
    for (std::size_t i = begin; i < end; ++i) {
      result[i] = static_cast<std::uint8_t>(std::lround(255.0f * values[i - begin]));
    }
  });
  return result;
}

Eigen::Matrix3d rec709_to_aces() {
  const Chromaticities rec709{{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.3127, 0.3290}};
  const Chromaticities ap0{{0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.0770}, {0.32168, 0.33767}};
  return rgb_to_xyz(ap0).inverse() * bradford(rec709.white, ap0.white) * rgb_to_xyz(rec709);
}

}  // namespace vivify::render

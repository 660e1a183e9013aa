#include "render/lights/dome.h"

#include <numeric>
#include <utility>

namespace vivify::render {
namespace {

constexpr float kDegree = kPi / 180;

// Cells of the sampling table: fine enough for a picture, one for a single colour.
int cell_rows(const Picture& picture) { return std::min(picture.height, 512); }
int cell_columns(const Picture& picture) { return std::min(picture.width, 1024); }

Vec3 from_square(const Vec2& s, float heading) {
  const float y = std::clamp(2 * s.y - 1, -1.0f, 1.0f);
  const float r = std::sqrt(std::max(0.0f, 1 - y * y));
  const float phi = 2 * kPi * (s.x - 0.5f) - heading;
  return {r * std::sin(phi), y, -r * std::cos(phi)};
}

}  // namespace

DomeLight::DomeLight(Picture picture, float heading, bool visible, bool compensate)
    : Light(visible), picture_(std::move(picture)), heading_(heading) {
  const int rows = cell_rows(picture_);
  const int columns = cell_columns(picture_);
  std::vector<double> weights;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      double sum = 0;
      constexpr int kTaps = 4;  // per side of a cell
      for (int t = 0; t < kTaps * kTaps; ++t) {
        const Vec2 s = {(static_cast<float>(i) + (static_cast<float>(t % kTaps) + 0.5f) / kTaps) /
                            static_cast<float>(columns),
                        (static_cast<float>(j) + (static_cast<float>(t / kTaps) + 0.5f) / kTaps) /
                            static_cast<float>(rows)};
        sum += luminance(look_up(from_square(s, heading_)));
      }
      weights.push_back(sum / (kTaps * kTaps));
    }
  }
  const double mean =
      std::accumulate(weights.begin(), weights.end(), 0.0) / static_cast<double>(weights.size());
  if (compensate) {
    for (double& w : weights) w = std::max(0.0, w - mean * (1 + 1e-6));
  } else {
    for (double& w : weights) w += 1e-3 * mean;  // taps may have missed something bright
  }
  cells_ = Distribution2D(weights, static_cast<std::size_t>(columns), static_cast<std::size_t>(rows));
  irradiance_ = kPi * static_cast<float>(cells_.total() / static_cast<double>(weights.size()));
  if (irradiance_ < 0.01f * kPi * static_cast<float>(mean))
    irradiance_ = 0;  // hardly uneven: nothing to sample
}

float DomeLight::importance(const Vec3&) const { return irradiance_; }

bool DomeLight::sample(const Vec3&, const Vec2& u, LightSample& sample) const {
  if (irradiance_ == 0) return false;
  float density;
  const Vec2 s = cells_.sample(u, density);
  sample.direction = from_square(s, heading_);
  sample.distance = std::numeric_limits<float>::infinity();
  sample.radiance = look_up(sample.direction);
  sample.pdf = density / (4 * kPi);
  return sample.pdf > 0;
}

float DomeLight::pdf(const Vec3&, const Vec3& direction) const {
  return irradiance_ == 0 ? 0 : cells_.pdf(to_square(direction)) / (4 * kPi);
}

Vec3 DomeLight::radiance(const Ray& ray) const {
  return ray.tmax == std::numeric_limits<float>::infinity() ? look_up(ray.direction) : Vec3();
}

Vec2 DomeLight::to_square(const Vec3& direction) const {
  const float phi = std::atan2(direction.x, -direction.z) + heading_;
  const float x = phi / (2 * kPi) + 0.5f;
  return {x - std::floor(x), std::clamp(0.5f * (direction.y + 1), 0.0f, 1.0f)};
}

Vec3 DomeLight::look_up(const Vec3& direction) const {
  if (picture_.texels.size() == 1) return picture_.texels[0];
  const Vec2 s = to_square(direction);
  const float v = 1 - std::acos(std::clamp(direction.y, -1.0f, 1.0f)) / kPi;
  return bilinear(picture_, {s.x, v}, true);
}

Picture picture_of_sphere(int height, const std::function<Vec3(const Vec3&)>& radiance) {
  Picture picture{2 * height, height, {}};
  for (int y = 0; y < height; ++y) {
    const float theta = kPi * (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
    for (int x = 0; x < 2 * height; ++x) {
      const float phi = kPi * ((static_cast<float>(x) + 0.5f) / static_cast<float>(height) - 1);
      picture.texels.push_back(
          radiance({std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi)}));
    }
  }
  return picture;
}

Schema with_dome(Schema&& schema) {
  return std::move(schema)
      .field("heading_deg", number("Turns the light around +y.").unit("°").initially(0))
      .field("visible", boolean("Whether the camera sees it as background.").initially(true))
      .field("mis_compensation",
             boolean("Sample only the light above the mean and leave the rest to the materials; less noise.")
                 .initially(true));
}

std::unique_ptr<Light> make_dome(Picture picture, const Value& value) {
  return std::make_unique<DomeLight>(std::move(picture),
                                     kDegree * static_cast<float>(value["heading_deg"].as_number()),
                                     value["visible"].as_bool(), value["mis_compensation"].as_bool());
}

}  // namespace vivify::render

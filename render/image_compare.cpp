#include "render/image_compare.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>

namespace vivify::render {
namespace {

constexpr double kFloor = 0.01;  // keeps relative errors of dark pixels bounded
constexpr int kBlock = 8;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

enum class PlaneKind { light, display, geometry };

// A plane as the places of its channels in both images.
struct Plane {
  std::string name;
  PlaneKind kind = PlaneKind::light;
  std::vector<int> ref, test;
};

std::string percent(double share) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.3g %%", 100 * share);
  return text.data();
}

std::string plane_name(const std::string& channel) {
  const std::size_t dot = channel.rfind('.');
  return dot == std::string::npos ? "beauty" : channel.substr(0, dot);
}

PlaneKind plane_kind(const std::string& name, bool display_encoded) {
  static constexpr std::array kGeometry{"depth", "normal", "position", "motion", "id"};
  if (std::ranges::find(kGeometry, name) != kGeometry.end()) return PlaneKind::geometry;
  return display_encoded ? PlaneKind::display : PlaneKind::light;
}

// The common planes; `problem` says which channels only one of the images has.
std::vector<Plane> match_planes(const Image& ref, const Image& test, std::string& problem) {
  std::map<std::string, int> places;
  for (std::size_t c = 0; c < test.channels.size(); ++c)
    places.emplace(test.channels[c], static_cast<int>(c));
  std::vector<Plane> planes;
  for (std::size_t c = 0; c < ref.channels.size(); ++c) {
    const auto place = places.find(ref.channels[c]);
    if (place == places.end()) {
      problem = "channel " + ref.channels[c] + " is missing";
      return {};
    }
    const std::string name = plane_name(ref.channels[c]);
    auto plane = std::ranges::find(planes, name, &Plane::name);
    if (plane == planes.end()) {
      planes.push_back({name, plane_kind(name, ref.display_encoded), {}, {}});
      plane = planes.end() - 1;
    }
    plane->ref.push_back(static_cast<int>(c));
    plane->test.push_back(place->second);
    places.erase(place);
  }
  if (!places.empty()) problem = "channel " + places.begin()->first + " is not in the reference";
  return planes;
}

bool same_bits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

double scale_of(PlaneKind kind, double ref) {
  switch (kind) {
    case PlaneKind::light:
      return std::abs(ref) + kFloor;
    case PlaneKind::geometry:
      return std::max(1.0, std::abs(ref));
    case PlaneKind::display:
      break;
  }
  return 1;
}

double error_of(PlaneKind kind, float ref, float test) {
  if (ref == test || (std::isnan(ref) && std::isnan(test))) return 0;
  if (!std::isfinite(ref) || !std::isfinite(test)) return kInfinity;
  return std::abs(static_cast<double>(test) - ref) / scale_of(kind, ref);
}

// The largest error of the means over blocks of 8 by 8 pixels, with the corner of the worst block. The last
// blocks of a row or column are moved back so that every block is whole.
struct BlockError {
  double error = 0;
  int x = 0, y = 0;
};
BlockError block_error(const Plane& plane, const Image& ref, const Image& test) {
  BlockError worst;
  const int width = std::min(kBlock, ref.width);
  const int height = std::min(kBlock, ref.height);
  for (int top = 0; top < ref.height; top += kBlock) {
    for (int left = 0; left < ref.width; left += kBlock) {
      const int x0 = std::min(left, ref.width - width);
      const int y0 = std::min(top, ref.height - height);
      for (std::size_t c = 0; c < plane.ref.size(); ++c) {
        double sum_ref = 0, sum_test = 0;
        for (int y = y0; y < y0 + height; ++y) {
          for (int x = x0; x < x0 + width; ++x) {
            const double a = ref.at(x, y, plane.ref[c]), b = test.at(x, y, plane.test[c]);
            if (!std::isfinite(a) || !std::isfinite(b)) continue;
            sum_ref += a;
            sum_test += b;
          }
        }
        const double count = width * height;
        const double error = std::abs(sum_test - sum_ref) / count / scale_of(plane.kind, sum_ref / count);
        if (error > worst.error) worst = {error, x0, y0};
      }
    }
  }
  return worst;
}

// Measures the errors of a plane and adds them to the map of all planes; `broken`: pixels that are not finite
// in one image.
PlaneComparison measure(const Plane& plane, const Image& ref, const Image& test, const CompareLimits& limits,
                        long& broken, std::vector<float>& map) {
  PlaneComparison result;
  result.name = plane.name;
  const double limit = plane.kind == PlaneKind::geometry ? limits.rounding : limits.pixel;
  double sum = 0;
  std::vector<double> bias(plane.ref.size(), 0), weight(plane.ref.size(), 0);
  long finite = 0;
  broken = 0;
  for (int y = 0; y < ref.height; ++y) {
    for (int x = 0; x < ref.width; ++x) {
      double error = 0;
      bool bits = true;
      for (std::size_t c = 0; c < plane.ref.size(); ++c) {
        const float a = ref.at(x, y, plane.ref[c]), b = test.at(x, y, plane.test[c]);
        bits = bits && same_bits(a, b);
        error = std::max(error, error_of(plane.kind, a, b));
        if (std::isfinite(a) && std::isfinite(b)) {
          bias[c] += static_cast<double>(b) - a;
          weight[c] += plane.kind == PlaneKind::display ? 1 : std::abs(static_cast<double>(a)) + kFloor;
        }
      }
      if (std::isfinite(error)) {
        sum += error;
        ++finite;
      } else {
        ++broken;
      }
      if (error > result.max_error) {
        result.max_error = error;
        result.worst_x = x;
        result.worst_y = y;
      }
      if (limits.exact ? !bits : error > limit) ++result.failing_pixels;
      float& worst = map[static_cast<std::size_t>(y) * static_cast<std::size_t>(ref.width) +
                         static_cast<std::size_t>(x)];
      worst = std::max(worst, static_cast<float>(error));
    }
  }
  result.mean_error = finite > 0 ? sum / static_cast<double>(finite) : 0;
  for (std::size_t c = 0; plane.kind != PlaneKind::geometry && c < bias.size(); ++c) {
    const double share = weight[c] > 0 ? bias[c] / weight[c] : 0;
    if (std::abs(share) > std::abs(result.signed_mean)) result.signed_mean = share;
  }
  return result;
}

// Why the plane is not the same; empty when it is.
std::string judge(const PlaneComparison& result, const Plane& plane, const Image& ref, const Image& test,
                  const CompareLimits& limits, long broken) {
  const double pixels = static_cast<double>(ref.width) * ref.height;
  const double share = static_cast<double>(result.failing_pixels) / pixels;
  const auto count = [](long n) { return std::to_string(n) + (n == 1 ? " pixel" : " pixels"); };
  if (broken > 0) return count(broken) + " not finite in one image only";
  if (limits.exact)
    return result.failing_pixels > 0 ? count(result.failing_pixels) + " not bit-identical" : "";
  if (plane.kind == PlaneKind::geometry) {
    if (share <= limits.silhouette_share) return "";
    return percent(share) + " of the pixels differ (limit " + percent(limits.silhouette_share) + ")";
  }
  std::string reason;
  const auto add = [&](const std::string& text) { reason += (reason.empty() ? "" : "; ") + text; };
  if (share > limits.failing_share) {
    add(percent(share) + " of the pixels differ by more than " + percent(limits.pixel) + " (limit " +
        percent(limits.failing_share) + ")");
  }
  if (result.mean_error > limits.mean) {
    add("mean error " + percent(result.mean_error) + " (limit " + percent(limits.mean) + ")");
  }
  if (std::abs(result.signed_mean) > limits.signed_mean) {
    add("bias " + percent(result.signed_mean) + " (limit " + percent(limits.signed_mean) + ")");
  }
  if (const BlockError block = block_error(plane, ref, test); block.error > limits.block) {
    add("8x8 block at (" + std::to_string(block.x) + ", " + std::to_string(block.y) + ") differs by " +
        percent(block.error) + " (limit " + percent(limits.block) + ")");
  }
  return reason;
}

}  // namespace

ImageComparison compare_images(const Image& ref, const Image& test, const CompareLimits& limits) {
  ImageComparison result;
  const auto size = [](const Image& image) {
    return std::to_string(image.width) + "x" + std::to_string(image.height);
  };
  std::string problem;
  std::vector<Plane> planes;
  if (ref.width != test.width || ref.height != test.height) {
    problem = "the size is " + size(test) + ", not " + size(ref);
  } else if (ref.display_encoded != test.display_encoded) {
    problem = "one image is linear, the other display-encoded";
  } else {
    planes = match_planes(ref, test, problem);
  }
  if (!problem.empty()) {
    result.same = false;
    result.reason = problem;
    return result;
  }
  result.width = ref.width;
  result.height = ref.height;
  result.error.assign(static_cast<std::size_t>(ref.width) * static_cast<std::size_t>(ref.height), 0.0f);
  for (const Plane& plane : planes) {
    long broken = 0;
    PlaneComparison compared = measure(plane, ref, test, limits, broken, result.error);
    compared.reason = judge(compared, plane, ref, test, limits, broken);
    compared.same = compared.reason.empty();
    result.same = result.same && compared.same;
    result.planes.push_back(std::move(compared));
  }
  return result;
}

std::vector<std::uint8_t> heat_map(const ImageComparison& comparison) {
  static constexpr std::array<std::array<float, 3>, 5> kColors{
      {{0, 0, 0}, {40, 60, 220}, {220, 40, 40}, {255, 220, 40}, {255, 255, 255}}};
  std::vector<std::uint8_t> pixels;
  pixels.reserve(3 * comparison.error.size());
  for (const float error : comparison.error) {
    const float decades = error > 1e-4f ? std::min(std::log10(error) + 4.0f, 4.0f) : 0.0f;  // 0 ... 4
    const std::size_t low = std::min<std::size_t>(static_cast<std::size_t>(decades), kColors.size() - 2);
    const float share = decades - static_cast<float>(low);
    for (std::size_t c = 0; c < 3; ++c) {
      pixels.push_back(static_cast<std::uint8_t>(
          std::lround((1 - share) * kColors[low][c] + share * kColors[low + 1][c])));
    }
  }
  return pixels;
}

}  // namespace vivify::render

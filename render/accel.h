// Ray queries against the triangles of a frame. The only part that knows Embree.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "render/vec.h"

namespace vivify::render {

struct Ray {
  Vec3 origin;
  Vec3 direction;  // unit length
  float tmax = std::numeric_limits<float>::infinity();
};

struct Hit {
  static constexpr std::uint32_t kNone = ~0u;
  std::uint32_t triangle = kNone;
  float t = 0;
  float u = 0, v = 0;  // weights of the second and third corner
  explicit operator bool() const { return triangle != kNone; }
};

// A bounding volume hierarchy over one list of triangles. Robust (watertight) and with a fixed instruction
// set, so that the bits do not depend on the number of threads that built it.
class Accel {
 public:
  // Throws Error(internal) when Embree reports a failure.
  Accel(const std::vector<Vec3>& points, const std::vector<std::array<std::uint32_t, 3>>& triangles);
  ~Accel();
  Accel(const Accel&) = delete;
  Accel& operator=(const Accel&) = delete;

  Hit intersect(const Ray& ray) const;  // nearest hit
  bool occluded(const Ray& ray) const;  // any hit

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Sets flush-to-zero and denormals-are-zero on this thread for as long as it lives.
class FlushDenormals {
 public:
  FlushDenormals();
  ~FlushDenormals();
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned int saved_;
};

}  // namespace vivify::render

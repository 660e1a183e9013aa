// Sample points in the unit cube: Owen-scrambled Sobol points, padded in groups of four dimensions.
#pragma once

#include <array>
#include <cstdint>

namespace vivify::render {

// The first four Sobol dimensions (direction numbers of Joe and Kuo 2008) of one index, as 32-bit fractions.
std::array<std::uint32_t, 4> sobol_4d(std::uint32_t index);

// Nested uniform (Owen) scrambling of a 32-bit fraction by a hash [Laine and Karras 2011; constants of
// Vegdahl 2021]: every bit is flipped or not depending on the seed and on the bits above it.
std::uint32_t owen_scramble(std::uint32_t fraction, std::uint32_t seed);

// The samples of one pixel [Burley 2020]. Every group of four dimensions has its own shuffle of the index and
// its own scrambling, so that groups are independent and each is a (0,2)-net in its first two dimensions over
// 2^k samples.
class Sampler {
 public:
  // `seed` is of the pixel and the frame; `samples` is how many samples the pixel takes (at least 1).
  Sampler(std::uint64_t seed, std::uint32_t samples);

  // Goes to sample `index`, group 0.
  void start(std::uint32_t index) { index_ = index, group_ = 0; }

  // Jumps to a group, so that a path of any history uses the same dimensions for the same purpose.
  void go_to(std::uint32_t group) { group_ = group; }

  // The next group: four numbers in [0, 1).
  std::array<float, 4> next();

 private:
  std::uint64_t seed_;
  std::uint32_t mask_;  // covers the indices of the pixel
  std::uint32_t index_ = 0;
  std::uint32_t group_ = 0;
};

}  // namespace vivify::render

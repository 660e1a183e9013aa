#include "render/sampler.h"

#include <bit>

#include "common/rng.h"

namespace vivify::render {
namespace {

constexpr std::uint32_t reverse_bits(std::uint32_t v) {
  v = ((v >> 1) & 0x55555555u) | ((v & 0x55555555u) << 1);
  v = ((v >> 2) & 0x33333333u) | ((v & 0x33333333u) << 2);
  v = ((v >> 4) & 0x0f0f0f0fu) | ((v & 0x0f0f0f0fu) << 4);
  v = ((v >> 8) & 0x00ff00ffu) | ((v & 0x00ff00ffu) << 8);
  return (v >> 16) | (v << 16);
}

// Column k of the generator matrix of a dimension with primitive polynomial of `degree` and inner
// coefficients `inner`, and initial odd numbers m.
constexpr std::array<std::uint32_t, 32> directions(int degree, std::uint32_t inner,
                                                   std::array<std::uint32_t, 3> m) {
  std::array<std::uint32_t, 32> v{};
  for (int k = 0; k < 32; ++k) {
    if (degree == 0) {
      v[k] = 1u << (31 - k);
    } else if (k < degree) {
      v[k] = m[k] << (31 - k);
    } else {
      v[k] = v[k - degree] ^ (v[k - degree] >> degree);
      for (int j = 1; j < degree; ++j) {
        if ((inner >> (degree - 1 - j)) & 1u) v[k] ^= v[k - j];
      }
    }
  }
  return v;
}

// For each byte of the index, the four fractions it adds.
struct Tables {
  std::array<std::array<std::array<std::uint32_t, 4>, 256>, 4> byte;

  constexpr Tables() : byte{} {
    const std::array<std::array<std::uint32_t, 32>, 4> v = {
        directions(0, 0, {}), directions(1, 0, {1}), directions(2, 1, {1, 3}), directions(3, 1, {1, 3, 1})};
    for (int b = 0; b < 4; ++b) {
      for (std::uint32_t i = 0; i < 256; ++i) {
        for (int d = 0; d < 4; ++d) {
          for (int k = 0; k < 8; ++k) {
            if ((i >> k) & 1u) byte[b][i][d] ^= v[d][8 * b + k];
          }
        }
      }
    }
  }
};
constexpr Tables kTables;

// Laine and Karras' permutation: bit k of the result depends on the bits up to k.
constexpr std::uint32_t permute_upwards(std::uint32_t v, std::uint32_t seed) {
  v ^= v * 0x3d20adeau;
  v += seed;
  v *= (seed >> 16) | 1u;
  v ^= v * 0x05526c56u;
  v ^= v * 0x53a22864u;
  return v;
}

}  // namespace

std::array<std::uint32_t, 4> sobol_4d(std::uint32_t index) {
  std::array<std::uint32_t, 4> x = kTables.byte[0][index & 255u];
  for (int b = 1; b < 4 && (index >> (8 * b)) != 0; ++b) {
    const auto& row = kTables.byte[b][(index >> (8 * b)) & 255u];
    for (int d = 0; d < 4; ++d) x[d] ^= row[d];
  }
  return x;
}

std::uint32_t owen_scramble(std::uint32_t fraction, std::uint32_t seed) {
  return reverse_bits(permute_upwards(reverse_bits(fraction), seed));
}

Sampler::Sampler(std::uint64_t seed, std::uint32_t samples)
    : seed_(seed), mask_(std::bit_ceil(samples) - 1u) {}

std::array<float, 4> Sampler::next() {
  const std::uint64_t key = hash_words(seed_, group_++);
  const std::uint64_t key01 = mix_bits(key ^ 0x8bb84b93962eacc9ULL);
  const std::uint64_t key23 = mix_bits(key ^ 0x2d358dccaa6c78a5ULL);
  const std::array<std::uint32_t, 4> keys = {
      static_cast<std::uint32_t>(key01), static_cast<std::uint32_t>(key01 >> 32),
      static_cast<std::uint32_t>(key23), static_cast<std::uint32_t>(key23 >> 32)};
  // Over an aligned block of indices the bits above the block are flipped alike; without them the same points
  // come in an equally random order, and the table look-up is short.
  const std::uint32_t shuffled = owen_scramble(index_, static_cast<std::uint32_t>(key)) & mask_;
  const std::array<std::uint32_t, 4> x = sobol_4d(shuffled);
  std::array<float, 4> u;
  for (int d = 0; d < 4; ++d) {
    u[d] = static_cast<float>(owen_scramble(x[d], keys[d]) >> 8) * 0x1.0p-24f;
  }
  return u;
}

}  // namespace vivify::render

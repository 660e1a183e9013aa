// Counter-based random numbers: a value depends on its key and counter only, never on the order of the calls.
#pragma once

#include <cstdint>

namespace vivify {

// 64-bit finaliser with full avalanche (Stafford's variant 13 of the MurmurHash3 finaliser).
constexpr std::uint64_t mix_bits(std::uint64_t v) {
  v ^= v >> 30;
  v *= 0xbf58476d1ce4e5b9ULL;
  v ^= v >> 27;
  v *= 0x94d049bb133111ebULL;
  v ^= v >> 31;
  return v;
}

// Hash of a sequence of words.
constexpr std::uint64_t hash_words(std::uint64_t seed) { return mix_bits(seed + 0x9e3779b97f4a7c15ULL); }
template <class... Words>
constexpr std::uint64_t hash_words(std::uint64_t seed, std::uint64_t word, Words... words) {
  return hash_words(mix_bits(seed + 0x9e3779b97f4a7c15ULL) ^ word, static_cast<std::uint64_t>(words)...);
}

// A small stream of its own for each key; for tests and for sampling that needs no low discrepancy.
class CounterRng {
 public:
  explicit constexpr CounterRng(std::uint64_t key) : key_(key) {}
  constexpr std::uint64_t next() { return hash_words(key_, counter_++); }
  // Uniform in [0, 1).
  constexpr double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  constexpr double uniform(double low, double high) { return low + (high - low) * uniform(); }

 private:
  std::uint64_t key_;
  std::uint64_t counter_ = 0;
};

}  // namespace vivify

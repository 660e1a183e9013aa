// Content hashes (XXH3, 128 bits) for the stage cache. Not cryptographic.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace vivify {

// Accumulates a hash over parts; the length of every part is hashed with it, so that ("ab", "c") differs from ("a", "bc").
class Hasher {
 public:
  Hasher();
  ~Hasher();
  Hasher(Hasher&&) noexcept;
  Hasher& operator=(Hasher&&) noexcept;

  Hasher& add(std::span<const std::byte> bytes);
  Hasher& add(std::string_view text);

  // 32 hexadecimal digits.
  std::string hex() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Hash of one piece of content, 32 hexadecimal digits.
std::string hash_hex(std::span<const std::byte> bytes);

}  // namespace vivify

// Plain values and arrays to and from bytes, for the pipes between a program and its children (same machine).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace vivify::meshing {

class ByteWriter {
 public:
  template <class T>
  requires std::is_arithmetic_v<T> ByteWriter& put(T value) { return append(&value, sizeof value); }
  ByteWriter& put(const std::string& text) {
    put(static_cast<std::int64_t>(text.size()));
    return append(text.data(), text.size());
  }
  ByteWriter& put(const std::vector<std::string>& texts) {
    put(static_cast<std::int64_t>(texts.size()));
    for (const std::string& text : texts) put(text);
    return *this;
  }
  // Row-major matrices and vectors.
  template <class T, int R, int C, int O>
  ByteWriter& put(const Eigen::Matrix<T, R, C, O>& matrix) {
    static_assert(C == 1 || (O & Eigen::RowMajor) != 0);
    put(static_cast<std::int64_t>(matrix.rows()));
    return append(matrix.data(), sizeof(T) * static_cast<std::size_t>(matrix.size()));
  }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  ByteWriter& append(const void* data, std::size_t size) {
    const auto* first = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), first, first + size);
    return *this;
  }
  std::vector<std::byte> bytes_;
};

// Reads what a ByteWriter wrote, in the same order. Throws std::runtime_error when bytes are missing.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <class T>
  requires std::is_arithmetic_v<T>
  void get(T& value) { copy(&value, sizeof value); }
  void get(std::string& text) {
    text.resize(count(1));
    copy(text.data(), text.size());
  }
  void get(std::vector<std::string>& texts) {
    texts.resize(count(sizeof(std::int64_t)));
    for (std::string& text : texts) get(text);
  }
  template <class T, int R, int C, int O>
  void get(Eigen::Matrix<T, R, C, O>& matrix) {
    static_assert(C != Eigen::Dynamic);
    matrix.resize(static_cast<Eigen::Index>(count(sizeof(T) * C)), C);
    copy(matrix.data(), sizeof(T) * static_cast<std::size_t>(matrix.size()));
  }
  bool at_end() const { return bytes_.empty(); }

 private:
  std::size_t count(std::size_t item_size) {
    std::int64_t n = 0;
    get(n);
    if (n < 0 || static_cast<std::size_t>(n) > bytes_.size() / item_size) fail();
    return static_cast<std::size_t>(n);
  }
  void copy(void* to, std::size_t size) {
    if (size > bytes_.size()) fail();
    if (size > 0) std::memcpy(to, bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
  }
  [[noreturn]] static void fail() { throw std::runtime_error("the answer of the child process is cut off"); }

  std::span<const std::byte> bytes_;
};

}  // namespace vivify::meshing

// HDF5 files made in memory and written through the atomic writer; byte-identical for identical content
// (no object times). The C++ layer of HDF5 loses a full disk silently, so the C interface is used here.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/file.h"
#include "common/matrix.h"

namespace vivify {

// Collects datasets and attributes, then writes them as one file. Paths are absolute ("/bodies/cup/x"); groups on the
// way are made. A vector is a column: #V by 1 is stored as #V.
class Hdf5Writer {
 public:
  Hdf5Writer();
  ~Hdf5Writer();
  Hdf5Writer(const Hdf5Writer&) = delete;
  Hdf5Writer& operator=(const Hdf5Writer&) = delete;

  void put(const std::string& path, const RowMatrixXd& matrix);
  void put(const std::string& path, const RowMatrixXi& matrix);
  void put(const std::string& path, const Eigen::VectorXd& vector);
  void put(const std::string& path, const Eigen::VectorXi& vector);
  void put(const std::string& path, double scalar);
  void put(const std::string& path, std::int64_t scalar);
  void put(const std::string& path, const std::string& text);
  void put(const std::string& path, const std::vector<std::string>& texts);
  // Attribute of the root group.
  void put_attribute(const std::string& name, std::int64_t value);

  Bytes image();                                 // the file as bytes
  void save(const std::filesystem::path& path);  // atomic

 private:
  std::int64_t file_;  // hid_t
};

// Reads a file made by Hdf5Writer. Throws Error(io) that names the file and the dataset when something is missing or
// has another shape than asked for.
class Hdf5Reader {
 public:
  explicit Hdf5Reader(const std::filesystem::path& path);
  ~Hdf5Reader();
  Hdf5Reader(const Hdf5Reader&) = delete;
  Hdf5Reader& operator=(const Hdf5Reader&) = delete;

  bool has(const std::string& path) const;
  std::vector<std::string> children(const std::string& group) const;  // in order of name
  RowMatrixXd matrix(const std::string& path) const;
  RowMatrixXi int_matrix(const std::string& path) const;
  Eigen::VectorXd vector(const std::string& path) const;
  Eigen::VectorXi int_vector(const std::string& path) const;
  double scalar(const std::string& path) const;
  std::int64_t integer(const std::string& path) const;
  std::string text(const std::string& path) const;
  std::vector<std::string> texts(const std::string& path) const;
  std::int64_t attribute(const std::string& name) const;

 private:
  std::filesystem::path path_;
  std::int64_t file_;  // hid_t
};

}  // namespace vivify

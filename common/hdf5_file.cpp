#include "common/hdf5_file.h"

#include <hdf5.h>

#include <algorithm>
#include <limits>
#include <mutex>
#include <utility>

#include "common/error.h"

namespace vivify {
namespace {

static_assert(sizeof(hid_t) == sizeof(std::int64_t));

// The HDF5 library may have been built without thread safety.
std::mutex& library() {
  static std::mutex mutex;
  static const herr_t silenced = H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  (void)silenced;
  return mutex;
}

// HDF5 takes two files in memory with one name for the same file.
std::string new_name() {
  static std::uint64_t count = 0;
  return "in memory " + std::to_string(++count);
}

// A handle of HDF5 that closes itself.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  explicit operator bool() const { return id_ >= 0; }
  hid_t get() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

[[noreturn]] void fail_writing(const std::string& path) {
  throw Error(ErrorKind::internal, "HDF5 could not make the dataset " + path, "is it written twice?");
}

// Groups on the way are made; no times are kept, so that the bytes depend on the content only.
void write_dataset(hid_t file, const std::string& path, hid_t type, const std::vector<hsize_t>& shape,
                   const void* data, hid_t memory_type) {
  const Handle space(shape.empty() ? H5Screate(H5S_SCALAR)
                                   : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                     H5Sclose);
  const Handle link(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  if (!space || !link || !creation || H5Pset_create_intermediate_group(link.get(), 1) < 0 ||
      H5Pset_obj_track_times(creation.get(), false) < 0) {
    fail_writing(path);
  }
  const Handle dataset(
      H5Dcreate2(file, path.c_str(), type, space.get(), link.get(), creation.get(), H5P_DEFAULT), H5Dclose);
  if (!dataset) fail_writing(path);
  const bool is_empty = std::find(shape.begin(), shape.end(), 0U) != shape.end();
  if (!is_empty && H5Dwrite(dataset.get(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0)
    fail_writing(path);
}

// Text of a fixed number of bytes, padded with zeros.
Handle text_type(std::size_t bytes) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  if (!type || H5Tset_size(type.get(), std::max<std::size_t>(bytes, 1)) < 0 ||
      H5Tset_strpad(type.get(), H5T_STR_NULLPAD) < 0 || H5Tset_cset(type.get(), H5T_CSET_UTF8) < 0) {
    throw Error(ErrorKind::internal, "HDF5 could not make a text type");
  }
  return type;
}

std::vector<hsize_t> shape_of(Eigen::Index rows, Eigen::Index cols) {
  return {static_cast<hsize_t>(rows), static_cast<hsize_t>(cols)};
}

}  // namespace

Hdf5Writer::Hdf5Writer() : file_(-1) {
  const std::scoped_lock lock(library());
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  if (access && H5Pset_fapl_core(access.get(), 1 << 16, false) >= 0) {
    file_ = H5Fcreate(new_name().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get());
  }
  if (file_ < 0) throw Error(ErrorKind::internal, "HDF5 could not make a file in memory");
}

Hdf5Writer::~Hdf5Writer() {
  const std::scoped_lock lock(library());
  H5Fclose(file_);
}

void Hdf5Writer::put(const std::string& path, const RowMatrixXd& matrix) {
  const std::scoped_lock lock(library());
  write_dataset(file_, path, H5T_IEEE_F64LE, shape_of(matrix.rows(), matrix.cols()), matrix.data(),
                H5T_NATIVE_DOUBLE);
}

void Hdf5Writer::put(const std::string& path, const RowMatrixXi& matrix) {
  const std::scoped_lock lock(library());
  write_dataset(file_, path, H5T_STD_I32LE, shape_of(matrix.rows(), matrix.cols()), matrix.data(),
                H5T_NATIVE_INT);
}

void Hdf5Writer::put(const std::string& path, const Eigen::VectorXd& vector) {
  const std::scoped_lock lock(library());
  write_dataset(file_, path, H5T_IEEE_F64LE, {static_cast<hsize_t>(vector.size())}, vector.data(),
                H5T_NATIVE_DOUBLE);
}

void Hdf5Writer::put(const std::string& path, const Eigen::VectorXi& vector) {
  const std::scoped_lock lock(library());
  write_dataset(file_, path, H5T_STD_I32LE, {static_cast<hsize_t>(vector.size())}, vector.data(),
                H5T_NATIVE_INT);
}

void Hdf5Writer::put(const std::string& path, double scalar) {
  const std::scoped_lock lock(library());
  write_dataset(file_, path, H5T_IEEE_F64LE, {}, &scalar, H5T_NATIVE_DOUBLE);
}

void Hdf5Writer::put(const std::string& path, std::int64_t scalar) {
  const std::scoped_lock lock(library());
  write_dataset(file_, path, H5T_STD_I64LE, {}, &scalar, H5T_NATIVE_INT64);
}

void Hdf5Writer::put(const std::string& path, const std::string& text) {
  const std::scoped_lock lock(library());
  const Handle type = text_type(text.size());
  write_dataset(file_, path, type.get(), {}, text.c_str(), type.get());
}

void Hdf5Writer::put(const std::string& path, const std::vector<std::string>& texts) {
  std::size_t width = 1;
  for (const std::string& text : texts) width = std::max(width, text.size());
  std::string packed(width * texts.size(), '\0');
  for (std::size_t i = 0; i < texts.size(); ++i) texts[i].copy(packed.data() + i * width, width);
  const std::scoped_lock lock(library());
  const Handle type = text_type(width);
  write_dataset(file_, path, type.get(), {texts.size()}, packed.data(), type.get());
}

void Hdf5Writer::put_attribute(const std::string& name, std::int64_t value) {
  const std::scoped_lock lock(library());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(
      H5Acreate2(file_, name.c_str(), H5T_STD_I64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (!attribute || H5Awrite(attribute.get(), H5T_NATIVE_INT64, &value) < 0)
    fail_writing("attribute " + name);
}

Bytes Hdf5Writer::image() {
  const std::scoped_lock lock(library());
  ssize_t size = -1;
  if (H5Fflush(file_, H5F_SCOPE_LOCAL) >= 0) size = H5Fget_file_image(file_, nullptr, 0);
  if (size >= 0) {
    Bytes bytes(static_cast<std::size_t>(size));
    if (H5Fget_file_image(file_, bytes.data(), bytes.size()) == size) return bytes;
  }
  throw Error(ErrorKind::internal, "HDF5 could not give the image of a file");
}

void Hdf5Writer::save(const std::filesystem::path& path) { write_file_atomic(path, image()); }

namespace {

[[noreturn]] void fail_reading(const std::filesystem::path& file, const std::string& path,
                               const std::string& what) {
  throw Error(ErrorKind::io, file.string() + ": dataset " + path + " " + what,
              "the file may be damaged or of another version: remove it and run again");
}

// Every link on the way must be there; H5Lexists fails when a group on the way is missing.
bool exists(hid_t file, const std::string& path) {
  if (path == "/") return true;
  for (std::size_t slash = path.find('/', 1);; slash = path.find('/', slash + 1)) {
    if (H5Lexists(file, path.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) return false;
    if (slash == std::string::npos) return true;
  }
}

std::string shape_text(const std::vector<hsize_t>& shape) {
  if (shape.empty()) return "a scalar";
  std::string text;
  for (const hsize_t n : shape) text += (text.empty() ? "" : " by ") + std::to_string(n);
  return text;
}

struct Dataset {
  Handle dataset;
  Handle type;
  std::vector<hsize_t> shape;
};

// Opens a dataset of `rank` dimensions and of the class of type asked for.
Dataset open_dataset(hid_t file, const std::filesystem::path& file_path, const std::string& path,
                     std::size_t rank, H5T_class_t type_class) {
  if (!exists(file, path)) fail_reading(file_path, path, "is missing");
  const hid_t id = H5Dopen2(file, path.c_str(), H5P_DEFAULT);
  if (id < 0) fail_reading(file_path, path, "cannot be opened");
  Dataset result{Handle(id, H5Dclose), Handle(H5Dget_type(id), H5Tclose), {}};
  const Handle space(H5Dget_space(id), H5Sclose);
  const int dimensions = space ? H5Sget_simple_extent_ndims(space.get()) : -1;
  if (!result.type || dimensions < 0) fail_reading(file_path, path, "cannot be opened");
  result.shape.resize(static_cast<std::size_t>(dimensions));
  if (dimensions > 0) H5Sget_simple_extent_dims(space.get(), result.shape.data(), nullptr);
  if (result.shape.size() != rank) {
    fail_reading(
        file_path, path,
        "has the shape " + shape_text(result.shape) + " instead of " + std::to_string(rank) + " dimensions");
  }
  if (H5Tget_class(result.type.get()) != type_class)
    fail_reading(file_path, path, "holds another type of values");

  // A damaged header must not make us ask for all memory.
  hsize_t file_size = 0;
  H5Fget_filesize(file, &file_size);
  double bytes = static_cast<double>(H5Tget_size(result.type.get()));
  for (const hsize_t n : result.shape) bytes *= static_cast<double>(n);
  const bool too_long = std::any_of(result.shape.begin(), result.shape.end(),
                                    [](hsize_t n) { return n > std::numeric_limits<int>::max(); });
  if (too_long || bytes > static_cast<double>(file_size))
    fail_reading(file_path, path, "is larger than the file");
  return result;
}

void read_values(const Dataset& dataset, hid_t memory_type, void* data,
                 const std::filesystem::path& file_path, const std::string& path) {
  if (std::find(dataset.shape.begin(), dataset.shape.end(), 0U) != dataset.shape.end()) return;
  if (H5Dread(dataset.dataset.get(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0) {
    fail_reading(file_path, path, "cannot be read");
  }
}

}  // namespace

Hdf5Reader::Hdf5Reader(const std::filesystem::path& path) : path_(path), file_(-1) {
  Bytes bytes = read_file(path);
  const std::scoped_lock lock(library());
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  if (!bytes.empty() && access && H5Pset_fapl_core(access.get(), 1 << 16, false) >= 0 &&
      H5Pset_file_image(access.get(), bytes.data(), bytes.size()) >= 0) {
    file_ = H5Fopen(new_name().c_str(), H5F_ACC_RDONLY, access.get());
  }
  if (file_ < 0) {
    throw Error(ErrorKind::io, path.string() + " is not a whole HDF5 file", "remove it and run again");
  }
}

Hdf5Reader::~Hdf5Reader() {
  const std::scoped_lock lock(library());
  H5Fclose(file_);
}

bool Hdf5Reader::has(const std::string& path) const {
  const std::scoped_lock lock(library());
  return exists(file_, path);
}

std::vector<std::string> Hdf5Reader::children(const std::string& group) const {
  const std::scoped_lock lock(library());
  if (!exists(file_, group)) {
    throw Error(ErrorKind::io, path_.string() + ": group " + group + " is missing",
                "the file may be damaged or of another version: remove it and run again");
  }
  std::vector<std::string> names;
  const auto collect = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  if (H5Literate_by_name(file_, group.c_str(), H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names,
                         H5P_DEFAULT) < 0) {
    throw Error(ErrorKind::io, path_.string() + ": " + group + " is not a group");
  }
  return names;
}

RowMatrixXd Hdf5Reader::matrix(const std::string& path) const {
  const std::scoped_lock lock(library());
  const Dataset dataset = open_dataset(file_, path_, path, 2, H5T_FLOAT);
  RowMatrixXd matrix(static_cast<Eigen::Index>(dataset.shape[0]),
                     static_cast<Eigen::Index>(dataset.shape[1]));
  read_values(dataset, H5T_NATIVE_DOUBLE, matrix.data(), path_, path);
  return matrix;
}

RowMatrixXi Hdf5Reader::int_matrix(const std::string& path) const {
  const std::scoped_lock lock(library());
  const Dataset dataset = open_dataset(file_, path_, path, 2, H5T_INTEGER);
  RowMatrixXi matrix(static_cast<Eigen::Index>(dataset.shape[0]),
                     static_cast<Eigen::Index>(dataset.shape[1]));
  read_values(dataset, H5T_NATIVE_INT, matrix.data(), path_, path);
  return matrix;
}

Eigen::VectorXd Hdf5Reader::vector(const std::string& path) const {
  const std::scoped_lock lock(library());
  const Dataset dataset = open_dataset(file_, path_, path, 1, H5T_FLOAT);
  Eigen::VectorXd vector(static_cast<Eigen::Index>(dataset.shape[0]));
  read_values(dataset, H5T_NATIVE_DOUBLE, vector.data(), path_, path);
  return vector;
}

Eigen::VectorXi Hdf5Reader::int_vector(const std::string& path) const {
  const std::scoped_lock lock(library());
  const Dataset dataset = open_dataset(file_, path_, path, 1, H5T_INTEGER);
  Eigen::VectorXi vector(static_cast<Eigen::Index>(dataset.shape[0]));
  read_values(dataset, H5T_NATIVE_INT, vector.data(), path_, path);
  return vector;
}

double Hdf5Reader::scalar(const std::string& path) const {
  const std::scoped_lock lock(library());
  double value = 0;
  read_values(open_dataset(file_, path_, path, 0, H5T_FLOAT), H5T_NATIVE_DOUBLE, &value, path_, path);
  return value;
}

std::int64_t Hdf5Reader::integer(const std::string& path) const {
  const std::scoped_lock lock(library());
  std::int64_t value = 0;
  read_values(open_dataset(file_, path_, path, 0, H5T_INTEGER), H5T_NATIVE_INT64, &value, path_, path);
  return value;
}

namespace {

// The texts of a dataset that holds `count` of them.
std::vector<std::string> read_texts(const Dataset& dataset, std::size_t count,
                                    const std::filesystem::path& file_path, const std::string& path) {
  if (H5Tis_variable_str(dataset.type.get()) != 0)
    fail_reading(file_path, path, "holds text of variable length");
  const std::size_t width = H5Tget_size(dataset.type.get());
  std::string packed(width * count, '\0');
  read_values(dataset, dataset.type.get(), packed.data(), file_path, path);
  std::vector<std::string> texts(count);
  for (std::size_t i = 0; i < count; ++i) {
    texts[i] = packed.substr(i * width, width);
    texts[i].erase(texts[i].find_last_not_of('\0') + 1);
  }
  return texts;
}

}  // namespace

std::string Hdf5Reader::text(const std::string& path) const {
  const std::scoped_lock lock(library());
  return read_texts(open_dataset(file_, path_, path, 0, H5T_STRING), 1, path_, path).front();
}

std::vector<std::string> Hdf5Reader::texts(const std::string& path) const {
  const std::scoped_lock lock(library());
  const Dataset dataset = open_dataset(file_, path_, path, 1, H5T_STRING);
  return read_texts(dataset, dataset.shape[0], path_, path);
}

std::int64_t Hdf5Reader::attribute(const std::string& name) const {
  const std::scoped_lock lock(library());
  const Handle attribute(H5Aexists(file_, name.c_str()) > 0 ? H5Aopen(file_, name.c_str(), H5P_DEFAULT) : -1,
                         H5Aclose);
  std::int64_t value = 0;
  if (!attribute || H5Aread(attribute.get(), H5T_NATIVE_INT64, &value) < 0) {
    throw Error(ErrorKind::io, path_.string() + ": attribute " + name + " is missing",
                "the file may be of another version: remove it and run again");
  }
  return value;
}

}  // namespace vivify

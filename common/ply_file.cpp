#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <sstream>

#include "common/error.h"
#include "common/polygon_mesh.h"

namespace vivify {
namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct Property {
  std::string name;
  Type type = Type::float32;
  bool is_list = false;
  Type count_type = Type::uint8;
};

struct Element {
  std::string name;
  long count = 0;
  std::vector<Property> properties;

  int find(std::initializer_list<std::string_view> names) const {
    for (std::size_t i = 0; i < properties.size(); ++i) {
      if (std::find(names.begin(), names.end(), properties[i].name) != names.end())
        return static_cast<int>(i);
    }
    return -1;
  }
};

class PlyReader {
 public:
  PlyReader(const std::string& file_name, const Bytes& content)
      : file_name_(file_name), text_(reinterpret_cast<const char*>(content.data()), content.size()) {}

  PolygonMesh read() {
    read_header();
    PolygonMesh mesh;
    bool has_vertices = false;
    for (const Element& element : elements_) {
      where_ = "in element " + element.name;
      has_vertices = has_vertices || element.name == "vertex";
      if (element.name == "vertex") {
        read_vertices(element, mesh);
      } else if (element.name == "face") {
        read_faces(element, mesh);
      } else {
        for (long i = 0; i < element.count; ++i) read_row(element);
      }
    }
    if (!has_vertices) fail("has no element 'vertex'");
    return mesh;
  }

 private:
  enum class Format { ascii, little, big };

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::geometry, file_name_ + " is a broken PLY file: it " + what,
                "export the asset again");
  }

  std::string header_line() {
    const std::size_t end = text_.find('\n', at_);
    if (end == std::string_view::npos) fail("ends within the header");
    std::string line(text_.substr(at_, end - at_));
    if (!line.empty() && line.back() == '\r') line.pop_back();
    at_ = end + 1;
    return line;
  }

  Type type_of(const std::string& name) const {
    static const std::vector<std::pair<std::string, Type>> kTypes = {
        {"char", Type::int8},      {"int8", Type::int8},       {"uchar", Type::uint8},
        {"uint8", Type::uint8},    {"short", Type::int16},     {"int16", Type::int16},
        {"ushort", Type::uint16},  {"uint16", Type::uint16},   {"int", Type::int32},
        {"int32", Type::int32},    {"uint", Type::uint32},     {"uint32", Type::uint32},
        {"float", Type::float32},  {"float32", Type::float32}, {"double", Type::float64},
        {"float64", Type::float64}};
    for (const auto& [known, type] : kTypes) {
      if (known == name) return type;
    }
    fail("has a property of the unknown type '" + name + "'");
  }

  void read_header() {
    if (!text_.starts_with("ply\n") && !text_.starts_with("ply\r\n")) fail("does not begin with 'ply'");
    bool has_format = false;
    for (std::string line = header_line(); line != "end_header"; line = header_line()) {
      std::istringstream words(line);
      std::string word, a, b, c, d;
      words >> word >> a >> b >> c >> d;
      if (word == "format") {
        if (a != "ascii" && a != "binary_little_endian" && a != "binary_big_endian")
          fail("has the unknown format '" + a + "'");
        format_ = a == "ascii" ? Format::ascii : a == "binary_big_endian" ? Format::big : Format::little;
        has_format = true;
      } else if (word == "element") {
        Element element{a, 0, {}};
        const auto [end, error] = std::from_chars(b.data(), b.data() + b.size(), element.count);
        if (error != std::errc() || end != b.data() + b.size() || element.count < 0)
          fail("has the odd header line '" + line + "'");
        elements_.push_back(std::move(element));
      } else if (word == "property" && !elements_.empty()) {
        Property property;
        property.is_list = a == "list";
        if (property.is_list) property.count_type = type_of(b);
        property.type = type_of(property.is_list ? c : a);
        property.name = property.is_list ? d : b;
        elements_.back().properties.push_back(std::move(property));
      } else if (word != "comment" && word != "obj_info" && word != "ply") {
        fail("has the odd header line '" + line.substr(0, 60) + "'");
      }
    }
    if (!has_format) fail("names no format");
  }

  template <class T>
  T take() {
    if (text_.size() - at_ < sizeof(T)) fail("ends too early, " + where_);
    char bytes[sizeof(T)];
    std::memcpy(bytes, text_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    if (format_ == Format::big) std::reverse(bytes, bytes + sizeof(T));
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
  }

  double read_number(Type type) {
    if (format_ == Format::ascii) return read_word();
    static_assert(std::endian::native == std::endian::little);
    switch (type) {
      case Type::int8:
        return take<std::int8_t>();
      case Type::uint8:
        return take<std::uint8_t>();
      case Type::int16:
        return take<std::int16_t>();
      case Type::uint16:
        return take<std::uint16_t>();
      case Type::int32:
        return take<std::int32_t>();
      case Type::uint32:
        return take<std::uint32_t>();
      case Type::float32:
        return static_cast<double>(take<float>());
      case Type::float64:
        return take<double>();
    }
    return 0;
  }

  double read_word() {
    constexpr std::string_view kSpace = " \t\r\n";
    const std::size_t begin = text_.find_first_not_of(kSpace, at_);
    if (begin == std::string_view::npos) fail("ends too early, " + where_);
    const std::size_t end = std::min(text_.find_first_of(kSpace, begin), text_.size());
    at_ = end;
    const std::size_t skip = text_[begin] == '+' ? 1 : 0;
    double value = 0;
    const char* const last = text_.data() + end;
    const auto [stop, error] = std::from_chars(text_.data() + begin + skip, last, value);
    if (error == std::errc::result_out_of_range && stop == last)
      return INFINITY;  // found by the check of the vertices
    if (error != std::errc() || stop != last) {
      fail("has '" + std::string(text_.substr(begin, std::min<std::size_t>(end - begin, 30))) +
           "' for a number, " + where_);
    }
    return value;
  }

  // The values of one row; those of lists go to list_ (the last list that is wanted wins).
  void read_row(const Element& element, int wanted_list = -1) {
    row_.clear();
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const Property& property = element.properties[i];
      if (!property.is_list) {
        row_.push_back(read_number(property.type));
        continue;
      }
      row_.push_back(0);
      const double count = read_number(property.count_type);
      if (!(count >= 0 && count <= static_cast<double>(text_.size()) && count == std::floor(count))) {
        fail("has a list of odd length, " + where_);
      }
      list_scratch_.clear();
      for (double k = 0; k < count; ++k) list_scratch_.push_back(read_number(property.type));
      if (static_cast<int>(i) == wanted_list) std::swap(list_, list_scratch_);
    }
  }

  void read_vertices(const Element& element, PolygonMesh& mesh) {
    const int x = element.find({"x"}), y = element.find({"y"}), z = element.find({"z"});
    if (x < 0 || y < 0 || z < 0) fail("has vertices without x, y or z");
    const int u = element.find({"s", "u", "texture_u", "texture_s"}),
              v = element.find({"t", "v", "texture_v", "texture_t"});
    for (long i = 0; i < element.count; ++i) {
      read_row(element);
      const auto at = [&](int column) { return row_[static_cast<std::size_t>(column)]; };
      mesh.points.emplace_back(at(x), at(y), at(z));
      if (u >= 0 && v >= 0) mesh.texture.emplace_back(at(u), at(v));
    }
  }

  void read_faces(const Element& element, PolygonMesh& mesh) {
    const int corners = element.find({"vertex_indices", "vertex_index"});
    if (corners < 0 || !element.properties[static_cast<std::size_t>(corners)].is_list)
      fail("has faces without vertex_indices");
    for (long i = 0; i < element.count; ++i) {
      read_row(element, corners);
      std::vector<long> face;
      for (const double index : list_) {
        const bool whole = std::abs(index) < 1e15 && index == std::floor(index);
        face.push_back(whole ? static_cast<long>(index) : -1);
      }
      mesh.faces.push_back(std::move(face));
    }
  }

  const std::string& file_name_;
  std::string_view text_;
  std::size_t at_ = 0;
  Format format_ = Format::ascii;
  std::vector<Element> elements_;
  std::string where_;
  std::vector<double> row_, list_, list_scratch_;
};

}  // namespace

PolygonMesh read_ply(const std::string& file_name, const Bytes& content) {
  return PlyReader(file_name, content).read();
}

}  // namespace vivify

#include "meshing/svg.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>
#include <pugixml.hpp>
#include <set>
#include <string_view>

#include "common/error.h"
#include "common/file.h"
#include "common/text.h"

namespace vivify::meshing {
namespace {

constexpr double kRadians = std::numbers::pi / 180;

bool is_space(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }
bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

// Numbers and letters of path data and transforms, with their positions.
class Scanner {
 public:
  Scanner(std::string_view text, std::string name) : text_(text), name_(std::move(name)) {}

  bool at_end() {
    skip();
    return at_ == text_.size();
  }
  bool at_number() {
    skip();
    return at_ < text_.size() && (std::isdigit(static_cast<unsigned char>(text_[at_])) != 0 ||
                                  text_[at_] == '.' || text_[at_] == '-' || text_[at_] == '+');
  }
  char take() { return text_[at_++]; }
  std::string word() {
    skip();
    const std::size_t first = at_;
    while (at_ < text_.size() && is_letter(text_[at_])) ++at_;
    return std::string(text_.substr(first, at_ - first));
  }
  void expect(char c) {
    skip();
    if (at_ == text_.size() || text_[at_] != c) fail(std::string("'") + c + "' is missing");
    ++at_;
  }
  bool accept(char c) {
    skip();
    if (at_ == text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  double number() {
    skip();
    if (at_ < text_.size() && text_[at_] == '+') ++at_;
    double value = 0;
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (error != std::errc() || !std::isfinite(value)) fail("a number is missing");
    at_ = static_cast<std::size_t>(end - text_.data());
    return value;
  }
  // 0 or 1, which may be written without a space after it.
  bool flag() {
    skip();
    if (at_ == text_.size() || (text_[at_] != '0' && text_[at_] != '1')) fail("a flag (0 or 1) is missing");
    return text_[at_++] == '1';
  }
  std::size_t position() const { return at_ + 1; }

  [[noreturn]] void fail(const std::string& problem, std::size_t position = 0) const {
    throw Error(ErrorKind::geometry,
                name_ + ": " + problem + " at character " +
                    std::to_string(position == 0 ? at_ + 1 : position) + " of \"" + excerpt() + "\"",
                "repair the drawing, or save it again as plain SVG");
  }

 private:
  void skip() {
    while (at_ < text_.size() && (is_space(text_[at_]) || text_[at_] == ',')) ++at_;
  }
  std::string excerpt() const {
    return text_.size() <= 40 ? std::string(text_) : std::string(text_.substr(0, 40)) + "…";
  }

  std::string_view text_;
  std::string name_;
  std::size_t at_ = 0;
};

Eigen::Affine2d parse_transform(const std::string& text, const std::string& name) {
  Eigen::Affine2d result = Eigen::Affine2d::Identity();
  Scanner scanner(text, name + ": transform");
  while (!scanner.at_end()) {
    const std::size_t position = scanner.position();
    const std::string kind = scanner.word();
    scanner.expect('(');
    std::vector<double> v;
    while (!scanner.accept(')')) v.push_back(scanner.number());
    Eigen::Affine2d map = Eigen::Affine2d::Identity();
    if (kind == "matrix" && v.size() == 6) {
      map.matrix() << v[0], v[2], v[4], v[1], v[3], v[5], 0, 0, 1;
    } else if (kind == "translate" && (v.size() == 1 || v.size() == 2)) {
      map.translate(Eigen::Vector2d(v[0], v.size() == 2 ? v[1] : 0));
    } else if (kind == "scale" && (v.size() == 1 || v.size() == 2)) {
      map.scale(Eigen::Vector2d(v[0], v.back()));
    } else if (kind == "rotate" && (v.size() == 1 || v.size() == 3)) {
      const Eigen::Vector2d centre = v.size() == 3 ? Eigen::Vector2d(v[1], v[2]) : Eigen::Vector2d::Zero();
      map.translate(centre).rotate(v[0] * kRadians).translate(-centre);
    } else if (kind == "skewX" && v.size() == 1) {
      map.matrix()(0, 1) = std::tan(v[0] * kRadians);
    } else if (kind == "skewY" && v.size() == 1) {
      map.matrix()(1, 0) = std::tan(v[0] * kRadians);
    } else {
      scanner.fail("'" + kind + "' with " + std::to_string(v.size()) + " numbers is not a transform",
                   position);
    }
    result = result * map;
  }
  return result;
}

// The value of a presentation attribute: the attribute itself, or its entry in `style`.
std::string property(const pugi::xml_node& node, const std::string& key) {
  const std::string style = node.attribute("style").value();
  for (std::size_t begin = 0; begin < style.size();) {
    const std::size_t end = std::min(style.find(';', begin), style.size());
    std::string entry = style.substr(begin, end - begin);
    std::erase_if(entry, is_space);
    if (entry.starts_with(key + ":")) return entry.substr(key.size() + 1);
    begin = end + 1;
  }
  return node.attribute(key.c_str()).value();
}

std::string local_name(const pugi::xml_node& node) {
  const std::string name = node.name();
  return name.substr(name.find(':') + 1);  // npos + 1 is 0
}

class Reader {
 public:
  Reader(const std::filesystem::path& file, std::string id) : file_(file), id_(std::move(id)) {
    content_ = read_text_file(file);
    const pugi::xml_parse_result result = document_.load_buffer(content_.data(), content_.size());
    if (!result) {
      throw Error(ErrorKind::geometry, std::string("the file is not XML: ") + result.description(),
                  "save the drawing again as plain SVG", {file_.string(), line(result.offset), 0});
    }
  }

  std::vector<SvgShape> read() {
    visit(document_, Eigen::Affine2d(Eigen::Scaling(1.0, -1.0)), false, id_.empty());
    if (!id_.empty() && !found_) {
      throw Error(
          ErrorKind::geometry, file_.string() + " has no element with the id '" + id_ + "'",
          ids_.empty() ? "no path has an id: leave `id` out" : "the ids of its paths: " + join_words(ids_));
    }
    if (shapes_.empty()) {
      throw Error(ErrorKind::geometry,
                  file_.string() + (id_.empty() ? " has no path" : ": '" + id_ + "' holds no path"),
                  "turn the objects of the drawing into paths");
    }
    return std::move(shapes_);
  }

 private:
  int line(std::ptrdiff_t offset) const {
    const auto end = content_.begin() + std::clamp<std::ptrdiff_t>(offset, 0, std::ssize(content_));
    return 1 + static_cast<int>(std::count(content_.begin(), end, '\n'));
  }

  void visit(const pugi::xml_node& parent, const Eigen::Affine2d& map, bool even_odd, bool wanted) {
    static const std::set<std::string> kNotDrawn = {"defs",   "clipPath", "mask",
                                                    "marker", "pattern",  "symbol"};
    for (const pugi::xml_node& node : parent.children()) {
      const std::string kind = local_name(node), id = node.attribute("id").value();
      const bool named = !id_.empty() && id == id_;
      if (node.type() != pugi::node_element || (kNotDrawn.contains(kind) && id_.empty())) continue;
      found_ = found_ || named;
      const std::string place = "line " + std::to_string(line(node.offset_debug())) + " of " + file_.string();
      const std::string rule = property(node, "fill-rule");
      const bool node_even_odd = rule.empty() || rule == "inherit" ? even_odd : rule == "evenodd";
      const Eigen::Affine2d node_map = map * parse_transform(node.attribute("transform").value(), place);
      if (kind == "path") {
        if (!id.empty() && ids_.size() < 8) ids_.push_back(id);
        if (wanted || named) {
          add(node, place + (id.empty() ? ": path" : ": path '" + id + "'"), node_map, node_even_odd);
        }
      }
      visit(node, node_map, node_even_odd, wanted || named);
    }
  }

  void add(const pugi::xml_node& node, const std::string& name, const Eigen::Affine2d& map, bool even_odd) {
    SvgShape shape;
    shape.even_odd = even_odd;
    shape.contours = svg_path_contours(node.attribute("d").value(), name);
    int number = 0;
    for (CurveContour& contour : shape.contours) {
      ++number;
      const double size = contour.control_box().diagonal().norm();
      if (!contour.closed() && (contour.end() - contour.start()).norm() > 1e-6 * size) {
        throw Error(ErrorKind::geometry,
                    name + " is open: contour " + std::to_string(number) + " starts at (" +
                        number_text(contour.start().x()) + ", " + number_text(contour.start().y()) +
                        ") and ends at (" + number_text(contour.end().x()) + ", " +
                        number_text(contour.end().y()) + ")",
                    "close it with Z, or turn the stroke into a path");
      }
      contour.transform(map);
    }
    if (!shape.contours.empty()) shapes_.push_back(std::move(shape));
  }

  std::filesystem::path file_;
  std::string id_, content_;
  pugi::xml_document document_;
  bool found_ = false;
  std::vector<std::string> ids_;
  std::vector<SvgShape> shapes_;
};

}  // namespace

std::vector<CurveContour> svg_path_contours(const std::string& data, const std::string& name) {
  Scanner scanner(data, name);
  std::vector<CurveContour> contours;
  Eigen::Vector2d at = Eigen::Vector2d::Zero(), last_control = at;
  char command = 0, before = 0;
  const auto point = [&] {
    const double x = scanner.number(), y = scanner.number();
    const Eigen::Vector2d p(x, y);
    return std::islower(static_cast<unsigned char>(command)) != 0 ? Eigen::Vector2d(at + p) : p;
  };
  // Control point of S and T: the last one mirrored, when the command before was of the same kind.
  const auto mirrored = [&](std::string_view kinds) {
    return kinds.find(before) == kinds.npos ? at : Eigen::Vector2d(2 * at - last_control);
  };
  while (!scanner.at_end()) {
    if (!scanner.at_number()) {
      const std::size_t position = scanner.position();
      command = scanner.take();
      if (std::string_view("MmLlHhVvCcSsQqTtAaZz").find(command) == std::string_view::npos) {
        scanner.fail(std::string("unknown command '") + command + "'", position);
      }
      if (contours.empty() && command != 'M' && command != 'm') {
        scanner.fail(std::string("the path starts with '") + command + "' instead of 'M'", position);
      }
    } else if (command == 0 || command == 'Z' || command == 'z') {
      scanner.fail("a command is missing");
    }
    const char kind = static_cast<char>(std::toupper(static_cast<unsigned char>(command)));
    if (kind != 'M' && kind != 'Z' && contours.back().closed()) contours.emplace_back(at);
    switch (kind) {
      case 'M':
        contours.emplace_back(point());
        command = command == 'M' ? 'L' : 'l';  // further points are lines
        break;
      case 'L':
        contours.back().line_to(point());
        break;
      case 'H': {
        const double x = scanner.number();
        contours.back().line_to({command == 'h' ? at.x() + x : x, at.y()});
        break;
      }
      case 'V': {
        const double y = scanner.number();
        contours.back().line_to({at.x(), command == 'v' ? at.y() + y : y});
        break;
      }
      case 'C':
      case 'S': {
        const Eigen::Vector2d first = kind == 'C' ? point() : mirrored("CS");
        last_control = point();
        contours.back().cubic_to(first, last_control, point());
        break;
      }
      case 'Q':
      case 'T':
        last_control = kind == 'Q' ? point() : mirrored("QT");
        contours.back().quadratic_to(last_control, point());
        break;
      case 'A': {
        const double rx = scanner.number(), ry = scanner.number(), rotation = scanner.number() * kRadians;
        const bool large = scanner.flag(), sweep = scanner.flag();
        contours.back().arc_to({rx, ry}, rotation, large, sweep, point());
        break;
      }
      default:
        contours.back().close();
    }
    at = kind == 'Z' ? contours.back().start() : contours.back().end();
    before = kind;
  }
  std::erase_if(contours, [](const CurveContour& contour) { return contour.empty(); });
  return contours;
}

std::vector<SvgShape> svg_shapes(const std::filesystem::path& file, const std::string& id) {
  return Reader(file, id).read();
}

}  // namespace vivify::meshing

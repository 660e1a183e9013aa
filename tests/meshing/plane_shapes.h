// Polygons that the tests of 2-D meshing share.
#pragma once

#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "common/config.h"
#include "common/mesh.h"
#include "common/schema.h"
#include "meshing/outline.h"

namespace vivify::meshing::shapes {

inline Points2 polygon(const std::vector<std::array<double, 2>>& corners) {
  Points2 points(static_cast<Eigen::Index>(corners.size()), 2);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    points.row(static_cast<Eigen::Index>(i)) << corners[i][0], corners[i][1];
  }
  return points;
}

inline Points2 rectangle(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  return polygon({{low.x(), low.y()}, {high.x(), low.y()}, {high.x(), high.y()}, {low.x(), high.y()}});
}

// Two arms of width 1 and height 3 with a gap of 1 between them.
inline Points2 u_polygon() {
  return polygon({{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}});
}

inline Points2 regular_polygon(int corners, double radius = 1) {
  Points2 points(corners, 2);
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    points.row(i) << radius * std::cos(angle), radius * std::sin(angle);
  }
  return points;
}

// The letter I with serifs.
inline Points2 letter_i() {
  return polygon({{-0.3, 0},
                  {0.3, 0},
                  {0.3, 0.2},
                  {0.1, 0.2},
                  {0.1, 0.8},
                  {0.3, 0.8},
                  {0.3, 1},
                  {-0.3, 1},
                  {-0.3, 0.8},
                  {-0.1, 0.8},
                  {-0.1, 0.2},
                  {-0.3, 0.2}});
}

// The setting that a text in YAML gives; an error of the schema is thrown.
inline Value setting(const Schema& schema, const std::string& yaml) {
  std::vector<Error> errors;
  const Value value = resolve(schema, parse_yaml(yaml, "s.yaml", errors), errors);
  if (!errors.empty()) throw errors.front();
  return value;
}

// A character of DejaVu Sans Bold, 1 m high.
inline Outline glyph(const std::string& text) {
  return make_outline(
      setting(
          outline_schema(),
          "{type: glyph, font: /usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf, text: '" + text + "'}"),
      [](const std::string& path) { return std::filesystem::path(path); });
}

// Loops by the even-odd rule.
inline Outline outline_of(const std::vector<Points2>& loops) {
  return clean_outline(loops, FillRule::even_odd, "test");
}

}  // namespace vivify::meshing::shapes

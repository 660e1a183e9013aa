// Shapes in the plane that 2-D characters are made of.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/mesh.h"
#include "common/schema.h"
#include "common/value.h"
#include "meshing/polygons.h"

namespace vivify::meshing {

// Closed polygons (metres) that neither cross nor overlap: outer ones counter-clockwise, holes clockwise, the
// largest first.
struct Outline {
  std::vector<Points2> loops;

  double area() const;  // m²
  int corners() const;  // vertices of all loops
};

// Cleans contours (see fill() in meshing/polygons.h). Throws Error(geometry) when they have a point that is
// not finite or fill no area; `name` names the contours in it.
Outline clean_outline(const std::vector<Points2>& contours, FillRule rule, const std::string& name);

// What an outline is made from: `type` polygon (filled even-odd), svg (by the fill rule of the drawing),
// glyph (nonzero winding) or polyline (open, for rods).
Schema outline_schema();

// Makes the outline of a value of outline_schema(). Polygons keep their coordinates; drawings and letters are
// put with their lowest point at y = 0 and the middle of their width at x = 0, curves become polylines within
// 1/2000 of their size. Throws Error(geometry) or Error(usage).
Outline make_outline(const Value& value,
                     const std::function<std::filesystem::path(const std::string&)>& resolve_path);

// The points of an open polyline.
Points2 polyline_points(const Value& value);

}  // namespace vivify::meshing

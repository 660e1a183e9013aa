// Path data of SVG drawings as contours.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "meshing/curve.h"

namespace vivify::meshing {

// Contours of the attribute `d` of a path (SVG 1.1 section 8.3: M L H V C S Q T A Z, relative and absolute),
// in its own coordinates, +Y down. Throws Error(geometry) with the position counted from 1; `name` names the
// path in it.
std::vector<CurveContour> svg_path_contours(const std::string& data, const std::string& name = "the path");

struct SvgShape {
  std::vector<CurveContour> contours;  // +Y up
  bool even_odd = false;               // fill rule
};

// The <path> elements of an SVG file under their transforms: all of them, or those of the element with the
// given id. Throws Error(geometry) when there are none or one cannot be understood or is open.
std::vector<SvgShape> svg_shapes(const std::filesystem::path& file, const std::string& id = {});

}  // namespace vivify::meshing

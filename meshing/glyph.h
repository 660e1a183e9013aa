// Letters of a font as contours.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "meshing/curve.h"

namespace vivify::meshing {

// Contours of a text (UTF-8) set on one line, in font units, +Y up; fonts fill by nonzero winding. Throws
// Error(geometry) when the font cannot be read, has no glyph for a character or draws nothing.
std::vector<CurveContour> glyph_contours(const std::filesystem::path& font, const std::string& text);

}  // namespace vivify::meshing

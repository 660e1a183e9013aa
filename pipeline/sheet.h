// The contact sheet: evenly spaced frames of a run in one picture.
#pragma once

#include <filesystem>
#include <vector>

#include "common/file.h"

namespace vivify::pipeline {

struct SheetSettings {
  int columns = 4;
  int frames = 16;            // the first, the last and evenly spaced ones between; all when there are fewer
  int width = 1280;           // of the sheet, pixels
  double exposure_stops = 0;  // of the view transform
  bool debug = false;         // with pipeline/debug_overlay.h over the frames, which need not be rendered
};

// The EXR files of a run folder (of its `render` folder those that its last rendering was asked for) or of a
// folder of frames, in order of their names.
// Throws Error(io) when the folder cannot be read or holds none.
std::vector<std::filesystem::path> list_frames(const std::filesystem::path& folder);

// The exposure that the scene of a run folder asks for; 0 for other folders.
double exposure_of(const std::filesystem::path& folder);

// The sheet as a PNG file: frames through the sRGB view transform, row by row, each above its number. The
// same frames give the same bytes. Throws Error(usage) for settings that leave no room for a picture and
// Error(io) when frames are missing or cannot be read.
Bytes contact_sheet(const std::filesystem::path& folder, const SheetSettings& settings = {});

}  // namespace vivify::pipeline

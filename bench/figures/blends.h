// Figures 4 and 5 of Coros et al. 2012: two bodies of one run that interpolate between the same poses in
// different ways, compared frame by frame. Reads the output folder of `vivify simulate`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace vivify::figures {

struct BlendFrame {
  double weight = 0;  // of the example
  double distance =
      0;  // largest, of a vertex of one body and that of the other after rigid alignment, over length
  // Largest error of the length of an edge against the length interpolated between the poses, relative.
  double first_edges = 0;
  double second_edges = 0;
};

struct Blend {
  int vertices = 0;
  int elements = 0;
  double length = 0;  // largest extent of the body at rest, m
  std::vector<BlendFrame> frames;
  // Distance of the first body at the last frame, of weight 1, to the example itself, over the length.
  double end_distance = 0;
};

// Throws Error(usage) when the bodies are not two blends of one mesh with one example, and Error(io) when a
// file is missing.
Blend compare_blends(const std::filesystem::path& out, const std::string& first, const std::string& second);

// The frame with the largest value of one of its numbers.
const BlendFrame& worst(const Blend& blend, double BlendFrame::*value);

}  // namespace vivify::figures

// The picture that a render makes: linear Rec. 709 radiance and the data planes, rows from top to bottom.
#pragma once

#include <cstddef>
#include <vector>

#include "common/file.h"

namespace vivify::render {

struct Film {
  int width = 0;
  int height = 0;
  std::vector<float> rgba;    // #pixels by 4: radiance and coverage (1 where every sample met a surface)
  std::vector<float> albedo;  // #pixels by 3: mean colour of the first surface, 0 for the background
  std::vector<float>
      normal;  // #pixels by 3: mean shading normal of the first surface in the world, 0 for the background
  std::vector<float>
      depth;  // #pixels: mean distance from the lens over the samples that met a surface (m); 0: none did
  std::vector<float>
      id;  // #pixels: object id of the sample nearest to the centre of the pixel; 0 is the background

  Film() = default;
  Film(int width, int height);
  std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};

// The film as an OpenEXR file: one part, ZIP; layers R G B A, albedo.{R,G,B} (half), normal.{X,Y,Z}, depth.Z
// and id.ID (float). Rec. 709 chromaticities, no time stamp: the same film gives the same bytes. Radiance
// beyond the range of half is clamped to its largest value. Throws Error(internal) for a film whose planes do
// not fit its size.
Bytes encode_exr(const Film& film);

// The film of a file made by encode_exr. Throws Error(io) when it is not one.
Film decode_exr(const Bytes& file);

}  // namespace vivify::render

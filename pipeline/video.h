// Frames to an H.264 video through ffmpeg.
#pragma once

#include <filesystem>
#include <span>

#include "common/progress.h"

namespace vivify::pipeline {

// Frames per second as a fraction of whole numbers.
struct FrameRate {
  int numerator = 24;
  int denominator = 1;
};

struct VideoSettings {
  FrameRate rate;
  int crf = 18;               // quality of x264: 0 is lossless, 51 the worst
  double exposure_stops = 0;  // of the view transform
};

// Throws Error(io) when there is no ffmpeg on the PATH; the message says that the frames in `frames_folder`
// are kept.
void require_ffmpeg(const std::filesystem::path& frames_folder);

// Encodes the EXR files `frames`, in this order, as the MP4 file `output`: exactly one picture per file at
// exactly the given rate, colours through the Rec.709 view transform and tagged bt709, limited range, 4:2:0.
// An odd width or height (4:2:0 has none) is made even by repeating the last column or row. The same frames
// and settings give the same bytes. The video is written under another name, checked, synced and renamed: it
// appears whole or not at all. `progress` (may be null) is advanced by one per frame; start and finish are
// the caller's. A requested stop is thrown between frames. Throws Error(io) when there is no ffmpeg, it
// fails, or a frame cannot be read or has another size than the first one.
void encode_video(std::span<const std::filesystem::path> frames, const std::filesystem::path& output,
                  const VideoSettings& settings = {}, Progress* progress = nullptr);

}  // namespace vivify::pipeline

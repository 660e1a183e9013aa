// Frame numbers as people write them: "1-100x2,7".
#pragma once

#include <string>
#include <vector>

namespace vivify::pipeline {

// The frames named by `text`, ascending and without repeats: numbers, ranges FIRST-LAST and ranges with a
// step FIRST-LASTxSTEP, separated by commas. Frames count from 1 to `last`. Throws Error(usage) when the text
// is not of this form, a range runs backwards, or a frame does not exist.
std::vector<int> parse_frames(const std::string& text, int last);

// Frames 1 … last.
std::vector<int> all_frames(int last);

// Ascending frames in the shortest such text without steps: "1-100,107".
std::string frames_text(const std::vector<int>& frames);

// A frame number as it stands in file names: four digits or more.
std::string frame_text(int frame);

}  // namespace vivify::pipeline

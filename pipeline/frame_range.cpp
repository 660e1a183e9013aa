#include "pipeline/frame_range.h"

#include <charconv>
#include <numeric>
#include <set>
#include <string_view>

#include "common/error.h"

namespace vivify::pipeline {
namespace {

[[noreturn]] void fail(const std::string& text, const std::string& problem) {
  throw Error(ErrorKind::usage, "--frames " + text + ": " + problem, "write it like 1-100x2,7");
}

int parse_number(std::string_view digits, const std::string& text) {
  int number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (digits.empty() || error != std::errc() || end != digits.data() + digits.size() ||
      digits.front() == '-') {
    fail(text, "'" + std::string(digits) + "' is not a frame number");
  }
  return number;
}

}  // namespace

std::vector<int> parse_frames(const std::string& text, int last) {
  std::set<int> frames;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    const std::string_view part = std::string_view(text).substr(begin, comma - begin);
    begin = comma + 1;

    const std::size_t dash = part.find('-');
    const std::size_t times = dash == part.npos ? part.npos : part.find('x', dash);
    const int from = parse_number(part.substr(0, dash), text);
    const int to = dash == part.npos ? from : parse_number(part.substr(dash + 1, times - dash - 1), text);
    const int step = times == part.npos ? 1 : parse_number(part.substr(times + 1), text);
    if (to < from) fail(text, "the range " + std::string(part) + " runs backwards");
    if (step < 1) fail(text, "the step of " + std::string(part) + " must be 1 or more");
    if (from < 1) fail(text, "frames count from 1");
    if (to > last) {
      fail(text,
           "there is no frame " + std::to_string(to) + ", the scene has frames 1-" + std::to_string(last));
    }
    for (int frame = from; frame <= to; frame += step) frames.insert(frame);
  }
  return {frames.begin(), frames.end()};
}

std::vector<int> all_frames(int last) {
  std::vector<int> frames(static_cast<std::size_t>(last));
  std::iota(frames.begin(), frames.end(), 1);
  return frames;
}

std::string frames_text(const std::vector<int>& frames) {
  std::string text;
  for (std::size_t i = 0; i < frames.size();) {
    std::size_t last = i;
    while (last + 1 < frames.size() && frames[last + 1] == frames[last] + 1) ++last;
    if (!text.empty()) text += ",";
    text += std::to_string(frames[i]);
    if (last > i) text += "-" + std::to_string(frames[last]);
    i = last + 1;
  }
  return text;
}

std::string frame_text(int frame) {
  const std::string digits = std::to_string(frame);
  return std::string(digits.size() < 4 ? 4 - digits.size() : 0, '0') + digits;
}

}  // namespace vivify::pipeline

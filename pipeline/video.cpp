#include "pipeline/video.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <vector>

#include "common/error.h"
#include "common/stop.h"
#include "pipeline/child_process.h"
#include "render/image_io.h"
#include "render/view_transform.h"

namespace vivify::pipeline {
namespace {

namespace fs = std::filesystem;

// A file that is removed unless it was put in place.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& target)
      : target_(target), path_(target.string() + ".tmp." + std::to_string(::getpid())) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() { ::unlink(path_.c_str()); }

  const fs::path& path() const { return path_; }

  // Syncs the file and gives it its name.
  void put_in_place() {
    const int file = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
    const bool synced = file >= 0 && ::fsync(file) == 0;
    const int error = errno;
    if (file >= 0) ::close(file);
    if (!synced) fail(error);
    if (::rename(path_.c_str(), target_.c_str()) != 0) fail(errno);
  }

 private:
  [[noreturn]] void fail(int error) const {
    throw Error(ErrorKind::io, "cannot write " + target_.string() + ": " + std::strerror(error));
  }

  fs::path target_, path_;
};

int made_even(int size) { return size + size % 2; }

// 8-bit pixels of a frame, padded to an even size.
std::vector<std::uint8_t> video_pixels(const render::RgbImage& frame, const render::ViewTransform& view) {
  const std::vector<std::uint8_t> pixels = view.pixels(frame.values);
  if (frame.width % 2 == 0 && frame.height % 2 == 0) return pixels;
  const std::size_t width = static_cast<std::size_t>(frame.width),
                    height = static_cast<std::size_t>(frame.height);
  std::vector<std::uint8_t> padded;
  for (std::size_t y = 0; y < height + height % 2; ++y) {
    const auto row = pixels.begin() + static_cast<std::ptrdiff_t>(3 * width * std::min(y, height - 1));
    const auto end = row + static_cast<std::ptrdiff_t>(3 * width);
    padded.insert(padded.end(), row, end);
    if (width % 2 == 1) padded.insert(padded.end(), end - 3, end);
  }
  return padded;
}

std::vector<std::string> ffmpeg_arguments(int width, int height, const VideoSettings& settings,
                                          const fs::path& file) {
  return {
      "-hide_banner", "-nostdin", "-nostats", "-loglevel", "error", "-y",
      // The pictures come as raw display pixels.
      "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", std::to_string(width) + "x" + std::to_string(height),
      "-framerate", std::to_string(settings.rate.numerator) + "/" + std::to_string(settings.rate.denominator),
      "-i", "pipe:0",
      // Conversion by the matrix that the tags name; the bitexact flags keep it the same on every processor.
      "-vf",
      "scale=out_color_matrix=bt709:out_range=tv:flags=bicubic+accurate_rnd+full_chroma_inp+bitexact,format="
      "yuv420p",
      "-c:v", "libx264", "-preset", "medium", "-crf", std::to_string(settings.crf),  //
      "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709", "-color_range", "tv",
      // x264 gives other bytes for other numbers of threads.
      "-threads", "1", "-map_metadata", "-1", "-fflags", "+bitexact", "-flags:v", "+bitexact",  //
      "-movflags", "+faststart", "-f", "mp4", "file:" + file.string()};
}

// The last lines that ffmpeg said, for an error message.
std::string tail(const std::string& output) {
  constexpr std::size_t kLongest = 600;
  std::string text = output.size() > kLongest ? "…" + output.substr(output.size() - kLongest) : output;
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  return text.empty() ? "it said nothing" : text;
}

// A big-endian number of `bytes` bytes at `place`; 0 behind the end of the file.
std::uint64_t number_at(std::ifstream& file, std::uint64_t place, int bytes) {
  std::uint64_t value = 0;
  file.clear();
  file.seekg(static_cast<std::streamoff>(place));
  for (int i = 0; i < bytes; ++i) value = value << 8 | static_cast<std::uint64_t>(file.get() & 0xff);
  return file ? value : 0;
}

// Number of pictures in the MP4 boxes of [begin, end) of a file: the sample counts of their `stsz` boxes
// (ISO/IEC 14496-12, 8.7.3). -1 when the boxes do not fill the range exactly, as in a file that was cut off.
long count_pictures(std::ifstream& file, std::uint64_t begin, std::uint64_t end) {
  constexpr auto name = [](const char* text) {
    std::uint64_t value = 0;
    for (int i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(text[i]);
    return value;
  };
  long count = 0;
  while (begin < end) {
    std::uint64_t size = number_at(file, begin, 4), header = 8;
    const std::uint64_t type = number_at(file, begin + 4, 4);
    if (size == 1) {
      size = number_at(file, begin + 8, 8);
      header = 16;
    }
    if (size < header || size > end - begin) return -1;
    if (type == name("stsz")) count += static_cast<long>(number_at(file, begin + header + 8, 4));
    for (const char* container : {"moov", "trak", "mdia", "minf", "stbl"}) {
      if (type != name(container)) continue;
      const long inside = count_pictures(file, begin + header, begin + size);
      if (inside < 0) return -1;
      count += inside;
    }
    begin += size;
  }
  return count;
}

// Throws when the file is not a whole video of `frames` pictures; ffmpeg ends with code 0 even when the disk
// is full.
void verify(const fs::path& file, std::size_t frames, const fs::path& output, const std::string& said,
            const std::string& hint) {
  std::error_code error;
  const std::uint64_t size = fs::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  const long found = error || !stream ? 0 : count_pictures(stream, 0, size);
  if (found == static_cast<long>(frames)) return;
  throw Error(ErrorKind::io,
              "ffmpeg did not write " + output.string() + " whole (" +
                  (found < 0 ? "it is cut off"
                             : std::to_string(found) + " of " + std::to_string(frames) + " frames") +
                  "): " + said,
              hint);
}

std::string kept(const fs::path& folder) { return "the frames are kept in " + folder.string(); }

}  // namespace

void require_ffmpeg(const fs::path& frames_folder) {
  if (!find_program("ffmpeg").empty()) return;
  throw Error(ErrorKind::io, "ffmpeg is not on the PATH; " + kept(frames_folder),
              "install it (Debian: apt-get install ffmpeg) and run `vivify encode`");
}

void encode_video(std::span<const fs::path> frames, const fs::path& output, const VideoSettings& settings,
                  Progress* progress) {
  if (frames.empty()) throw Error(ErrorKind::io, "there are no frames to encode as " + output.string());
  const fs::path folder = frames.front().parent_path();
  require_ffmpeg(folder);
  const render::ViewTransform view(render::Display::rec709, settings.exposure_stops);
  render::RgbImage frame = render::read_rgb(frames.front());
  const int width = frame.width, height = frame.height;

  TemporaryFile file(output);
  ChildProcess ffmpeg(find_program("ffmpeg"),
                      ffmpeg_arguments(made_even(width), made_even(height), settings, file.path()));
  bool alive = true;
  for (std::size_t i = 0; i < frames.size() && alive; ++i) {
    check_stop();
    if (i > 0) frame = render::read_rgb(frames[i]);
    if (frame.width != width || frame.height != height) {
      throw Error(ErrorKind::io,
                  frames[i].string() + " is " + std::to_string(frame.width) + "x" +
                      std::to_string(frame.height) + ", but the first frame is " + std::to_string(width) +
                      "x" + std::to_string(height),
                  "frames of another run may be left in the folder: render again with --force=render");
    }
    const std::vector<std::uint8_t> pixels = video_pixels(frame, view);
    alive = ffmpeg.write(std::as_bytes(std::span(pixels)));
    if (alive && progress != nullptr) progress->advance(1);
  }
  const ChildProcess::Outcome outcome = ffmpeg.finish();
  const std::string retry = kept(folder) + "; run `vivify encode` to try again";
  if (!outcome.success || !alive) {
    throw Error(
        ErrorKind::io,
        "ffmpeg " + outcome.ending + " while writing " + output.string() + ": " + tail(outcome.output),
        retry);
  }
  verify(file.path(), frames.size(), output, tail(outcome.output), retry);
  file.put_in_place();
}

}  // namespace vivify::pipeline

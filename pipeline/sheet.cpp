#include "pipeline/sheet.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "common/config.h"
#include "common/error.h"
#include "common/log.h"
#include "pipeline/frame_range.h"
#include "pipeline/run_report.h"
#include "render/image_io.h"
#include "render/view_transform.h"

namespace vivify::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr int kGap = 6;          // pixels around the pictures
constexpr int kSmallest = 8;     // width of a picture
constexpr float kGround = 0.1f;  // colour of the gaps

// Indices of `wanted` evenly spaced ones of `available` frames, both ends included.
std::vector<std::size_t> spaced(std::size_t available, std::size_t wanted) {
  const std::size_t count = std::min(available, wanted);
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < count; ++i) {
    indices.push_back(count == 1 ? 0 : (i * (available - 1) + (count - 1) / 2) / (count - 1));
  }
  return indices;
}

// "0037" of teacup.0037.exr.
std::string frame_label(const fs::path& file) {
  const std::string stem = file.stem().string();
  return stem.substr(stem.rfind('.') + 1);
}

// The frames that the last rendering of a run folder was asked for.
std::optional<std::vector<int>> asked_frames(const fs::path& folder) {
  for (const StageReport& stage : read_run_json(folder)) {
    if (stage.name == "render" && !stage.frames.empty()) {
      return parse_frames(stage.frames, std::numeric_limits<int>::max());
    }
  }
  return std::nullopt;
}

bool is_asked_for(const fs::path& file, const std::optional<std::vector<int>>& asked) {
  return !asked ||
         std::ranges::any_of(*asked, [&](int frame) { return frame_text(frame) == frame_label(file); });
}

OIIO::ImageBuf picture(const fs::path& file, const render::ViewTransform& view, int width, int height) {
  const render::RgbImage frame = render::read_rgb(file);
  std::vector<std::uint8_t> pixels = view.pixels(frame.values);
  const OIIO::ImageBuf full(OIIO::ImageSpec(frame.width, frame.height, 3, OIIO::TypeDesc::UINT8),
                            pixels.data());
  return OIIO::ImageBufAlgo::resize(full, "", 0, OIIO::ROI(0, width, 0, height, 0, 1, 0, 3));
}

// Writes the label into the lower left corner of the picture at (x, y); false when there is no font.
bool draw_label(OIIO::ImageBuf& sheet, const std::string& label, int x, int y, int width, int height) {
  const std::array<float, 3> white{1, 1, 1};
  const int size = std::clamp(width / 14, 9, 28);
  return OIIO::ImageBufAlgo::render_text(sheet, x + size / 2, y + height - size / 2, label, size,
                                         "DejaVuSans", white, OIIO::ImageBufAlgo::TextAlignX::Left,
                                         OIIO::ImageBufAlgo::TextAlignY::Baseline, 1);
}

}  // namespace

std::vector<fs::path> list_frames(const fs::path& folder) {
  std::error_code error;
  const fs::path frames = fs::is_directory(folder / "render", error) ? folder / "render" : folder;
  const std::optional<std::vector<int>> asked = asked_frames(folder);
  std::vector<fs::path> files;
  fs::directory_iterator entries(frames, error);
  if (error) throw Error(ErrorKind::io, "cannot read folder " + frames.string() + ": " + error.message());
  for (const fs::directory_entry& entry : entries) {
    if (entry.path().extension() == ".exr" && is_asked_for(entry.path(), asked))
      files.push_back(entry.path());
  }
  if (files.empty()) {
    throw Error(ErrorKind::io, "there are no frames (*.exr) in " + frames.string(),
                "render them with `vivify render`");
  }
  std::ranges::sort(files);
  return files;
}

double exposure_of(const fs::path& folder) {
  const fs::path scene = folder / "scene.resolved.yaml";
  std::error_code ignored;
  if (!fs::is_regular_file(scene, ignored)) return 0;
  std::vector<Error> errors;
  const ConfigNode root = parse_yaml(read_text_file(scene), scene.string(), errors);
  for (const ConfigNode::Entry& video : root.entries) {
    if (video.key != "video") continue;
    for (const ConfigNode::Entry& entry : video.value.entries) {
      if (entry.key == "exposure_stops") return std::stod(entry.value.scalar);
    }
  }
  return 0;
}

Bytes contact_sheet(const fs::path& folder, const SheetSettings& settings) {
  if (settings.columns < 1 || settings.frames < 1) {
    throw Error(ErrorKind::usage, "a contact sheet needs at least one column and one frame");
  }
  const std::vector<fs::path> files = list_frames(folder);
  const std::vector<std::size_t> chosen = spaced(files.size(), static_cast<std::size_t>(settings.frames));
  const int count = static_cast<int>(chosen.size());
  const int columns = std::min(settings.columns, count);
  const int width = (settings.width - kGap) / columns - kGap;
  if (width < kSmallest) {
    throw Error(ErrorKind::usage,
                "a contact sheet of " + std::to_string(columns) + " columns needs a width of " +
                    std::to_string(columns * (kSmallest + kGap) + kGap) + " pixels or more");
  }
  const render::RgbImage first = render::read_rgb(files[chosen.front()]);
  const int height =
      std::max(1, static_cast<int>(std::lround(static_cast<double>(width) * first.height / first.width)));
  const int rows = (count + columns - 1) / columns;

  const OIIO::ImageSpec spec(columns * (width + kGap) + kGap, rows * (height + kGap) + kGap, 3,
                             OIIO::TypeDesc::UINT8);
  OIIO::ImageBuf sheet(spec);
  OIIO::ImageBufAlgo::fill(sheet, {kGround, kGround, kGround});
  const render::ViewTransform view(render::Display::srgb, settings.exposure_stops);
  bool labelled = true;
  for (int i = 0; i < count; ++i) {
    const fs::path& file = files[chosen[static_cast<std::size_t>(i)]];
    const int x = kGap + i % columns * (width + kGap);
    const int y = kGap + i / columns * (height + kGap);
    OIIO::ImageBufAlgo::paste(sheet, x, y, 0, 0, picture(file, view, width, height));
    labelled = draw_label(sheet, frame_label(file), x, y, width, height) && labelled;
  }
  if (!labelled)
    log_warning("no font for the frame numbers of the contact sheet (Debian: fonts-dejavu-core)");

  std::vector<std::uint8_t> pixels(3 * static_cast<std::size_t>(spec.width) *
                                   static_cast<std::size_t>(spec.height));
  if (!sheet.get_pixels(OIIO::ROI(), OIIO::TypeDesc::UINT8, pixels.data())) {
    throw Error(ErrorKind::internal, "the contact sheet cannot be made: " + sheet.geterror());
  }
  return render::encode_png(spec.width, spec.height, pixels);
}

}  // namespace vivify::pipeline

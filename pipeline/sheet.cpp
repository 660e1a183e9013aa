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
#include "pipeline/canvas.h"
#include "pipeline/debug_overlay.h"
#include "pipeline/frame_range.h"
#include "pipeline/run_report.h"
#include "render/image_io.h"
#include "render/view_transform.h"

namespace vivify::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr int kGap = 6;                                 // pixels around the pictures
constexpr int kSmallest = 8;                            // width of a picture
constexpr std::uint8_t kGround = 26, kUnrendered = 52;  // grey of the gaps, and in place of pictures
constexpr const char* kFont = "DejaVuSans";

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

fs::path frames_folder(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_directory(folder / "render", ignored) ? folder / "render" : folder;
}

// Those that list_frames() lists; none when the folder cannot be read.
std::vector<fs::path> find_frames(const fs::path& folder, std::error_code& error) {
  const std::optional<std::vector<int>> asked = asked_frames(folder);
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(frames_folder(folder), error)) {
    if (entry.path().extension() == ".exr" && is_asked_for(entry.path(), asked))
      files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

OIIO::ImageBuf picture(const fs::path& file, const render::ViewTransform& view, int width, int height) {
  const render::RgbImage frame = render::read_rgb(file);
  std::vector<std::uint8_t> pixels = view.pixels(frame.values);
  const OIIO::ImageBuf full(OIIO::ImageSpec(frame.width, frame.height, 3, OIIO::TypeDesc::UINT8),
                            pixels.data());
  return OIIO::ImageBufAlgo::resize(full, "", 0, OIIO::ROI(0, width, 0, height, 0, 1, 0, 3));
}

// Writes a text whose baseline begins at (x, y); false when there is no font.
bool draw_text(OIIO::ImageBuf& sheet, const std::string& text, int x, int y, int size) {
  const std::array<float, 3> white{1, 1, 1};
  return OIIO::ImageBufAlgo::render_text(sheet, x, y, text, size, kFont, white,
                                         OIIO::ImageBufAlgo::TextAlignX::Left,
                                         OIIO::ImageBufAlgo::TextAlignY::Baseline, 1);
}

// Height of the letters below a picture, and of the strip they stand in.
int label_size(int width) { return std::clamp(width / 20, 9, 20); }
int label_strip(int width) { return label_size(width) * 3 / 2; }

// What is shown in one place of the sheet.
struct Cell {
  std::string label;
  fs::path picture;  // empty: was not rendered
};

std::vector<Cell> list_cells(const fs::path& folder, const std::optional<DebugOverlay>& overlay) {
  std::vector<Cell> cells;
  std::error_code ignored;
  if (overlay && find_frames(folder, ignored).empty()) {
    for (int frame = 1; frame <= overlay->frames(); ++frame) cells.push_back({frame_text(frame), {}});
  } else {
    for (const fs::path& file : list_frames(folder)) cells.push_back({frame_label(file), file});
  }
  return cells;
}

// Width of the pictures over their height.
double aspect_of(const fs::path& picture, const std::optional<DebugOverlay>& overlay) {
  if (picture.empty()) return overlay->aspect();
  const render::RgbImage frame = render::read_rgb(picture);
  return static_cast<double>(frame.width) / frame.height;
}

// The signs of the overlay with their texts, in rows of a width.
class Legend {
 public:
  Legend(int width, int text_size) : size_(text_size), unit_(text_size / 14.0) {
    int x = 0;
    for (DebugOverlay::Sign& sign : DebugOverlay::legend()) {
      const int room = 4 * size_ + OIIO::ImageBufAlgo::text_size(sign.text, size_, kFont).width();
      if (x > 0 && x + room > width) {
        x = 0;
        ++rows_;
      }
      entries_.push_back({std::move(sign), x, (rows_ - 1) * row_height()});
      x += room;
    }
  }
  int height() const { return rows_ * row_height() + kGap; }

  bool draw(OIIO::ImageBuf& sheet, Canvas& canvas, int left, int top) const {
    bool written = true;
    for (const auto& [sign, x, y] : entries_) {
      const int middle = y + row_height() / 2;
      sign.draw(canvas, Pixel(x + size_, middle), unit_);
      written = draw_text(sheet, sign.text, left + x + 2 * size_, top + middle + size_ / 3, size_) && written;
    }
    return written;
  }

 private:
  struct Entry {
    DebugOverlay::Sign sign;
    int x, y;
  };
  int row_height() const { return 2 * size_; }

  int size_;
  double unit_;
  int rows_ = 1;
  std::vector<Entry> entries_;
};

}  // namespace

std::vector<fs::path> list_frames(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> files = find_frames(folder, error);
  const std::string frames = frames_folder(folder).string();
  if (error) throw Error(ErrorKind::io, "cannot read folder " + frames + ": " + error.message());
  if (files.empty()) {
    throw Error(ErrorKind::io, "there are no frames (*.exr) in " + frames,
                "render them with `vivify render`");
  }
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
  std::optional<DebugOverlay> overlay;
  if (settings.debug) overlay.emplace(folder);
  const std::vector<Cell> cells = list_cells(folder, overlay);
  const std::vector<std::size_t> chosen = spaced(cells.size(), static_cast<std::size_t>(settings.frames));
  const int count = static_cast<int>(chosen.size());
  const int columns = std::min(settings.columns, count);
  const int width = (settings.width - kGap) / columns - kGap;
  if (width < kSmallest) {
    throw Error(ErrorKind::usage,
                "a contact sheet of " + std::to_string(columns) + " columns needs a width of " +
                    std::to_string(columns * (kSmallest + kGap) + kGap) + " pixels or more");
  }
  const fs::path& first = cells[chosen.front()].picture;
  const int height = std::max(1, static_cast<int>(std::lround(width / aspect_of(first, overlay))));
  const int rows = (count + columns - 1) / columns;
  const int sheet_width = columns * (width + kGap) + kGap, row_height = height + label_strip(width) + kGap;
  const int pictures_height = rows * row_height + kGap;
  std::optional<Legend> legend;
  if (overlay) legend.emplace(sheet_width - 2 * kGap, std::clamp(width / 24, 9, 16));
  const int sheet_height = pictures_height + (legend ? legend->height() : 0);

  std::vector<std::uint8_t> pixels(
      3 * static_cast<std::size_t>(sheet_width) * static_cast<std::size_t>(sheet_height), kGround);
  OIIO::ImageBuf sheet(OIIO::ImageSpec(sheet_width, sheet_height, 3, OIIO::TypeDesc::UINT8), pixels.data());
  const render::ViewTransform view(render::Display::srgb, settings.exposure_stops);
  bool written = true;
  for (int i = 0; i < count; ++i) {
    const Cell& cell = cells[chosen[static_cast<std::size_t>(i)]];
    const int x = kGap + i % columns * (width + kGap);
    const int y = kGap + i / columns * row_height;
    Canvas canvas(pixels.data(), sheet_width, x, y, width, height);
    if (cell.picture.empty()) {
      canvas.fill({kUnrendered, kUnrendered, kUnrendered});
    } else {
      OIIO::ImageBufAlgo::paste(sheet, x, y, 0, 0, picture(cell.picture, view, width, height));
    }
    if (overlay) overlay->draw(std::stoi(cell.label), !cell.picture.empty(), canvas);
    const int size = label_size(width);
    written = draw_text(sheet, cell.label, x, y + height + size + size / 4, size) && written;
  }
  if (legend) {
    Canvas canvas(pixels.data(), sheet_width, kGap, pictures_height, sheet_width - 2 * kGap,
                  legend->height());
    written = legend->draw(sheet, canvas, kGap, pictures_height) && written;
  }
  if (!written) log_warning("no font for the texts of the contact sheet (Debian: fonts-dejavu-core)");
  return render::encode_png(sheet_width, sheet_height, pixels);
}

}  // namespace vivify::pipeline

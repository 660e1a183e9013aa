#include "pipeline/diff.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <set>

#include "common/error.h"
#include "common/file.h"
#include "common/stop.h"

namespace vivify::pipeline {
namespace {

namespace fs = std::filesystem;

bool is_folder(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) {
    throw Error(ErrorKind::io, "cannot read " + path.string() + ": " +
                                   (error ? error.message() : std::string("no such file or folder")));
  }
  return fs::is_directory(status);
}

std::set<std::string> images_below(const fs::path& folder) {
  std::set<std::string> names;
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, error), end;
  for (; !error && entry != end; entry.increment(error)) {
    const fs::path extension = entry->path().extension();
    if (extension == ".exr" || extension == ".png")
      names.insert(entry->path().lexically_relative(folder).string());
  }
  if (error) throw Error(ErrorKind::io, "cannot read folder " + folder.string() + ": " + error.message());
  return names;
}

std::string number(const char* format, double value) {
  std::array<char, 48> buffer;
  std::snprintf(buffer.data(), buffer.size(), format, value);
  return buffer.data();
}

std::string place(const render::PlaneComparison& plane) {
  return "(" + std::to_string(plane.worst_x) + ", " + std::to_string(plane.worst_y) + ")";
}

// Rows as columns of equal width; the last column is not padded.
std::string table(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths(rows.front().size(), 0);
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  }
  std::string result;
  for (const auto& row : rows) {
    std::string line = "  ";
    for (std::size_t c = 0; c < row.size(); ++c) {
      line += row[c];
      if (c + 1 < row.size()) line.append(widths[c] + 2 - row[c].size(), ' ');
    }
    result += line + "\n";
  }
  return result;
}

std::string plane_table(const render::ImageComparison& comparison) {
  std::vector<std::vector<std::string>> rows{
      {"plane", "max error", "at", "mean error", "bias", "failing pixels", "verdict"}};
  for (const render::PlaneComparison& plane : comparison.planes) {
    rows.push_back({plane.name, number("%.3g", plane.max_error), plane.max_error > 0 ? place(plane) : "-",
                    number("%.3g", plane.mean_error), number("%.3g", plane.signed_mean),
                    std::to_string(plane.failing_pixels),
                    plane.same ? "same" : "DIFFERENT: " + plane.reason});
  }
  return table(rows);
}

std::string describe(const FileDiff& file, bool alone) {
  switch (file.kind) {
    case FileDiff::Kind::missing:
      return file.name + ": DIFFERENT: only in the reference\n";
    case FileDiff::Kind::extra:
      return file.name + ": DIFFERENT: not in the reference\n";
    case FileDiff::Kind::compared:
      break;
  }
  const render::ImageComparison& comparison = file.comparison;
  if (!comparison.reason.empty()) return file.name + ": DIFFERENT: " + comparison.reason + "\n";
  if (comparison.same && !alone) {
    const auto worst = std::ranges::max_element(comparison.planes, {}, &render::PlaneComparison::max_error);
    return file.name + ": same" +
           (worst->max_error > 0
                ? " (largest error " + number("%.3g", worst->max_error) + " in " + worst->name + ")\n"
                : "\n");
  }
  return file.name + ": " + (comparison.same ? "same" : "DIFFERENT") + "\n" + plane_table(comparison);
}

}  // namespace

bool DiffReport::same() const { return std::ranges::all_of(files, &FileDiff::same); }

DiffReport diff(const fs::path& ref, const fs::path& test, const DiffSettings& settings) {
  const bool folders = is_folder(ref);
  if (is_folder(test) != folders) {
    throw Error(ErrorKind::usage, "a file cannot be compared with a folder",
                "give two images or two folders of images");
  }
  DiffReport report;
  render::ImageComparison mapped;  // the comparison that the heat map shows
  const auto compare = [&](const std::string& name, const fs::path& a, const fs::path& b) {
    check_stop();
    FileDiff file{name, FileDiff::Kind::compared,
                  render::compare_images(render::read_image(a), render::read_image(b), settings.limits)};
    if (!file.comparison.error.empty() && (mapped.error.empty() || (mapped.same && !file.comparison.same))) {
      mapped = file.comparison;
    }
    file.comparison.error = {};
    report.files.push_back(std::move(file));
  };
  if (folders) {
    const std::set<std::string> expected = images_below(ref), found = images_below(test);
    std::set<std::string> all = expected;
    all.insert(found.begin(), found.end());
    if (all.empty()) {
      throw Error(ErrorKind::usage,
                  "there are no images (*.exr, *.png) in " + ref.string() + " and " + test.string());
    }
    for (const std::string& name : all) {
      if (!found.contains(name)) {
        report.files.push_back({name, FileDiff::Kind::missing, {}});
      } else if (!expected.contains(name)) {
        report.files.push_back({name, FileDiff::Kind::extra, {}});
      } else {
        compare(name, ref / name, test / name);
      }
    }
  } else {
    compare(test.filename().string(), ref, test);
  }
  if (!settings.heat_map.empty()) {
    if (mapped.error.empty()) {
      throw Error(ErrorKind::usage,
                  "no heat map is made: there are no two images of the same size and channels");
    }
    write_file_atomic(settings.heat_map,
                      render::encode_png(mapped.width, mapped.height, render::heat_map(mapped)));
  }
  return report;
}

std::string text(const DiffReport& report) {
  std::string result;
  long different = 0;
  for (const FileDiff& file : report.files) {
    result += describe(file, report.files.size() == 1);
    if (!file.same()) ++different;
  }
  if (report.files.size() > 1) {
    result += std::to_string(different) + " of " + std::to_string(report.files.size()) + " images differ\n";
  }
  return result;
}

}  // namespace vivify::pipeline

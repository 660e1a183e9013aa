// `vivify diff REF TEST`: two images, or the images of two folders.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "render/image_compare.h"

namespace vivify::pipeline {

struct DiffSettings {
  render::CompareLimits limits;
  std::filesystem::path
      heat_map;  // PNG of the errors of the first different image (else the first one); empty: none
};

struct FileDiff {
  enum class Kind {
    compared,
    missing,
    extra
  };                 // missing, extra: only in the reference, only in the test folder
  std::string name;  // relative to the folders; the file name for two files
  Kind kind = Kind::compared;
  render::ImageComparison comparison;  // of compared files; without its error map
  bool same() const { return kind == Kind::compared && comparison.same; }
};

struct DiffReport {
  std::vector<FileDiff> files;  // in order of their names
  bool same() const;            // exit code of the command: 0 when true, else 1
};

// Compares two files, or all EXR and PNG files below two folders by their relative names. Throws Error(usage)
// (exit code 2) for a file against a folder or folders without any image, and Error(io) (exit code 5) when a
// path does not exist, an image cannot be read, or the heat map cannot be written.
DiffReport diff(const std::filesystem::path& ref, const std::filesystem::path& test,
                const DiffSettings& settings = {});

// The report for people: a line per same file, a table of the planes for a different one, and a summary.
std::string text(const DiffReport& report);

}  // namespace vivify::pipeline

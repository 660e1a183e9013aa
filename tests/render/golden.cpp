#include "tests/render/golden.h"

#include <unistd.h>

#include <cpuid.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "common/error.h"
#include "render/image_compare.h"
#include "render/image_io.h"

namespace vivify::test {
namespace {

namespace fs = std::filesystem;

fs::path folder() { return fs::path(VIVIFY_SOURCE_DIR) / "tests/render/goldens"; }

// Manufacturers differ in the bits of the approximate reciprocals that Embree uses; within one they have
// agreed so far.
std::string processor_family() {
  std::array<unsigned, 4> words{};
  if (__get_cpuid(0, &words[0], &words[1], &words[2], &words[3]) == 0) return "unknown";
  std::array<char, 13> name{};
  std::memcpy(name.data(), &words[1], 4);
  std::memcpy(name.data() + 4, &words[3], 4);
  std::memcpy(name.data() + 8, &words[2], 4);
  return name.data();
}

fs::path results() {
  const fs::path path = fs::temp_directory_path() / ("vivify_goldens." + std::to_string(::getuid()));
  make_folder(path);
  return path;
}

}  // namespace

bool on_reference_processor() {
  return read_text_file(folder() / "processor.txt") == processor_family() + "\n";
}

void expect_golden(const std::string& name, const Bytes& exr) {
  const char* update = std::getenv("VIVIFY_UPDATE_GOLDENS");
  if (update != nullptr && std::string(update) == "1") {
    write_file_atomic(folder() / (name + ".exr"), exr);
    write_file_atomic(folder() / "processor.txt", processor_family() + "\n");
    ADD_FAILURE() << "golden " << name << " was replaced; look at it, then run without VIVIFY_UPDATE_GOLDENS";
    return;
  }
  const fs::path picture = results() / (name + ".exr");
  write_file_atomic(picture, exr);
  const render::ImageComparison comparison =
      render::compare_images(render::read_image(folder() / (name + ".exr")), render::read_image(picture),
                             {.exact = on_reference_processor()});
  if (comparison.same) return;
  std::string text = comparison.reason;
  for (const render::PlaneComparison& plane : comparison.planes) {
    if (!plane.same) text += "\n  " + plane.name + ": " + plane.reason;
  }
  if (!comparison.error.empty()) {
    write_file_atomic(results() / (name + ".png"),
                      render::encode_png(comparison.width, comparison.height, render::heat_map(comparison)));
  }
  ADD_FAILURE() << "the picture is not the golden " << name
                << (on_reference_processor() ? " (exact comparison): " : " (tolerant comparison): ") << text
                << "\nsee " << picture.string() << " and .png; docs/image_tests.md";
}

}  // namespace vivify::test

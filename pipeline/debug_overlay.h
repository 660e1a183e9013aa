// What moves the bodies of a run, drawn over its frames for the animator: what they push against, what they
// are asked to do, and the rest shape that they take for it.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/canvas.h"

namespace vivify::pipeline {

class DebugOverlay {
 public:
  // Reads the output folder of a run. Throws Error(io) when nothing was simulated there.
  explicit DebugOverlay(const std::filesystem::path& folder);
  ~DebugOverlay();

  int frames() const;     // frames 1 … frames() were simulated
  double aspect() const;  // width of the pictures over their height

  // Draws over the frame with that number, which fills the canvas. Without a picture of it the bodies are
  // outlined.
  void draw(int frame, bool has_picture, Canvas& canvas);

  // What the signs mean: each is drawn around a point and has a text.
  struct Sign {
    std::string text;
    void (*draw)(Canvas& canvas, const Pixel& centre, double unit);
  };
  static std::vector<Sign> legend();

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

}  // namespace vivify::pipeline

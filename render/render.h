// The entry point of the renderer: looks are prepared once, then frames are rendered one by one.
#pragma once

#include <functional>
#include <memory>

#include "render/film.h"
#include "render/scene.h"

namespace vivify::render {

class Renderer {
 public:
  // Makes materials and lights and loads their textures. Throws Error(io) for an image that cannot be read
  // and Error(usage) for looks that cannot be (a light without extent, for example).
  explicit Renderer(const Looks& looks);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // One frame, on all threads of common/parallel.h. The bits depend on looks, frame and settings only: not on
  // the number of threads, nor on what was rendered before. `progress` gets the finished share of the picture
  // in (0, 1], one call at a time but from any thread. A requested stop (common/stop.h) is thrown between
  // tiles. Throws Error(usage) for a mesh whose material is unknown, Error(geometry) for indices out of range
  // or points that are not finite.
  Film render(const Frame& frame, const RenderSettings& settings,
              const std::function<void(double)>& progress = {}) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vivify::render

#include "pipeline/stage.h"

#include "pipeline/stages/stages.h"

namespace vivify::pipeline {

std::span<const Stage> stages() {
  static const Stage table[] = {mesh_stage(), weights_stage(), simulate_stage(), render_stage(),
                                encode_stage()};
  return table;
}

}  // namespace vivify::pipeline

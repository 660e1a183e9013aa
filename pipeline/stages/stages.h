// The stages, each defined in a file of its own in this folder, and what later stages need to know of earlier
// ones.
#pragma once

#include "pipeline/stage.h"

namespace vivify::sim {
struct BodyInput;
}

namespace vivify::pipeline {

Stage mesh_stage();
Stage weights_stage();
Stage simulate_stage();
Stage render_stage();
Stage encode_stage();

// Keys that later stages build on.
std::string mesh_key(const Job& job, const Value& body);     // of mesh/BODY.h5
std::string weights_key(const Job& job, const Value& body);  // of weights/BODY.h5
std::string simulation_key(const Job& job);                  // of the simulation, however long it is
std::vector<std::string> frame_keys(const Job& job);         // of the rendered frames, as in job.frames

// File names, relative to the output folder.
std::string mesh_file(const Value& body);
std::string weights_file(const Value& body);
std::string simulation_file(int frame);
std::string picture_file(const Scene& scene, int frame);

// A body as it is simulated, from what the stages before made in the folder `out`.
sim::BodyInput simulated_body(const std::filesystem::path& out, const Value& body);

}  // namespace vivify::pipeline

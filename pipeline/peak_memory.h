// Peak memory of a stretch of the program.
#pragma once

namespace vivify::pipeline {

// Begins a new measurement. Linux lets a process reset its own peak (/proc/self/clear_refs); where that is
// not allowed, the peak since the start of the program is reported.
void reset_peak_memory();

// Largest resident memory since the last reset, in megabytes (10^6 bytes): of this process alone. Memory of
// child processes (TetGen, ffmpeg) is not part of it.
double peak_memory_mb();

}  // namespace vivify::pipeline

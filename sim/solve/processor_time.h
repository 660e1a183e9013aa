// The clock of the time limit of a step.
#pragma once

namespace vivify::sim {

// Processor time that the calling thread has used (s). It stands still while the thread waits for a processor
// or the process is stopped, so that neither a busy machine nor a break uses up the time of a step.
double processor_seconds();

}  // namespace vivify::sim

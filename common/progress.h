// Progress of a stage, as seen by the code that does the work. The command line decides how it is shown.
#pragma once

#include <memory>
#include <string>

namespace vivify {

// One per stage. Thread-safe. The remaining time is estimated from the finished share of the work.
class Progress {
 public:
  virtual ~Progress() = default;
  // The stage begins; `total` units of work, of which `done` were there already (resumed).
  virtual void start(const std::string& stage, long total, long done = 0) = 0;
  // `units` more are finished; `note` is a short status shown beside the bar.
  virtual void advance(long units, const std::string& note = {}) = 0;
  virtual void finish() = 0;
};

enum class ProgressStyle { automatic, bar, plain, json, none };

// bar: one redrawn line on standard error; plain: a line every tenth; json: one JSON object per line on
// standard output
// ({"event":"start|advance|finish","stage":…,"done":…,"total":…,"elapsed_s":…,"remaining_s":…,"note":…});
// automatic: bar on a terminal, else plain.
std::unique_ptr<Progress> make_progress(ProgressStyle style);

// Seconds left at the pace so far; units that were there at the start (`resumed`) say nothing about the pace.
// Infinite while the pace is unknown.
double remaining_seconds(double elapsed_s, long total, long done, long resumed);

}  // namespace vivify

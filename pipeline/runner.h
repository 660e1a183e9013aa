// Runs stages in order: plans, skips what is there, makes the rest, and reports.
#pragma once

#include <string>
#include <vector>

#include "common/progress.h"
#include "pipeline/run_report.h"
#include "pipeline/stage.h"

namespace vivify::pipeline {

struct RunOptions {
  std::string last_stage = "encode";  // stages after it are left alone
  std::string force;                  // "all", or the name of a stage whose files are made again
};

// What the stages would do, without doing it.
struct StagePlan {
  const Stage* stage = nullptr;
  std::vector<Product> products;
  std::vector<Product> missing;
};
std::vector<StagePlan> plan(const Job& job, const RunOptions& options);

// Makes what is missing. Writes scene.resolved.yaml, run.json and timing.json. Only one run at a time may
// work in an output folder. Throws Error.
std::vector<StageReport> run(const Job& job, const RunOptions& options, Progress& progress);

}  // namespace vivify::pipeline

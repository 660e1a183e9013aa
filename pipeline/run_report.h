// run.json and timing.json of an output folder.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace vivify::pipeline {

// What became of one stage in this run.
struct StageReport {
  std::string name;
  std::string key;     // hash of the keys of its products
  std::string status;  // "ran", "cached" or "resumed"
  double wall_s = 0;   // of the work done in this run
  double peak_mb = 0;
  std::size_t products = 0;
  std::size_t made = 0;  // products made in this run
  std::string frames;    // that its pictures show ("1-96"); empty for stages without pictures
};

// Writes a text file, atomically, unless it holds this text already.
void write_if_changed(const std::filesystem::path& path, const std::string& text);

// Writes run.json: version, libraries, processor, and for each stage key and status.
void write_run_json(const std::filesystem::path& out, const std::vector<StageReport>& stages);
// The stages that run.json tells of; none when it is missing or damaged. Times are not in there.
std::vector<StageReport> read_run_json(const std::filesystem::path& out);

// Renews the times of a stage that did work in timing.json; the times of other stages stay as they were
// measured when they last ran.
void update_timing(const std::filesystem::path& out, const StageReport& stage);

// Simulated seconds and seconds of work for one body, added up over the runs that made its frames.
struct BodyTiming {
  double sim_seconds = 0;
  double wall_seconds = 0;
};
// Adds to the times of the bodies in timing.json; `afresh` forgets what was there.
void update_body_timing(const std::filesystem::path& out, const std::map<std::string, BodyTiming>& bodies,
                        bool afresh);

}  // namespace vivify::pipeline

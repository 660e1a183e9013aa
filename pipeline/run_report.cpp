#include "pipeline/run_report.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/file.h"
#include "pipeline/version.h"

namespace vivify::pipeline {
namespace {

using Json = nlohmann::ordered_json;

double rounded(double value) { return std::round(value * 1e4) / 1e4; }

Json read_object(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return Json::object();
  Json json = Json::parse(read_text_file(path), nullptr, false);
  return json.is_object() ? json : Json::object();
}

}  // namespace

void write_if_changed(const std::filesystem::path& path, const std::string& text) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored) && read_text_file(path) == text) return;
  write_file_atomic(path, text);
}

void write_run_json(const std::filesystem::path& out, const std::vector<StageReport>& stages) {
  Json json;
  json["version"] = program_version();
  json["processor"] = processor_name();
  for (const auto& [name, version] : library_versions()) json["libraries"][name] = version;
  json["stages"] = Json::object();
  for (const StageReport& stage : stages) {
    json["stages"][stage.name] = {
        {"key", stage.key}, {"status", stage.status}, {"files", stage.products}, {"made", stage.made}};
    if (!stage.frames.empty()) json["stages"][stage.name]["frames"] = stage.frames;
  }
  write_if_changed(out / "run.json", json.dump(2) + "\n");
}

std::vector<StageReport> read_run_json(const std::filesystem::path& out) {
  const Json json = read_object(out / "run.json");
  std::vector<StageReport> stages;
  if (!json.contains("stages") || !json["stages"].is_object()) return stages;
  for (const auto& [name, entry] : json["stages"].items()) {
    try {
      StageReport stage;
      stage.name = name;
      stage.key = entry.at("key");
      stage.status = entry.at("status");
      stage.products = entry.at("files");
      stage.made = entry.at("made");
      stage.frames = entry.value("frames", "");
      stages.push_back(std::move(stage));
    } catch (const nlohmann::json::exception&) {
      continue;  // of another version
    }
  }
  return stages;
}

void update_timing(const std::filesystem::path& out, const StageReport& stage) {
  Json json = read_object(out / "timing.json");
  json["stages"][stage.name] = {
      {"wall_s", rounded(stage.wall_s)}, {"peak_mb", rounded(stage.peak_mb)}, {"made", stage.made}};
  write_file_atomic(out / "timing.json", json.dump(2) + "\n");
}

void update_body_timing(const std::filesystem::path& out, const std::map<std::string, BodyTiming>& bodies,
                        bool afresh) {
  Json json = read_object(out / "timing.json");
  if (afresh || !json["bodies"].is_object()) json["bodies"] = Json::object();
  for (const auto& [name, timing] : bodies) {
    Json& entry = json["bodies"][name];
    if (!entry.is_object()) entry = Json::object();
    const double sim = entry.value("sim_seconds", 0.0) + timing.sim_seconds;
    const double wall = entry.value("wall_seconds", 0.0) + timing.wall_seconds;
    entry = {{"sim_seconds", rounded(sim)},
             {"wall_seconds", rounded(wall)},
             {"wall_per_sim_second", sim > 0 ? rounded(wall / sim) : 0.0}};
  }
  write_file_atomic(out / "timing.json", json.dump(2) + "\n");
}

}  // namespace vivify::pipeline

// The commands of the program, without the reading of arguments. Each returns an exit code or throws Error.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace vivify::pipeline {

// run, mesh, weights, simulate, render, encode.
struct SceneCommand {
  std::filesystem::path scene;
  std::filesystem::path out;  // empty: out/NAME
  std::string frames;         // empty: all
  std::string quality;
  int spp = 0;       // 0: as the scene says
  std::string size;  // "480x270"
  std::vector<std::string> set;
  int threads = 0;
  std::string force;  // "", "all" or a stage
  bool dry_run = false;
  bool quiet = false;
  std::string progress = "auto";  // or bar, plain, json, none
};
int run_stages_command(const SceneCommand& command, const std::string& last_stage);

struct CheckCommand {
  std::vector<std::filesystem::path> scenes;
  std::vector<std::string> set;
};
int check_command(const CheckCommand& command);

int schema_command(bool as_markdown);

struct PoseCommand {
  std::filesystem::path pose;
  std::filesystem::path output;  // empty: the pose file with the ending .ply
  std::vector<std::string> set;  // changes of the scene
  bool quiet = false;
};
// Solves a pose file and writes the posed simulation mesh, all vertices in their order, in the coordinates of
// the asset: a PLY that can be an example of a rest space.
int pose_command(const PoseCommand& command);

struct SheetCommand {
  std::filesystem::path folder;
  std::filesystem::path output;  // empty: folder/sheet.png
  int count = 16;
  int columns = 4;
  int width = 1280;
  bool debug = false;
};
int sheet_command(const SheetCommand& command);

struct DiffCommand {
  std::filesystem::path ref;
  std::filesystem::path test;
  bool exact = false;
  std::filesystem::path heat_map;  // PNG file; empty: none
};
int diff_command(const DiffCommand& command);

}  // namespace vivify::pipeline

// A stage of the way from a scene to a video: it names the files it makes, each with a key of everything that
// its content depends on, and makes those that are missing. A new stage is one file in stages/ and one line
// in stage.cpp.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/progress.h"
#include "pipeline/ledger.h"
#include "pipeline/scene_file.h"

namespace vivify::pipeline {

// What is asked for.
struct Job {
  const Scene& scene;
  std::filesystem::path out;  // the output folder
  std::vector<int> frames;    // frames to render and encode, ascending
  int simulate_to = 1;        // last frame to simulate
};

// A file that a stage makes: the same key stands for the same bytes.
struct Product {
  std::string file;  // relative to the output folder
  std::string key;   // content hash
  long units = 1;    // of progress
};

struct Stage {
  std::string name;
  std::string doc;
  // The files of the stage for this job, in the order they are made. Reads settings and input files only,
  // never what a stage has made.
  std::vector<Product> (*products)(const Job& job);
  // Makes `missing` (a part of the products, in order), commits each to the ledger, and advances `progress`
  // by the units of each.
  void (*make)(const Job& job, const std::vector<Product>& missing, Ledger& ledger, Progress& progress);
  bool shows_frames = false;  // its files show the frames of the job
};

// Every stage, in order: mesh, weights, simulate, render, encode.
std::span<const Stage> stages();

}  // namespace vivify::pipeline

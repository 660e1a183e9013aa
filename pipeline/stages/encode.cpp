// encode: the pictures as one H.264 video.
#include "pipeline/content_key.h"
#include "pipeline/stages/stages.h"
#include "pipeline/video.h"

namespace vivify::pipeline {
namespace {

std::vector<Product> products(const Job& job) {
  ContentKey key("render");
  key.add("fps", job.scene.fps).add("video", job.scene.settings["video"]);
  for (const std::string& frame : frame_keys(job)) key.add("frame", frame);
  return {{job.scene.name + ".mp4", key.hex(), static_cast<long>(job.frames.size())}};
}

void make(const Job& job, const std::vector<Product>& missing, Ledger& ledger, Progress& progress) {
  std::vector<std::filesystem::path> pictures;
  for (const int frame : job.frames) pictures.push_back(job.out / picture_file(job.scene, frame));
  const Value& video = job.scene.settings["video"];
  VideoSettings settings;
  settings.rate = {job.scene.fps, 1};
  settings.crf = static_cast<int>(video["crf"].as_integer());
  settings.exposure_stops = video["exposure_stops"].as_number();
  for (const Product& product : missing) {
    encode_video(pictures, job.out / product.file, settings, &progress);
    ledger.adopt(product.file, product.key);
  }
}

}  // namespace

Stage encode_stage() { return {"encode", "Everything up to the video", products, make}; }

}  // namespace vivify::pipeline

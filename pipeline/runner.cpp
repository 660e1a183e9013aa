#include "pipeline/runner.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>

#include "common/error.h"
#include "common/file.h"
#include "common/hash.h"
#include "common/log.h"
#include "common/stop.h"
#include "pipeline/frame_range.h"
#include "pipeline/peak_memory.h"

namespace vivify::pipeline {
namespace {

// Keeps a second run out of the folder. The lock ends with the process, however it ends.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& out) {
    const std::filesystem::path path = out / ".cache" / "lock";
    make_folder(path.parent_path());
    fd_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (fd_ < 0) throw Error(ErrorKind::io, "cannot write " + path.string() + ": " + std::strerror(errno));
    if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
      ::close(fd_);
      throw Error(ErrorKind::io, "another vivify is working in " + out.string(),
                  "wait for it, or choose another folder with -o");
    }
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock() { ::close(fd_); }

 private:
  int fd_ = -1;
};

// Removes what a killed run was writing (common/file.h), in the folders that vivify makes and nowhere else;
// needs the lock.
void remove_unfinished_files(const std::filesystem::path& out) {
  std::error_code ignored;
  for (const char* folder : {"", "mesh", "weights", "sim", "sim/frames", "render", ".cache"}) {
    std::vector<std::filesystem::path> unfinished;
    for (const auto& entry : std::filesystem::directory_iterator(out / folder, ignored)) {
      const std::string name = entry.path().filename().string();
      const std::size_t mark = name.rfind(".tmp.");
      if (mark != name.npos && name.size() > mark + 5 &&
          name.find_first_not_of("0123456789", mark + 5) == name.npos) {
        unfinished.push_back(entry.path());
      }
    }
    for (const std::filesystem::path& path : unfinished) std::filesystem::remove(path, ignored);
  }
}

StagePlan plan_stage(const Stage& stage, const Job& job, const RunOptions& options, Ledger& ledger) {
  StagePlan plan = {&stage, stage.products(job), {}};
  const bool forced = options.force == "all" || options.force == stage.name;
  for (const Product& product : plan.products) {
    if (forced || !ledger.holds(product.file, product.key)) plan.missing.push_back(product);
  }
  return plan;
}

std::string stage_key(const std::vector<Product>& products) {
  Hasher hasher;
  for (const Product& product : products) hasher.add(product.file).add(product.key);
  return hasher.hex();
}

long units(const std::vector<Product>& products) {
  long sum = 0;
  for (const Product& product : products) sum += product.units;
  return sum;
}

// What run.json tells already of the stages that do not run now, where it still holds for this job.
std::vector<StageReport> later_reports(const Job& job, const std::string& last) {
  std::vector<StageReport> later;
  const std::vector<StageReport> known = read_run_json(job.out);
  bool after = false;
  for (const Stage& stage : stages()) {
    for (const StageReport& report : known) {
      if (after && report.name == stage.name && report.key == stage_key(stage.products(job)))
        later.push_back(report);
    }
    after = after || stage.name == last;
  }
  return later;
}

std::span<const Stage> stages_up_to(const std::string& last) {
  for (std::size_t i = 0; i < stages().size(); ++i) {
    if (stages()[i].name == last) return stages().first(i + 1);
  }
  throw Error(ErrorKind::internal, "no stage is called '" + last + "'");
}

}  // namespace

std::vector<StagePlan> plan(const Job& job, const RunOptions& options) {
  std::vector<StagePlan> plans;
  for (const Stage& stage : stages_up_to(options.last_stage)) {
    Ledger ledger(job.out, stage.name);
    plans.push_back(plan_stage(stage, job, options, ledger));
  }
  return plans;
}

std::vector<StageReport> run(const Job& job, const RunOptions& options, Progress& progress) {
  make_folder(job.out);
  const FolderLock lock(job.out);
  remove_unfinished_files(job.out);
  write_if_changed(job.out / "scene.resolved.yaml", job.scene.resolved);

  std::vector<StageReport> reports;
  const std::vector<StageReport> later = later_reports(job, options.last_stage);
  const auto write_report = [&] {
    std::vector<StageReport> all = reports;
    all.insert(all.end(), later.begin(), later.end());
    write_run_json(job.out, all);
  };
  for (const Stage& stage : stages_up_to(options.last_stage)) {
    check_stop();
    Ledger ledger(job.out, stage.name);
    const StagePlan todo = plan_stage(stage, job, options, ledger);
    StageReport report;
    report.name = stage.name;
    report.key = stage_key(todo.products);
    report.products = todo.products.size();
    report.made = todo.missing.size();
    if (stage.shows_frames) report.frames = frames_text(job.frames);
    report.status = report.made == 0 ? "cached" : report.made == report.products ? "ran" : "resumed";
    if (report.made > 0) {
      // A file that is about to be made again counts as missing from now on, whatever happens to this
      // process.
      for (const Product& product : todo.missing) ledger.forget(product.file);
      ledger.save();
      reset_peak_memory();
      const auto start = std::chrono::steady_clock::now();
      const long total = units(todo.products);
      progress.start(stage.name, total, total - units(todo.missing));
      try {
        stage.make(job, todo.missing, ledger, progress);
      } catch (...) {
        ledger.save();
        throw;
      }
      progress.finish();
      report.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      report.peak_mb = peak_memory_mb();
      update_timing(job.out, report);
    }
    ledger.save();
    log_info(stage.name + ": " + report.status +
             (report.made > 0
                  ? ", " + std::to_string(report.made) + " of " + std::to_string(report.products) + " files"
                  : ""));
    reports.push_back(report);
    if (report.made > 0) write_report();
  }
  write_report();
  return reports;
}

}  // namespace vivify::pipeline

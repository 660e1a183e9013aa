#include "common/progress.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <mutex>
#include <nlohmann/json.hpp>

#include "common/terminal.h"

namespace vivify {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kRedrawSeconds = 0.2;

std::string duration_text(double seconds) {
  if (!std::isfinite(seconds)) return "?";
  const long s = std::lround(seconds);
  char text[32];
  if (seconds < 9.95) {
    std::snprintf(text, sizeof text, "%.1f s", seconds);
  } else if (s < 60) {
    std::snprintf(text, sizeof text, "%ld s", s);
  } else if (s < 3600) {
    std::snprintf(text, sizeof text, "%ld:%02ld min", s / 60, s % 60);
  } else {
    std::snprintf(text, sizeof text, "%ld:%02ld h", s / 3600, s / 60 % 60);
  }
  return text;
}

// Counts the work; the styles below show it.
class CountingProgress : public Progress {
 public:
  void start(const std::string& stage, long total, long done) final {
    const std::scoped_lock lock(mutex_);
    now_ = Clock::now();
    if (running_) show_end();
    stage_ = stage;
    total_ = total;
    done_ = resumed_ = done;
    note_.clear();
    started_ = now_;
    running_ = true;
    show_start();
  }

  void advance(long units, const std::string& note) final {
    const std::scoped_lock lock(mutex_);
    if (!running_) return;
    done_ += units;
    note_ = note;
    now_ = Clock::now();
    show_advance();
  }

  void finish() final {
    const std::scoped_lock lock(mutex_);
    if (!running_) return;
    running_ = false;
    now_ = Clock::now();
    show_end();
  }

 protected:
  virtual void show_start() = 0;
  virtual void show_advance() = 0;
  virtual void show_end() = 0;  // also when the work was given up

  double elapsed() const { return std::chrono::duration<double>(now_ - started_).count(); }
  double remaining() const { return remaining_seconds(elapsed(), total_, done_, resumed_); }
  double share() const { return total_ > 0 ? static_cast<double>(done_) / static_cast<double>(total_) : 1.0; }
  std::string count_text() const { return std::to_string(done_) + "/" + std::to_string(total_); }

  std::mutex mutex_;
  std::string stage_, note_;
  long total_ = 0, done_ = 0, resumed_ = 0;
  bool running_ = false;
  Clock::time_point started_, now_;  // now: of the last call, so that the numbers of a line fit together
};

class BarProgress final : public CountingProgress {
 public:
  ~BarProgress() override { terminal::clear_status(); }

 private:
  void show_start() override { draw(); }
  void show_advance() override {
    if (std::chrono::duration<double>(Clock::now() - drawn_).count() >= kRedrawSeconds) draw();
  }
  void show_end() override {
    terminal::clear_status();
    terminal::print(stage_ + ": " + count_text() + " in " + duration_text(elapsed()) + "\n");
  }

  void draw() {
    drawn_ = Clock::now();
    constexpr int kCells = 24;
    const int full = std::min(kCells, static_cast<int>(share() * kCells));
    std::string line = stage_ + " [" + std::string(static_cast<std::size_t>(full), '#') +
                       std::string(static_cast<std::size_t>(kCells - full), '.') + "] " + count_text();
    if (std::isfinite(remaining())) line += ", " + duration_text(remaining()) + " left";
    if (!note_.empty()) line += "  " + note_;
    terminal::show_status(line);
  }

  Clock::time_point drawn_;
};

class PlainProgress final : public CountingProgress {
 private:
  long tenth() const { return static_cast<long>(share() * 10 + 1e-9); }
  void show_start() override {
    shown_ = tenth();
    if (done_ > 0) terminal::print(stage_ + ": " + count_text() + " done before\n");
  }
  void show_advance() override {
    if (tenth() <= shown_ || done_ >= total_) return;  // the last line is that of the end
    shown_ = tenth();
    terminal::print(stage_ + ": " + count_text() + ", " + duration_text(elapsed()) + " so far, " +
                    duration_text(remaining()) + " left" + (note_.empty() ? "" : "  " + note_) + "\n");
  }
  void show_end() override {
    terminal::print(stage_ + ": " + count_text() + " in " + duration_text(elapsed()) + "\n");
  }

  long shown_ = 0;
};

class JsonProgress final : public CountingProgress {
 private:
  void show_start() override { print("start"); }
  void show_advance() override { print("advance"); }
  void show_end() override { print("finish"); }

  void print(const char* event) {
    nlohmann::ordered_json json = {{"event", event},  {"stage", stage_},        {"done", done_},
                                   {"total", total_}, {"elapsed_s", elapsed()}, {"remaining_s", nullptr},
                                   {"note", note_}};
    if (std::isfinite(remaining())) json["remaining_s"] = remaining();
    const std::string line = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    std::fwrite(line.data(), 1, line.size(), stdout);
    std::fflush(stdout);
  }
};

class NoProgress final : public Progress {
 public:
  void start(const std::string&, long, long) override {}
  void advance(long, const std::string&) override {}
  void finish() override {}
};

}  // namespace

double remaining_seconds(double elapsed_s, long total, long done, long resumed) {
  if (done >= total) return 0;
  if (done <= resumed) return std::numeric_limits<double>::infinity();
  return elapsed_s / static_cast<double>(done - resumed) * static_cast<double>(total - done);
}

std::unique_ptr<Progress> make_progress(ProgressStyle style) {
  switch (style) {
    case ProgressStyle::automatic:
      return make_progress(terminal::is_terminal() ? ProgressStyle::bar : ProgressStyle::plain);
    case ProgressStyle::bar:
      return std::make_unique<BarProgress>();
    case ProgressStyle::plain:
      return std::make_unique<PlainProgress>();
    case ProgressStyle::json:
      return std::make_unique<JsonProgress>();
    case ProgressStyle::none:
      break;
  }
  return std::make_unique<NoProgress>();
}

}  // namespace vivify

// Whether the characters of configs/ still do what is asked of them (tests/pipeline/cast_table.h)
//   - in 20 variations of each scene: density, stiffness and friction of every body within 15 % of what the
//     scene says, and a push of 5 % of the momentum scale m √(g H), in a level direction at any time;
//   - when they are sent elsewhere: along eight headings and to four places (in the plane two headings).
// Only by options of the command line; whatever is random is so by fixed keys.
//   cast_trials FOLDER [NAME [varied|sent]]
// simulates into FOLDER; only the scenes whose name contains NAME, and only the variations or the errands.
// The rows of docs/robustness.md are replaced, those of other scenes stay.
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <sstream>
#include <thread>

#include "common/error.h"
#include "common/file.h"
#include "common/hdf5_file.h"
#include "common/rng.h"
#include "common/text.h"
#include "pipeline/child_process.h"
#include "pipeline/scene_file.h"
#include "tests/pipeline/cast_table.h"

using namespace vivify;
using namespace vivify::testing_support;

namespace {

constexpr int kVariations = 20;
constexpr double kRange = 0.15;    // of density, stiffness and friction
constexpr double kPush = 0.05;     // of m √(g H)
constexpr double kPushTime = 0.1;  // s
constexpr double kGravity = 9.81;
constexpr unsigned kAtOnce = 2;  // runs

struct Trial {
  std::string name;
  std::vector<std::string> options;
  std::vector<Role> roles;
  std::string failure = {};  // empty when all roles are fulfilled
};

std::filesystem::path scene_file(const std::string& scene) {
  return VIVIFY_SOURCE_DIR "/configs/" + scene + ".yaml";
}

// Simulates into `out` and returns its last lines when it failed.
std::string simulate(const std::string& scene, const std::vector<std::string>& options,
                     const std::filesystem::path& out) {
  std::vector<std::string> arguments = {
      "simulate", scene_file(scene).string(), "-o", out.string(), "--threads", "1", "-q", "--progress=none"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  pipeline::ChildProcess vivify(VIVIFY_PROGRAM, arguments);
  const pipeline::ChildProcess::Outcome outcome = vivify.finish();
  return outcome.success ? "" : outcome.ending + ": " + outcome.output;
}

std::string try_out(const std::string& scene, const Trial& trial, const std::filesystem::path& out) {
  if (const std::string text = simulate(scene, trial.options, out); !text.empty()) return text;
  const SceneResult result(out);
  std::string failure;
  for (const Role& role : trial.roles) {
    for (const std::string& text : shortcomings(result, role)) {
      if (!failure.empty()) failure += "; ";
      if (trial.roles.size() > 1) failure += std::string(role.body) + " ";
      failure += text;
    }
  }
  return failure;
}

// A few at a time, each in a folder that several trials use one after the other.
void run_all(const std::string& scene, std::vector<Trial>& trials, const std::filesystem::path& folder) {
  std::atomic<std::size_t> next = 0;
  std::vector<std::thread> workers;
  for (unsigned worker = 0; worker < kAtOnce; ++worker) {
    workers.emplace_back([&, worker] {
      for (std::size_t i = next++; i < trials.size(); i = next++) {
        try {
          trials[i].failure = try_out(scene, trials[i], folder / (scene + std::to_string(worker)));
        } catch (const Error& error) {
          trials[i].failure = error.full_text();
        }
      }
    });
  }
  for (std::thread& worker : workers) worker.join();
}

pipeline::Scene load(const std::string& scene) {
  std::vector<Error> errors;
  std::optional<pipeline::Scene> loaded = pipeline::load_scene(scene_file(scene), {}, errors);
  if (!errors.empty()) throw errors.front();
  return std::move(*loaded);
}

std::string vector_text(const Eigen::Vector3d& v) {
  return "[" + number_text(v.x()) + ", " + number_text(v.y()) + ", " + number_text(v.z()) + "]";
}

// `mesh`: of the body at rest, with its mass.
std::vector<std::string> variation(const Value& body, const Hdf5Reader& mesh, double duration,
                                   CounterRng& rng) {
  std::vector<std::string> options;
  const auto set = [&](const std::string& setting, const std::string& value) {
    options.insert(options.end(),
                   {"--set", "bodies." + body["name"].as_string() + "." + setting + "=" + value});
  };
  const auto change = [&](const std::string& part, const std::string& key, double factor) {
    if (body[part].has(key)) set(part + "." + key, number_text(factor * body[part][key].as_number()));
  };
  const auto factor = [&] { return rng.uniform(1 - kRange, 1 + kRange); };
  const double density = factor(), stiffness = factor();
  change("model", "density", density);
  for (const char* key : {"stiffness", "volume_stiffness", "bending_stiffness"})
    change("model", key, stiffness);
  change("contact", "friction", factor());

  const RowMatrixXd X = mesh.matrix("/X0");
  const double height = X.col(1).maxCoeff() - X.col(1).minCoeff();
  const double momentum = density * mesh.vector("/mass").sum() * std::sqrt(kGravity * height);
  const double from = body["spawn_s"].as_number(), angle = rng.uniform(0, 2 * std::numbers::pi);
  const bool planar = X.cols() == 2;
  const Eigen::Vector3d way = planar ? Eigen::Vector3d(angle < std::numbers::pi ? 1 : -1, 0, 0)
                                     : Eigen::Vector3d(std::sin(angle), 0, std::cos(angle));
  set("pushes", "[{at_s: " + number_text(rng.uniform(from, duration)) + ", for_s: " + number_text(kPushTime) +
                    ", impulse: " + vector_text(kPush * momentum * way) + "}]");
  return options;
}

std::vector<Trial> variations(const std::string& scene, const std::filesystem::path& folder) {
  const pipeline::Scene loaded = load(scene);
  const std::filesystem::path nominal = folder / (scene + "0");
  if (const std::string text = simulate(scene, {"--frames", "1"}, nominal); !text.empty())
    throw Error(ErrorKind::io, scene + ": " + text);
  const double duration = loaded.settings["frames"]["duration_s"].as_number();
  std::vector<Trial> trials;
  for (int i = 0; i < kVariations; ++i) {
    Trial& trial = trials.emplace_back(Trial{std::to_string(i + 1), {}, roles_in(scene)});
    CounterRng rng(hash_words(5, static_cast<std::uint64_t>(i)));
    for (const Value& body : loaded.settings["bodies"].items()) {
      const Hdf5Reader mesh(nominal / "mesh" / (body["name"].as_string() + ".h5"));
      for (const std::string& option : variation(body, mesh, duration, rng)) trial.options.push_back(option);
    }
  }
  return trials;
}

const char* gait_name(Gait gait) {
  return gait == Gait::hop ? "hops" : gait == Gait::roll ? "rolls" : "walks";
}

// "13 of 20 | 3: falls (50 deg)" for a row of a table.
std::string report(const std::vector<Trial>& trials) {
  int succeeded = 0;
  std::string failures;
  for (const Trial& trial : trials) {
    std::printf("  %-18s %s\n", trial.name.c_str(), trial.failure.empty() ? "done" : trial.failure.c_str());
    succeeded += trial.failure.empty();
    if (trial.failure.empty()) continue;
    failures += (failures.empty() ? "" : "<br>") + trial.name + ": " +
                trial.failure.substr(0, trial.failure.find_first_of(";\n"));
  }
  std::fflush(stdout);
  return std::to_string(succeeded) + " of " + std::to_string(trials.size()) + " | " + failures;
}

// The beginnings of the rows of the two tables.
std::string varied_row(const std::string& scene) {
  return "| `" + scene + "` | " + gait_name(roles_in(scene).front().gait) + " | ";
}
std::string sent_row(const Role& role) {
  return "| `" + std::string(role.scene) + "` | " + role.body + " | ";
}

// The rows of the document, by their beginnings: those of scenes that are not tried stay.
class Rows {
 public:
  explicit Rows(const std::string& document) {
    std::istringstream lines(document);
    for (std::string line; std::getline(lines, line);) rows_.push_back(line + "\n");
  }
  void put(const std::string& beginning, const std::string& rest) {
    std::erase(rows_, get(beginning));
    rows_.push_back(beginning + rest + " |\n");
  }
  std::string get(const std::string& beginning) const {
    const auto row = std::find_if(rows_.begin(), rows_.end(),
                                  [&](const std::string& line) { return line.starts_with(beginning); });
    return row == rows_.end() ? "" : *row;
  }

 private:
  std::vector<std::string> rows_;
};

void try_variations(const std::string& scene, const std::filesystem::path& folder, Rows& rows) {
  std::printf("%s: variations\n", scene.c_str());
  std::vector<Trial> varied = variations(scene, folder);
  run_all(scene, varied, folder);
  rows.put(varied_row(scene), report(varied));
}

void try_errands(const Role& role, const std::filesystem::path& folder, Rows& rows) {
  std::vector<Trial> sent;
  for (const Errand& errand : errands(role)) sent.push_back({errand.name, errand.options, {errand.role}});
  if (sent.empty()) return;
  std::printf("%s: %s sent elsewhere\n", role.scene, role.body);
  run_all(role.scene, sent, folder);
  rows.put(sent_row(role), report(sent));
}

constexpr const char* kVaried = R"(# Robustness

Written by `bench/cast_trials` from simulations of the [scenes](gallery.md) with options of the command line alone. What
counts as done is what the tests of the scenes ask for (`tests/pipeline/cast_table.cpp`): arrival within 0.2 of the
character's width, hops, steps, distance, no fall (45°).

## Variations

Twenty runs of each scene. In each, the density, the stiffness and the friction of every body differ from the scene's by up
to 15 %, evenly distributed and independent, and every body is pushed once, at a time and in a level direction evenly
distributed, with 5 % of its momentum scale m √(g H).

| scene | it | done | what failed first, by number of the variation |
| --- | --- | --- | --- |
)";
constexpr const char* kSent = R"(
## Sent elsewhere

Each hopper and walker alone on the ground of its scene, from its origin: along eight headings (two in the plane), within 15°
and by half its height or more in 8 s, and to four places, where it is after 16 s.

| scene | character | done | what failed first |
| --- | --- | --- | --- |
)";

std::string document(const Rows& rows) {
  std::string varied = kVaried, sent = kSent, last;
  for (const Role& role : cast_roles()) {
    if (last != role.scene) varied += rows.get(varied_row(role.scene));
    last = role.scene;
    sent += rows.get(sent_row(role));
  }
  return varied + sent;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') {
    std::fprintf(stderr, "cast_trials FOLDER [NAME [varied|sent]]\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1], page = VIVIFY_SOURCE_DIR "/docs/robustness.md";
  const std::string only = argc > 2 ? argv[2] : "", kind = argc > 3 ? argv[3] : "";
  try {
    Rows rows(read_text_file(page));
    std::string last;
    for (const Role& role : cast_roles()) {
      if (std::string(role.scene).find(only) == std::string::npos) continue;
      if (last != role.scene && kind != "sent") try_variations(role.scene, folder, rows);
      last = role.scene;
      if (kind != "varied") try_errands(role, folder, rows);
    }
    const std::string text = document(rows);
    write_file_atomic(page, std::as_bytes(std::span(text)));
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.full_text().c_str());
    return 1;
  }
}

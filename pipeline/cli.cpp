#include "pipeline/cli.h"

#include <CLI/CLI.hpp>
#include <csignal>
#include <iostream>

#include "common/error.h"
#include "common/log.h"
#include "common/stop.h"
#include "pipeline/commands.h"
#include "pipeline/stage.h"
#include "pipeline/version.h"

namespace vivify::pipeline {
namespace {

constexpr int kUsageExit = 2;
constexpr int kInternalExit = 70;

// `--force` has an optional value, which the parser would look for in the next argument (the scene file): the
// value must be attached (--force=render), and without one it means every stage.
std::vector<std::string> prepare_arguments(int argc, char** argv) {
  std::vector<std::string> arguments;
  for (int i = argc - 1; i > 0; --i) {  // CLI11 wants them in reverse
    arguments.emplace_back(argv[i]);
    if (arguments.back() == "--force") arguments.back() = "--force=all";
  }
  return arguments;
}

std::vector<std::string> stage_names() {
  std::vector<std::string> names;
  for (const Stage& stage : stages()) names.push_back(stage.name);
  return names;
}

// Options that every command has.
struct CommonOptions {
  bool verbose = false;
  bool quiet = false;

  void add_to(CLI::App& command) {
    CLI::Option* v = command.add_flag("-v,--verbose", verbose, "Say more");
    command.add_flag("-q,--quiet", quiet, "Say only what went wrong")->excludes(v);
  }
  LogLevel level() const { return verbose ? LogLevel::debug : quiet ? LogLevel::warning : LogLevel::info; }
};

void add_scene_options(CLI::App& command, SceneCommand& options) {
  command.add_option("scene", options.scene, "Scene file (YAML)")->required();
  command.add_option("-o,--output", options.out, "Output folder (default: out/NAME)");
  command.add_option("--frames", options.frames, "Frames to make, for example 1-100x2,7 (default: all)");
  command.add_option("--quality", options.quality, "draft, preview or final: sets size and samples")
      ->check(CLI::IsMember({"draft", "preview", "final"}));
  command.add_option("--spp", options.spp, "Samples per pixel")->check(CLI::PositiveNumber);
  command.add_option("--size", options.size, "Size of the picture, for example 480x270");
  command.add_option("--set", options.set, "Change a setting of the scene: path.to.key=value (repeatable)")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command.add_option("-j,--threads", options.threads, "Number of threads (default: one per processor)")
      ->check(CLI::PositiveNumber);
  std::vector<std::string> forceable = stage_names();
  forceable.emplace_back("all");
  command
      .add_option("--force", options.force,
                  "Make again what is there: --force for all, --force=STAGE for one stage")
      ->check(CLI::IsMember(forceable));
  command.add_flag("--dry-run", options.dry_run, "Only say what would be done");
  command.add_option("--progress", options.progress, "How to show progress: auto, bar, plain, json or none")
      ->check(CLI::IsMember({"auto", "bar", "plain", "json", "none"}));
}

// Builds the parser, parses, and gives the command to run.
class CommandLine {
 public:
  CommandLine() : app_("Soft characters that move by themselves: one YAML scene to a video.", "vivify") {
    app_.set_version_flag("--version", "vivify " + program_version());
    app_.require_subcommand(1);
    app_.get_formatter()->column_width(34);

    CLI::App& whole = add("run", "Everything up to the video; stages that are done are reused");
    add_scene_options(whole, scene_);
    whole.callback(
        [this] { command_ = [this] { return run_stages_command(scene_, stages().back().name); }; });
    for (const Stage& stage : stages()) {
      CLI::App& command = add(stage.name, stage.doc);
      add_scene_options(command, scene_);
      command.callback([this, name = stage.name] {
        command_ = [this, name] { return run_stages_command(scene_, name); };
      });
    }

    CLI::App& check = add("check", "Read and check scene files, without doing anything");
    check.add_option("scenes", check_.scenes, "Scene files")->required();
    check.add_option("--set", check_.set, "Change a setting of the scenes: path.to.key=value (repeatable)")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    check.callback([this] { command_ = [this] { return check_command(check_); }; });

    CLI::App& schema = add("schema", "Print what a scene file may hold");
    CLI::Option* json = schema.add_flag("--json", schema_json_, "As JSON Schema, for editors (default)");
    schema.add_flag("--markdown", schema_markdown_, "As the reference page, docs/reference.md")
        ->excludes(json);
    schema.callback([this] { command_ = [this] { return schema_command(schema_markdown_); }; });

    CLI::App& pose =
        add("pose", "Make an example pose: bring a body into the shape that its handles ask for");
    pose.add_option("pose", pose_.pose, "Pose file (YAML)")->required();
    pose.add_option("-o,--output", pose_.output, "PLY file (default: beside the pose file)");
    pose.add_option("--set", pose_.set, "Change a setting of the scene: path.to.key=value (repeatable)")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    pose.callback([this] { command_ = [this] { return pose_command(pose_); }; });

    CLI::App& sheet = add("sheet", "Contact sheet (PNG) of the frames of a run");
    sheet.add_option("folder", sheet_.folder, "Output folder of a run")->required();
    sheet.add_option("-o,--output", sheet_.output, "PNG file (default: FOLDER/sheet.png)");
    sheet.add_option("--count", sheet_.count, "Number of pictures")->check(CLI::Range(1, 10000));
    sheet.add_option("--columns", sheet_.columns, "Pictures per row")->check(CLI::Range(1, 1000));
    sheet.add_option("--width", sheet_.width, "Width of the sheet in pixels")->check(CLI::Range(1, 32768));
    sheet.add_flag("--debug", sheet_.debug,
                   "Draw contacts, forces, goals and rest shapes over the frames, rendered or not");
    sheet.callback([this] { command_ = [this] { return sheet_command(sheet_); }; });

    CLI::App& diff = add("diff", "Compare images, or folders of images");
    diff.add_option("ref", diff_.ref, "Reference: EXR or PNG file, or a folder of them")->required();
    diff.add_option("test", diff_.test, "What is compared with it")->required();
    diff.add_flag("--exact", diff_.exact, "Every bit must agree");
    diff.add_option("--heat-map", diff_.heat_map, "PNG file for a picture of the differences");
    diff.callback([this] { command_ = [this] { return diff_command(diff_); }; });
  }

  int run(int argc, char** argv) {
    try {
      app_.parse(prepare_arguments(argc, argv));
    } catch (const CLI::ParseError& error) {
      return app_.exit(error) == 0 ? 0 : kUsageExit;
    }
    log_to_stderr(common_.level());
    scene_.quiet = pose_.quiet = common_.quiet;
    return command_();
  }

 private:
  CLI::App& add(const std::string& name, const std::string& doc) {
    CLI::App* command = app_.add_subcommand(name, doc);
    common_.add_to(*command);
    return *command;
  }

  CLI::App app_;
  CommonOptions common_;
  SceneCommand scene_;
  CheckCommand check_;
  PoseCommand pose_;
  SheetCommand sheet_;
  DiffCommand diff_;
  bool schema_json_ = false;
  bool schema_markdown_ = false;
  std::function<int()> command_;
};

}  // namespace

int run_command_line(int argc, char** argv) {
  try {
    check_processor();
    install_stop_handlers();
    // A reader that went away is an error of write(), not the death of the process.
    std::signal(SIGPIPE, SIG_IGN);
    return CommandLine().run(argc, argv);
  } catch (const Error& error) {
    std::cerr << error.full_text() << "\n";
    return exit_code(error.kind());
  } catch (const std::bad_alloc&) {
    std::cerr << "error: out of memory (fewer samples, a smaller picture or a coarser mesh need less)\n";
    return kInternalExit;
  } catch (const std::exception& error) {
    std::cerr << "error: internal: " << error.what() << " (please report this)\n";
    return kInternalExit;
  }
}

}  // namespace vivify::pipeline

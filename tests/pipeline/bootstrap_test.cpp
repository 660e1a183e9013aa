// The set-up script, with stand-ins for the programs of the system that it asks and orders.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/file.h"
#include "tests/common/temporary_folder.h"
#include "tests/pipeline/program.h"

namespace vivify::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using testing_support::Outcome;
using testing_support::ProgramOptions;
using testing_support::run_program;
using testing_support::TemporaryFolder;

class Bootstrap : public testing::Test {
 protected:
  Bootstrap() {
    stand_in("sudo", "exit 1");
    stand_in("apt-get", "echo \"$@\" >> '" + (folder_ / "apt.log").string() + "'");
    set_user(0);
    install_all_but("");
  }

  void stand_in(const std::string& program, const std::string& script) {
    write_file_atomic(folder_ / program, "#!/bin/bash\n" + script + "\n");
    fs::permissions(folder_ / program, fs::perms::owner_all);
  }
  void set_user(int id) { stand_in("id", "echo " + std::to_string(id)); }
  // Every package that is asked for is installed, but one that never was and one that was removed again.
  void install_all_but(const std::string& never, const std::string& removed = "") {
    stand_in("dpkg-query", "for p in \"${@:4}\"; do case $p in '" + never + "') ;; '" + removed +
                               "') echo \"rc $p\" ;; *) echo \"ii $p\" ;; esac; done; exit 1");
  }
  Outcome deps() {
    ProgramOptions options;
    options.environment["PATH"] = folder_.path().string() + ":/usr/bin:/bin";
    return run_program({VIVIFY_SOURCE_DIR "/bootstrap", "deps"}, options);
  }
  std::string orders() const {
    return fs::exists(folder_ / "apt.log") ? read_text_file(folder_ / "apt.log") : "";
  }

  TemporaryFolder folder_;
};

TEST_F(Bootstrap, DoesNothingWhenAllIsInstalled) {
  EXPECT_EQ(deps().code, 0);
  EXPECT_EQ(orders(), "");
}

TEST_F(Bootstrap, InstallsOnlyWhatIsMissing) {
  install_all_but("ffmpeg", "libtbb-dev");
  const Outcome outcome = deps();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(orders(), "-q update\n-q -y --no-install-recommends install libtbb-dev ffmpeg\n");
}

TEST_F(Bootstrap, TellsWhatToAskForWithoutRights) {
  set_user(1000);
  install_all_but("ffmpeg");
  const Outcome outcome = deps();
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err,
              HasSubstr("ask an administrator for: apt-get install --no-install-recommends ffmpeg\n"));
  EXPECT_EQ(orders(), "");
}

TEST_F(Bootstrap, UsesSudo) {
  set_user(1000);
  install_all_but("ffmpeg");
  stand_in("sudo", "if [ \"$1\" = -n ]; then exit 0; fi; exec \"$@\"");
  const Outcome outcome = deps();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(orders(), HasSubstr("install ffmpeg"));
}

TEST_F(Bootstrap, HelpNamesItsCommands) {
  const Outcome outcome = run_program({VIVIFY_SOURCE_DIR "/bootstrap", "--help"});
  EXPECT_EQ(outcome.code, 0);
  for (const char* command : {"deps", "build", "test", "run"}) {
    EXPECT_THAT(outcome.out, HasSubstr("./bootstrap " + std::string(command)));
  }
  EXPECT_THAT(outcome.out, Not(HasSubstr("set -e")));
}

}  // namespace
}  // namespace vivify::pipeline

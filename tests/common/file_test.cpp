#include "common/file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/error.h"
#include "common/stop.h"
#include "tests/common/temporary_folder.h"

namespace vivify {
namespace {

using testing_support::TemporaryFolder;

std::size_t entries_of(const std::filesystem::path& folder) {
  const std::filesystem::directory_iterator begin(folder);
  return static_cast<std::size_t>(std::distance(begin, std::filesystem::directory_iterator()));
}

ErrorKind kind_of(const std::function<void()>& action, std::string* text = nullptr) {
  try {
    action();
  } catch (const Error& error) {
    if (text != nullptr) *text = error.full_text();
    return error.kind();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorKind::internal;
}

TEST(WriteFileAtomic, WritesAndReplacesWholeFiles) {
  const TemporaryFolder folder;
  const std::string content = std::string("a\0b", 3) + std::string(100000, 'x');
  write_file_atomic(folder / "f", content);
  EXPECT_EQ(read_text_file(folder / "f"), content);
  write_file_atomic(folder / "f", "");
  EXPECT_EQ(read_text_file(folder / "f"), "");
  EXPECT_EQ(entries_of(folder.path()), 1U);
}

TEST(WriteFileAtomic, UnwritableFoldersAreIoErrors) {
  const TemporaryFolder folder;
  write_file_atomic(folder / "file", "x");
  std::string text;
  EXPECT_EQ(kind_of([&] { write_file_atomic(folder / "file/inside", "x"); }, &text), ErrorKind::io);
  EXPECT_THAT(text, ::testing::HasSubstr("file/inside"));
  EXPECT_EQ(kind_of([&] { write_file_atomic(folder / "missing/f", "x"); }), ErrorKind::io);
  EXPECT_EQ(kind_of([&] { write_file_atomic("/proc/vivify/f", "x"); }), ErrorKind::io);
  std::filesystem::create_directory(folder / "folder");
  EXPECT_EQ(kind_of([&] { write_file_atomic(folder / "folder", "x"); }), ErrorKind::io);
  EXPECT_EQ(entries_of(folder.path()), 2U);  // no temporary file is left
  EXPECT_EQ(kind_of([&] { make_folder(folder / "file"); }), ErrorKind::io);
  EXPECT_EQ(kind_of([&] { make_folder(folder / "file/inside"); }), ErrorKind::io);
}

TEST(ReadFile, MissingFilesAndFoldersAreIoErrors) {
  const TemporaryFolder folder;
  EXPECT_EQ(kind_of([&] { read_file(folder / "none"); }), ErrorKind::io);
  EXPECT_EQ(kind_of([&] { read_file(folder.path()); }), ErrorKind::io);
}

// A write that stops in the middle, as on a full disk: reported, the old file is whole, nothing is left
// behind.
TEST(WriteFileAtomic, ShortWriteIsReportedAndLeavesNothing) {
  const TemporaryFolder folder;
  write_file_atomic(folder / "old", "old");
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    install_stop_handlers();
    const rlimit limit = {5000, 5000};
    if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) ::_exit(10);
    int reported = 0;
    for (const char* name : {"old", "new"}) {
      try {
        write_file_atomic(folder / name, std::string(20000, 'x'));
      } catch (const Error& error) {
        if (error.kind() == ErrorKind::io && std::string(error.what()).find(name) != std::string::npos)
          ++reported;
      }
    }
    ::_exit(reported);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status)) << "killed by signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 2);
  EXPECT_EQ(read_text_file(folder / "old"), "old");
  EXPECT_EQ(entries_of(folder.path()), 1U);
}

}  // namespace
}  // namespace vivify

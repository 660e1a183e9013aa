#include "pipeline/ledger.h"

#include <gtest/gtest.h>

#include <chrono>

#include "tests/common/temporary_folder.h"

namespace vivify::pipeline {
namespace {

namespace fs = std::filesystem;
using testing_support::TemporaryFolder;

void commit(Ledger& ledger, const std::string& file, const std::string& key, const std::string& content) {
  ledger.commit(file, key, std::as_bytes(std::span(content)));
}

class LedgerTest : public testing::Test {
 protected:
  // A ledger that was saved and read again, as by another run.
  Ledger reopened(Ledger& ledger) {
    ledger.save();
    return Ledger(folder_.path(), "stage");
  }
  TemporaryFolder folder_;
  Ledger ledger_{folder_.path(), "stage"};
};

TEST_F(LedgerTest, HoldsWhatWasCommitted) {
  commit(ledger_, "a/file", "key", "content");
  EXPECT_EQ(read_text_file(folder_ / "a/file"), "content");
  EXPECT_TRUE(reopened(ledger_).holds("a/file", "key"));
}

TEST_F(LedgerTest, AsksForTheSameKey) {
  commit(ledger_, "file", "key", "content");
  EXPECT_FALSE(reopened(ledger_).holds("file", "other"));
  EXPECT_FALSE(reopened(ledger_).holds("other", "key"));
}

TEST_F(LedgerTest, SeesAMissingFile) {
  commit(ledger_, "file", "key", "content");
  fs::remove(folder_ / "file");
  EXPECT_FALSE(reopened(ledger_).holds("file", "key"));
}

TEST_F(LedgerTest, SeesATruncatedFile) {
  commit(ledger_, "file", "key", "content");
  fs::resize_file(folder_ / "file", 3);
  EXPECT_FALSE(reopened(ledger_).holds("file", "key"));
}

TEST_F(LedgerTest, SeesAFileOfTheSameSizeWithOtherContent) {
  commit(ledger_, "file", "key", "content");
  const fs::file_time_type time = fs::last_write_time(folder_ / "file");
  write_file_atomic(folder_ / "file", std::string_view("CONTENT"));
  fs::last_write_time(folder_ / "file", time + std::chrono::seconds(1));
  EXPECT_FALSE(reopened(ledger_).holds("file", "key"));
}

TEST_F(LedgerTest, TakesACopyOfTheFolder) {
  commit(ledger_, "file", "key", "content");
  fs::last_write_time(folder_ / "file", fs::last_write_time(folder_ / "file") + std::chrono::hours(5));
  EXPECT_TRUE(reopened(ledger_).holds("file", "key"));
}

TEST_F(LedgerTest, ForgetsOnRequest) {
  commit(ledger_, "file", "key", "content");
  ledger_.forget("file");
  EXPECT_FALSE(reopened(ledger_).holds("file", "key"));
}

TEST_F(LedgerTest, AdoptsAFileMadeElsewhere) {
  write_file_atomic(folder_ / "video", std::string_view("frames"));
  ledger_.adopt("video", "key");
  EXPECT_TRUE(reopened(ledger_).holds("video", "key"));
}

TEST_F(LedgerTest, DamagedLedgerOnlyCostsWork) {
  commit(ledger_, "file", "key", "content");
  ledger_.save();
  write_file_atomic(folder_ / ".cache/stage.json", std::string_view("{\"file\": {\"key\": 3"));
  EXPECT_FALSE(Ledger(folder_.path(), "stage").holds("file", "key"));
  write_file_atomic(folder_ / ".cache/stage.json", std::string_view("{\"file\": {\"key\": 3}}"));
  EXPECT_FALSE(Ledger(folder_.path(), "stage").holds("file", "key"));
}

}  // namespace
}  // namespace vivify::pipeline

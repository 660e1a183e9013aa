// What a stage has made so far: for each file the key of its content and a fingerprint that shows whether the
// file is still the one that was written. Kept in OUT/.cache/STAGE.json.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "common/file.h"

namespace vivify::pipeline {

class Ledger {
 public:
  // Reads the ledger of a stage; one that is missing or damaged is empty, which only costs work.
  Ledger(std::filesystem::path out, const std::string& stage);

  // Whether `file` (relative to the output folder) was made with `key` and is still there, whole. Size and
  // time of change are looked at first; only when the time differs (a copied folder) the content is hashed.
  bool holds(const std::string& file, const std::string& key);

  // Writes the file atomically and remembers it. The ledger itself is saved at most twice a second: a record
  // lost with a killed process means that the file is made again, with the same bytes.
  void commit(const std::string& file, const std::string& key, std::span<const std::byte> content);
  // Remembers a file that somebody else wrote whole.
  void adopt(const std::string& file, const std::string& key);

  void forget(const std::string& file);
  void save();  // when something changed

  // Recorded files, in order of name.
  std::vector<std::string> files() const;
  // Recorded key, or "".
  std::string key(const std::string& file) const;

 private:
  struct Record {
    std::string key;
    std::string hash;
    std::uint64_t size = 0;
    std::int64_t changed_ns = 0;
  };
  void remember(const std::string& file, const std::string& key, const std::string& hash);

  std::filesystem::path out_;
  std::filesystem::path path_;
  std::map<std::string, Record> records_;
  bool changed_ = false;
  std::chrono::steady_clock::time_point saved_;
};

}  // namespace vivify::pipeline

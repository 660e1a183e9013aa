#include "pipeline/ledger.h"

#include <sys/stat.h>

#include <nlohmann/json.hpp>

#include "common/error.h"
#include "common/hash.h"

namespace vivify::pipeline {
namespace {

// Size and time of the last change; false when it is not a regular file.
bool look_at(const std::filesystem::path& path, std::uint64_t& size, std::int64_t& changed_ns) {
  struct stat status = {};
  if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return false;
  size = static_cast<std::uint64_t>(status.st_size);
  changed_ns = static_cast<std::int64_t>(status.st_mtim.tv_sec) * 1'000'000'000 + status.st_mtim.tv_nsec;
  return true;
}

}  // namespace

Ledger::Ledger(std::filesystem::path out, const std::string& stage)
    : out_(std::move(out)),
      path_(out_ / ".cache" / (stage + ".json")),
      saved_(std::chrono::steady_clock::now()) {
  std::error_code ignored;
  if (!std::filesystem::exists(path_, ignored)) return;
  const nlohmann::json json = nlohmann::json::parse(read_text_file(path_), nullptr, false);
  if (!json.is_object()) return;
  for (const auto& [file, entry] : json.items()) {
    try {
      records_[file] = {entry.at("key"), entry.at("hash"), entry.at("size"), entry.at("changed_ns")};
    } catch (const nlohmann::json::exception&) {
      records_.erase(file);
    }
  }
}

bool Ledger::holds(const std::string& file, const std::string& key) {
  const auto found = records_.find(file);
  if (found == records_.end() || found->second.key != key) return false;
  Record& record = found->second;
  std::uint64_t size = 0;
  std::int64_t changed_ns = 0;
  if (!look_at(out_ / file, size, changed_ns) || size != record.size) return false;
  if (changed_ns == record.changed_ns) return true;
  if (hash_hex(read_file(out_ / file)) != record.hash) return false;
  record.changed_ns = changed_ns;
  changed_ = true;
  return true;
}

void Ledger::commit(const std::string& file, const std::string& key, std::span<const std::byte> content) {
  const std::filesystem::path path = out_ / file;
  make_folder(path.parent_path());
  write_file_atomic(path, content);
  remember(file, key, hash_hex(content));
}

void Ledger::adopt(const std::string& file, const std::string& key) {
  remember(file, key, hash_hex(read_file(out_ / file)));
}

void Ledger::remember(const std::string& file, const std::string& key, const std::string& hash) {
  Record record = {key, hash};
  if (!look_at(out_ / file, record.size, record.changed_ns)) {
    throw Error(ErrorKind::io, "the file " + (out_ / file).string() + " vanished while it was made");
  }
  records_[file] = record;
  changed_ = true;
  if (std::chrono::steady_clock::now() - saved_ > std::chrono::milliseconds(500)) save();
}

void Ledger::forget(const std::string& file) { changed_ |= records_.erase(file) > 0; }

void Ledger::save() {
  if (!changed_) return;
  nlohmann::json json = nlohmann::json::object();
  for (const auto& [file, record] : records_) {
    json[file] = {
        {"key", record.key}, {"hash", record.hash}, {"size", record.size}, {"changed_ns", record.changed_ns}};
  }
  make_folder(path_.parent_path());
  write_file_atomic(path_, json.dump(1) + "\n");
  changed_ = false;
  saved_ = std::chrono::steady_clock::now();
}

std::vector<std::string> Ledger::files() const {
  std::vector<std::string> names;
  for (const auto& [file, record] : records_) names.push_back(file);
  return names;
}

std::string Ledger::key(const std::string& file) const {
  const auto found = records_.find(file);
  return found == records_.end() ? "" : found->second.key;
}

}  // namespace vivify::pipeline

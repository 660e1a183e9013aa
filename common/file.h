// Reading and writing whole files. Every file that vivify makes goes through write_file_atomic.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vivify {

using Bytes = std::vector<std::byte>;

// Writes `content` to a temporary file beside `path`, syncs it, and renames it to `path`: the file appears whole or
// not at all, and no temporary file is left behind. Throws Error(io) with the system's reason.
void write_file_atomic(const std::filesystem::path& path, std::span<const std::byte> content);
void write_file_atomic(const std::filesystem::path& path, std::string_view content);

// The whole content of a file. Throws Error(io).
Bytes read_file(const std::filesystem::path& path);
std::string read_text_file(const std::filesystem::path& path);

// Creates the folder and its parents. Throws Error(io) with the system's reason.
void make_folder(const std::filesystem::path& path);

}  // namespace vivify

#include "common/gltf_file.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>

#include "common/error.h"

namespace vivify {
namespace {

using nlohmann::json;
using namespace nlohmann::literals;

constexpr std::size_t kGlbHeader = 12, kChunkHeader = 8;

struct GltfFile {
  json document;  // null: the file is of another format
  Bytes content;
  std::size_t binary = 0;  // where the binary chunk of a GLB starts in the content; 0: there is none
};

std::uint32_t word(const Bytes& content, std::size_t at) {
  std::uint32_t value = 0;
  if (at + sizeof value > content.size()) throw Error(ErrorKind::geometry, "it ends early");
  std::memcpy(&value, content.data() + at, sizeof value);
  return value;
}

GltfFile read_gltf(const std::filesystem::path& path) {
  GltfFile file;
  file.content = read_file(path);
  const char* const text = reinterpret_cast<const char*>(file.content.data());
  const std::string_view whole(text, file.content.size());
  if (!whole.starts_with("glTF")) {
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    if (ending == ".gltf") file.document = json::parse(whole);
  } else if (word(file.content, 4) == 2) {
    const std::size_t start = kGlbHeader + kChunkHeader, size = word(file.content, kGlbHeader);
    file.document = json::parse(whole.substr(std::min(start, whole.size()), size));
    if (start + size + kChunkHeader <= whole.size()) file.binary = start + size + kChunkHeader;
  }
  return file;
}

// Runs `read`, which takes the file apart; what it finds wrong is told with the name of the file.
template <class Read>
auto told_with_name(const std::filesystem::path& path, const Read& read) {
  const auto fail = [&](const std::string& what) {
    return Error(ErrorKind::geometry, path.string() + " is broken: " + what, "export the asset again");
  };
  try {
    return read();
  } catch (const json::exception& error) {
    throw fail(error.what());
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::io) throw;
    throw fail(error.what());
  }
}

double share(const json& settings, const char* key) { return std::clamp(settings.value(key, 1.0), 0.0, 1.0); }

void read_texture(const GltfFile& file, const json& settings, PartLook& look) {
  if (!settings.contains("baseColorTexture")) return;
  const json& texture =
      file.document.at("textures").at(settings["baseColorTexture"].at("index").get<std::size_t>());
  if (!texture.contains("source")) return;  // only in the format of an extension
  const auto number = texture["source"].get<std::size_t>();
  const json& image = file.document.at("images").at(number);
  const std::string uri = image.value("uri", "");
  if (!uri.empty() && !uri.starts_with("data:")) look.texture = decode_uri(uri);
  if (image.contains("bufferView") && file.binary > 0) look.embedded_texture = static_cast<long>(number);
}

}  // namespace

std::vector<PartLook> read_part_looks(const std::filesystem::path& path) {
  return told_with_name(path, [&] {
    const GltfFile file = read_gltf(path);
    std::vector<PartLook> looks;
    if (!file.document.is_object() || !file.document.contains("materials")) return looks;
    const json& materials = file.document["materials"];
    if (!materials.is_array()) return looks;  // glTF 1.0
    for (const json& material : materials) {
      if (!material.contains("pbrMetallicRoughness")) continue;
      const json& settings = material["pbrMetallicRoughness"];
      PartLook look;
      look.part = material.value("name", "");
      if (look.part.empty()) look.part = "default";
      const bool known = std::any_of(looks.begin(), looks.end(),
                                     [&](const PartLook& other) { return other.part == look.part; });
      if (known) continue;
      if (settings.contains("baseColorFactor")) {
        for (std::size_t k = 0; k < 3; ++k) {
          look.color[static_cast<Eigen::Index>(k)] =
              std::clamp(settings["baseColorFactor"].at(k).get<double>(), 0.0, 1.0);
        }
      }
      look.metallic = settings.contains("metallicRoughnessTexture") ? 0 : share(settings, "metallicFactor");
      look.roughness = share(settings, "roughnessFactor");
      read_texture(file, settings, look);
      looks.push_back(std::move(look));
    }
    return looks;
  });
}

Bytes read_embedded_image(const std::filesystem::path& path, long number) {
  return told_with_name(path, [&] {
    const GltfFile file = read_gltf(path);
    const json images =
        file.document.is_object() ? file.document.value("images", json::array()) : json::array();
    const auto index = static_cast<std::size_t>(number);
    if (file.binary == 0 || index >= images.size() || !images[index].contains("bufferView")) {
      throw Error(ErrorKind::io, path.string() + " holds no image " + std::to_string(number),
                  "images inside a GLB count from 0");
    }
    const json& view = file.document.at("bufferViews").at(images[index]["bufferView"].get<std::size_t>());
    const auto start = view.value("byteOffset", std::size_t{0}),
               size = view.at("byteLength").get<std::size_t>();
    const std::size_t available = file.content.size() - file.binary;
    if (start > available || size > available - start) throw Error(ErrorKind::geometry, "it ends early");
    const auto begin = file.content.begin() + static_cast<std::ptrdiff_t>(file.binary + start);
    return Bytes(begin, begin + static_cast<std::ptrdiff_t>(size));
  });
}

std::string decode_uri(const std::string& uri) {
  std::string name;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    int code = 0;
    const char* const digits = uri.data() + i + 1;
    if (uri[i] == '%' && i + 2 < uri.size() &&
        std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2) {
      name += static_cast<char>(code);
      i += 2;
    } else {
      name += uri[i];
    }
  }
  return name;
}

}  // namespace vivify

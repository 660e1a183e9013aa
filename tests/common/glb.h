// GLB files made in memory.
#pragma once

#include <cstdint>
#include <string>

#include "common/mesh.h"

namespace vivify::testing_support {

// The bytes of a GLB from its JSON and its binary chunk.
inline std::string glb_text(std::string json, std::string binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  std::string text = "glTF";
  const auto word = [&](std::size_t value) {
    const auto bits = static_cast<std::uint32_t>(value);
    text.append(reinterpret_cast<const char*>(&bits), sizeof bits);
  };
  word(2);
  word(12 + 8 + json.size() + 8 + binary.size());
  word(json.size());
  text += "JSON" + json;
  word(binary.size());
  return text + "BIN" + '\0' + binary;
}

// A GLB of the mesh with one primitive for each part, in their order, whose materials are `materials` (JSON,
// one object for each part). `image`, when it is not empty, is the image 0 and the texture 0.
inline std::string glb_text(const TriangleMesh& mesh, const std::string& materials,
                            const std::string& image = "") {
  std::string binary, views, accessors, primitives;
  const auto view = [&](std::size_t start) {
    views += (views.empty() ? "" : ",") + std::string(R"({"buffer":0,"byteOffset":)") +
             std::to_string(start) + R"(,"byteLength":)" + std::to_string(binary.size() - start) + "}";
  };
  const auto append = [&](auto value) { binary.append(reinterpret_cast<const char*>(&value), sizeof value); };
  const auto accessor = [&](int number, int component, Eigen::Index count, const std::string& type) {
    accessors += (accessors.empty() ? "" : ",") + std::string(R"({"bufferView":)") + std::to_string(number) +
                 R"(,"componentType":)" + std::to_string(component) + R"(,"count":)" + std::to_string(count) +
                 R"(,"type":")" + type + R"("})";
  };
  for (const double x : mesh.V.reshaped<Eigen::RowMajor>()) append(static_cast<float>(x));
  view(0);
  accessor(0, 5126, mesh.V.rows(), "VEC3");
  const int parts = mesh.face_part.size() > 0 ? mesh.face_part.maxCoeff() + 1 : 1;
  for (int part = 0; part < parts; ++part) {
    const std::size_t start = binary.size();
    Eigen::Index count = 0;
    for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
      if (mesh.face_part.size() > 0 && mesh.face_part[f] != part) continue;
      for (const int v : mesh.F.row(f)) append(static_cast<std::uint32_t>(v));
      count += 3;
    }
    view(start);
    accessor(part + 1, 5125, count, "SCALAR");
    primitives += (part == 0 ? "" : ",") + std::string(R"({"attributes":{"POSITION":0},"indices":)") +
                  std::to_string(part + 1) + R"(,"material":)" + std::to_string(part) + "}";
  }
  std::string textures;
  if (!image.empty()) {
    const std::size_t start = binary.size();
    binary += image;
    view(start);
    textures = R"("textures":[{"source":0}],"images":[{"mimeType":"image/png","bufferView":)" +
               std::to_string(parts + 1) + "}],";
  }
  return glb_text(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)" +
                      textures + R"("meshes":[{"primitives":[)" + primitives + R"(]}],"materials":[)" +
                      materials + R"(],"accessors":[)" + accessors + R"(],"bufferViews":[)" + views +
                      R"(],"buffers":[{"byteLength":)" + std::to_string(binary.size()) + "}]}",
                  binary);
}

}  // namespace vivify::testing_support

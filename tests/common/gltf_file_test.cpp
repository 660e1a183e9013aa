#include "common/gltf_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "common/error.h"
#include "common/mesh_io.h"
#include "tests/common/glb.h"
#include "tests/common/temporary_folder.h"

namespace vivify {
namespace {

using ::testing::HasSubstr;
using testing_support::glb_text;
using testing_support::TemporaryFolder;
using testing_support::write_quickly;

// Two triangles that are parts 0 and 1.
TriangleMesh two_parts() {
  TriangleMesh mesh;
  mesh.V = (Points(4, 3) << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0).finished();
  mesh.F = (Triangles(2, 3) << 0, 1, 2, 0, 2, 3).finished();
  mesh.face_part = Eigen::Vector2i(0, 1);
  return mesh;
}

// The looks of a .gltf file with these materials and further members.
std::vector<PartLook> looks_of(const std::string& materials, const std::string& more = "") {
  const TemporaryFolder folder;
  write_quickly(folder / "a.GLTF", R"({"asset":{"version":"2.0"},"materials":)" + materials + more + "}");
  return read_part_looks(folder / "a.GLTF");
}

ErrorKind kind_of_error(const std::function<void()>& read) {
  try {
    read();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("a.gl"));
    return error.kind();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorKind::internal;
}

TEST(PartLooks, AreThoseOfThePartsOfTheMesh) {
  const TemporaryFolder folder;
  write_quickly(folder / "a.glb", glb_text(two_parts(), R"(
    {"name":"cup","pbrMetallicRoughness":{"baseColorFactor":[0.1,0.2,0.3,1],"metallicFactor":0,"roughnessFactor":0.4}},
    {"pbrMetallicRoughness":{"baseColorFactor":[0.9,0.6,0.3,1],"metallicFactor":1,"roughnessFactor":0.25}})"));
  EXPECT_EQ(read_mesh(folder / "a.glb").part_names, (std::vector<std::string>{"cup", "default"}));
  const std::vector<PartLook> looks = read_part_looks(folder / "a.glb");
  ASSERT_EQ(looks.size(), 2u);
  EXPECT_EQ(looks[0].part, "cup");
  EXPECT_EQ(looks[0].color, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(looks[0].metallic, 0);
  EXPECT_EQ(looks[0].roughness, 0.4);
  EXPECT_FALSE(looks[0].texture || looks[0].embedded_texture);
  EXPECT_EQ(looks[1].part, "default");
  EXPECT_EQ(looks[1].metallic, 1);
}

TEST(PartLooks, DefaultsAreThoseOfGltf) {
  const std::vector<PartLook> looks = looks_of(R"([{"name":"silent"},{"name":"a","pbrMetallicRoughness":{}},
    {"name":"a","pbrMetallicRoughness":{"roughnessFactor":0}},
    {"name":"b","pbrMetallicRoughness":{"baseColorFactor":[-1,2,0.5,1],"roughnessFactor":7}},
    {"name":"c","pbrMetallicRoughness":{"metallicRoughnessTexture":{"index":0}}}])");
  ASSERT_EQ(looks.size(), 3u);  // one material says nothing, and of two of one name the first counts
  EXPECT_EQ(looks[0].color, Eigen::Vector3d(1, 1, 1));
  EXPECT_EQ(looks[0].metallic, 1);
  EXPECT_EQ(looks[0].roughness, 1);
  EXPECT_EQ(looks[1].color, Eigen::Vector3d(0, 1, 0.5));
  EXPECT_EQ(looks[1].roughness, 1);
  EXPECT_EQ(looks[2].metallic, 0);  // it varies over the part
}

TEST(PartLooks, NameTheImageThatTheColorIsMultipliedBy) {
  const std::vector<PartLook> looks =
      looks_of(R"([{"name":"beside","pbrMetallicRoughness":{"baseColorTexture":{"index":1}}},
                   {"name":"data","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}},
                   {"name":"extension","pbrMetallicRoughness":{"baseColorTexture":{"index":2}}}])",
               R"(,"textures":[{"source":0},{"source":1},{}],
                   "images":[{"uri":"data:image/png;base64,AA=="},{"uri":"oak%20%C3%A4.png"}])");
  ASSERT_EQ(looks.size(), 3u);
  EXPECT_EQ(looks[0].texture, "oak ä.png");
  for (const PartLook& look : looks) EXPECT_FALSE(look.embedded_texture);
  EXPECT_FALSE(looks[1].texture || looks[2].texture);
}

TEST(PartLooks, ImagesInsideAGlbAreReadBack) {
  const TemporaryFolder folder;
  const std::string image = "\x89PNG and so on";
  write_quickly(folder / "a.glb", glb_text(two_parts(), R"(
    {"name":"a","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}},{"name":"b"})",
                                           image));
  const std::vector<PartLook> looks = read_part_looks(folder / "a.glb");
  ASSERT_EQ(looks.size(), 1u);
  EXPECT_EQ(looks[0].embedded_texture, 0);
  EXPECT_FALSE(looks[0].texture);
  const Bytes read = read_embedded_image(folder / "a.glb", 0);
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(read.data()), read.size()), image);
  EXPECT_EQ(kind_of_error([&] { read_embedded_image(folder / "a.glb", 1); }), ErrorKind::io);
  write_quickly(folder / "a.glb",
                glb_text(R"({"images":[{"bufferView":0}],"bufferViews":[{"byteOffset":4,"byteLength":5}]})",
                         "12345678"));
  EXPECT_EQ(kind_of_error([&] { read_embedded_image(folder / "a.glb", 0); }), ErrorKind::geometry);
}

TEST(PartLooks, OtherFormatsHaveNone) {
  const TemporaryFolder folder;
  write_quickly(folder / "a.obj", "mtllib a.mtl\nv 0 0 0\n");
  EXPECT_TRUE(read_part_looks(folder / "a.obj").empty());
  EXPECT_TRUE(looks_of(R"({"version 1":{"values":{}}})").empty());
  EXPECT_EQ(kind_of_error([&] { read_part_looks(folder / "a.glb"); }), ErrorKind::io);
}

TEST(PartLooks, BrokenFilesAreGeometryErrors) {
  const TemporaryFolder folder;
  for (const char* material :
       {R"({"name":3,"pbrMetallicRoughness":{}})", R"({"pbrMetallicRoughness":{"roughnessFactor":"x"}})",
        R"({"pbrMetallicRoughness":{"baseColorFactor":[1]}})", R"({"pbrMetallicRoughness":7})",
        R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})"}) {
    SCOPED_TRACE(material);
    write_quickly(folder / "a.gltf", R"({"materials":[)" + std::string(material) + "]}");
    EXPECT_EQ(kind_of_error([&] { read_part_looks(folder / "a.gltf"); }), ErrorKind::geometry);
  }
  const std::string whole = glb_text(R"({"materials":[{"name":"a"}]})", "");
  const std::size_t end_of_json = whole.rfind("BIN") - 4;
  for (std::size_t size = 4; size < end_of_json; ++size) {
    write_quickly(folder / "a.glb", whole.substr(0, size));
    EXPECT_EQ(kind_of_error([&] { read_part_looks(folder / "a.glb"); }), ErrorKind::geometry) << size;
  }
}

TEST(DecodeUri, ReadsHexadecimalCodes) {
  EXPECT_EQ(decode_uri("a%20b%2Fc"), "a b/c");
  EXPECT_EQ(decode_uri("100%"), "100%");
  EXPECT_EQ(decode_uri("%zz%2"), "%zz%2");
}

}  // namespace
}  // namespace vivify

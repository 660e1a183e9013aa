#include "common/mesh_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "common/error.h"
#include "common/file.h"
#include "tests/common/temporary_folder.h"

namespace vivify {
namespace {

using ::testing::HasSubstr;
using testing_support::TemporaryFolder;
using testing_support::write_quickly;

// The tetrahedron with the corners 0, x, y, z; outward.
const Points kPoints = (Points(4, 3) << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1).finished();
const Triangles kFaces = (Triangles(4, 3) << 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3).finished();

void expect_tetrahedron(const TriangleMesh& mesh) {
  EXPECT_EQ(mesh.V.rows(), 4);
  EXPECT_EQ(mesh.F.rows(), 4);
  EXPECT_NEAR(signed_volume(mesh), 1.0 / 6, 1e-7);
  ASSERT_EQ(mesh.face_part.size(), 4);
  EXPECT_EQ(mesh.face_part.maxCoeff(), static_cast<int>(mesh.part_names.size()) - 1);
}

template <class T>
void append(std::string& text, T value) {
  text.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string binary_stl(float bad = 0) {
  std::string text(80, ' ');
  append<std::uint32_t>(text, 4);
  for (Eigen::Index f = 0; f < 4; ++f) {
    for (int k = 0; k < 3; ++k) append<float>(text, 0);
    for (int k = 0; k < 3; ++k) {
      for (int d = 0; d < 3; ++d)
        append<float>(text,
                      static_cast<float>(kPoints(kFaces(f, k), d)) + (f == 3 && k == 2 && d == 1 ? bad : 0));
    }
    append<std::uint16_t>(text, 0);
  }
  return text;
}

std::string ascii_stl(const std::string& header) {
  std::string text = header + "\n";
  for (Eigen::Index f = 0; f < 4; ++f) {
    text += "facet normal 0 0 0\n outer loop\n";
    for (int k = 0; k < 3; ++k) {
      text += "  vertex";
      for (int d = 0; d < 3; ++d) text += " " + std::to_string(kPoints(kFaces(f, k), d));
      text += "\n";
    }
    text += " endloop\nendfacet\n";
  }
  return text + "endsolid\n";
}

const std::string kObj =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    "usemtl porcelain\nf 1 3 2\nf 1 2 4\nusemtl eyes\nf 1 4 3\nf 2 3 4\n";
const std::string kPlyHeader =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kPlyPoints = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
const std::string kPlyFaces = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
const std::string kOff = "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

// A glTF file beside which `mesh.bin` holds the tetrahedron; `node` goes into the node of the mesh.
void write_gltf(const TemporaryFolder& folder, const std::string& node, int last_index = 3,
                float last_z = 1) {
  std::string binary;
  for (Eigen::Index i = 0; i < 12; ++i)
    append<float>(binary, i == 11 ? last_z : static_cast<float>(kPoints.data()[i]));
  for (Eigen::Index i = 0; i < 12; ++i)
    append<std::uint16_t>(binary, static_cast<std::uint16_t>(i == 11 ? last_index : kFaces.data()[i]));
  write_file_atomic(folder / "mesh.bin", binary);
  write_file_atomic(folder / "mesh.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
    "nodes":[{"children":[1],"translation":[10,0,0]},{"mesh":0)" +
                                              node + R"(}],
    "materials":[{"name":"porcelain"}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
    "buffers":[{"uri":"mesh.bin","byteLength":72}],
    "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},
                 {"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}]})");
}

std::string error_of(const std::filesystem::path& path, ErrorKind kind) {
  try {
    read_mesh(path);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.full_text();
    EXPECT_THAT(error.full_text(), HasSubstr(path.filename().string()));
    return error.full_text();
  }
  ADD_FAILURE() << path << ": nothing was thrown";
  return "";
}

TEST(ReadMesh, ReadsEveryFormat) {
  const TemporaryFolder folder;
  write_file_atomic(folder / "a.obj", kObj);
  write_file_atomic(folder / "a.ply", kPlyHeader + kPlyPoints + kPlyFaces);
  write_file_atomic(folder / "a.OFF", kOff);
  write_file_atomic(folder / "binary.stl", binary_stl());
  write_file_atomic(folder / "ascii.stl", ascii_stl("solid cup"));
  write_file_atomic(folder / "tab.stl", ascii_stl("solid\tcup"));
  write_gltf(folder, "");
  for (const char* name : {"a.obj", "a.ply", "a.OFF", "binary.stl", "ascii.stl", "tab.stl", "mesh.gltf"}) {
    SCOPED_TRACE(name);
    const TriangleMesh mesh = read_mesh(folder / name);
    expect_tetrahedron(mesh);
    EXPECT_EQ(mesh.UV.rows(), 0);
  }
  EXPECT_EQ(read_mesh(folder / "a.ply").V, kPoints);
  EXPECT_EQ(read_mesh(folder / "a.ply").F, kFaces);
  EXPECT_EQ(read_mesh(folder / "a.ply").part_names, std::vector<std::string>{"default"});
  EXPECT_EQ(read_mesh(folder / "binary.stl").part_names, std::vector<std::string>{"default"});
}

TEST(ReadMesh, KeepsTheMaterialsAsParts) {
  const TemporaryFolder folder;
  write_file_atomic(folder / "a.obj", kObj);
  const TriangleMesh mesh = read_mesh(folder / "a.obj");
  EXPECT_EQ(mesh.part_names, (std::vector<std::string>{"porcelain", "eyes"}));
  EXPECT_EQ(mesh.face_part, Eigen::Vector4i(0, 0, 1, 1));
  write_gltf(folder, "");
  EXPECT_EQ(read_mesh(folder / "mesh.gltf").part_names, std::vector<std::string>{"porcelain"});
}

TEST(ReadMesh, AppliesTheTransformsOfNodesAndTurnsMirroredFaces) {
  const TemporaryFolder folder;
  write_gltf(folder, R"(,"translation":[0,5,0],"scale":[-2,1,1])");
  const TriangleMesh mesh = read_mesh(folder / "mesh.gltf");
  EXPECT_NEAR(signed_volume(mesh), 2.0 / 6, 1e-5);
  const Box box = bounding_box(mesh.V);
  EXPECT_LT((box.min - Eigen::Vector3d(8, 5, 0)).norm(), 1e-6);
  EXPECT_LT((box.max - Eigen::Vector3d(10, 6, 1)).norm(), 1e-6);
}

TEST(ReadMesh, JoinsVerticesOnlyWherePositionAndTextureAgree) {
  const TemporaryFolder folder;
  const std::string square =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0.5 0.5\nvn 0 0 1\nvn 0 1 0\n";
  write_file_atomic(folder / "same.obj",
                    square + "f 1/1/1 2/2/1 3/3/1\nf 1/1/2 3/3/2 4/4/2\n");  // normals differ
  write_file_atomic(folder / "seam.obj", square + "f 1/1/1 2/2/1 3/3/1\nf 1/5/1 3/3/1 4/4/1\n");
  const TriangleMesh same = read_mesh(folder / "same.obj"), seam = read_mesh(folder / "seam.obj");
  EXPECT_EQ(same.V.rows(), 4);
  EXPECT_EQ(seam.V.rows(), 5);
  ASSERT_EQ(seam.UV.rows(), 5);
  for (Eigen::Index v = 0; v < 4; ++v) EXPECT_EQ(same.UV.row(v), same.V.row(v).head<2>());
}

TEST(ReadMesh, TriangulatesPolygonsAndDropsPointsAndLines) {
  const TemporaryFolder folder;
  write_file_atomic(folder / "a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 9 9 9\nf 1 2 3 4\nl 1 5\np 5\n");
  const TriangleMesh mesh = read_mesh(folder / "a.obj");
  EXPECT_EQ(mesh.V.rows(), 4);
  EXPECT_EQ(mesh.F.rows(), 2);
  EXPECT_EQ(bounding_box(mesh.V).max.maxCoeff(), 1);
}

TEST(ReadMesh, LinesAmongTrianglesAreDropped) {
  const TemporaryFolder folder;
  write_file_atomic(folder / "a.obj", kObj + "l 1 2\np 3\n");
  write_file_atomic(folder / "a.off",
                    "OFF\n4 5 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n2 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  write_file_atomic(folder / "a.ply",
                    std::string(kPlyHeader).replace(kPlyHeader.find("face 4"), 6, "face 5") + kPlyPoints +
                        "2 0 1\n" + kPlyFaces);
  for (const char* name : {"a.obj", "a.off", "a.ply"}) {
    SCOPED_TRACE(name);
    expect_tetrahedron(read_mesh(folder / name));
  }
}

TEST(ReadMesh, MissingFilesAreIoErrors) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of(folder / "none.obj", ErrorKind::io), HasSubstr("does not exist"));
  std::filesystem::create_directory(folder / "folder.obj");
  error_of(folder / "folder.obj", ErrorKind::io);
}

TEST(ReadMesh, FilesWithoutTrianglesAreGeometryErrors) {
  const TemporaryFolder folder;
  for (const char* name : {"a.obj", "a.ply", "a.off", "a.stl", "a.gltf", "a.glb"}) {
    write_file_atomic(folder / name, "");
    error_of(folder / name, ErrorKind::geometry);
    write_file_atomic(folder / name, "this is no mesh\n");
    error_of(folder / name, ErrorKind::geometry);
  }
  write_file_atomic(folder / "points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  error_of(folder / "points.obj", ErrorKind::geometry);
  write_file_atomic(folder / "lines.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2 3\n");
  EXPECT_THAT(error_of(folder / "lines.obj", ErrorKind::geometry), HasSubstr("holds no triangle"));
  write_file_atomic(folder / "a.fbx", "x");
  EXPECT_THAT(error_of(folder / "a.fbx", ErrorKind::geometry), HasSubstr(".obj, .ply"));
}

TEST(ReadMesh, VerticesThatAreNotFiniteAreNamed) {
  const TemporaryFolder folder;
  write_file_atomic(folder / "nan.obj", "v 0 0 0\nv 1 0 0\nv 0 nan 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n");
  EXPECT_THAT(error_of(folder / "nan.obj", ErrorKind::geometry), HasSubstr("vertex 2"));
  write_file_atomic(folder / "nan.ply", kPlyHeader + "0 0 0\n1 0 0\n0 1 0\n0 0 nan\n" + kPlyFaces);
  EXPECT_THAT(error_of(folder / "nan.ply", ErrorKind::geometry), HasSubstr("vertex 3"));
  write_file_atomic(folder / "inf.ply", kPlyHeader + "0 0 0\ninf 0 0\n0 1 0\n0 0 1\n" + kPlyFaces);
  EXPECT_THAT(error_of(folder / "inf.ply", ErrorKind::geometry), HasSubstr("vertex 1"));
  write_file_atomic(folder / "nan.stl", binary_stl(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_THAT(error_of(folder / "nan.stl", ErrorKind::geometry), HasSubstr("vertex 11"));
  write_gltf(folder, "", 3, std::numeric_limits<float>::quiet_NaN());
  EXPECT_THAT(error_of(folder / "mesh.gltf", ErrorKind::geometry), HasSubstr("vertex 3"));
}

TEST(ReadMesh, IndicesOutOfRangeAreGeometryErrors) {
  const TemporaryFolder folder;
  write_file_atomic(folder / "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  error_of(folder / "a.obj", ErrorKind::geometry);
  write_file_atomic(folder / "a.ply", kPlyHeader + kPlyPoints + "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 7\n");
  error_of(folder / "a.ply", ErrorKind::geometry);
  write_file_atomic(folder / "a.off", "OFF\n3 1 3\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n");
  error_of(folder / "a.off", ErrorKind::geometry);
  write_gltf(folder, "", 9);
  error_of(folder / "mesh.gltf", ErrorKind::geometry);
}

TEST(ReadMesh, TruncatedFilesNeverCrash) {
  const TemporaryFolder folder;
  write_file_atomic(folder / "a.stl", binary_stl().substr(0, 150));
  error_of(folder / "a.stl", ErrorKind::geometry);
  std::string huge(80, ' ');
  append<std::uint32_t>(huge, 0x7fffffff);
  write_file_atomic(folder / "huge.stl", huge + std::string(50, '\0'));
  error_of(folder / "huge.stl", ErrorKind::geometry);
  write_gltf(folder, "");
  std::filesystem::remove(folder / "mesh.bin");
  error_of(folder / "mesh.gltf", ErrorKind::geometry);
}

// A PLY file with everything that a reader must skip, in either byte order.
std::string rich_ply(bool big_endian) {
  std::string text =
      std::string("ply\r\nformat binary_") + (big_endian ? "big" : "little") +
      "_endian 1.0\r\ncomment made by a test\r\nobj_info x\r\nelement camera 1\r\nproperty short a\r\n"
      "property list uchar float b\r\nelement vertex 4\r\nproperty float nx\r\nproperty double x\r\nproperty "
      "float y\r\n"
      "property float z\r\nproperty uchar red\r\nproperty float s\r\nproperty float t\r\nelement face 2\r\n"
      "property int8 flag\r\nproperty list uint8 uint32 vertex_index\r\nproperty list uchar float "
      "texcoord\r\nend_header\r\n";
  const auto put = [&]<class T>(T value) {
    std::string bytes;
    append(bytes, value);
    if (big_endian) std::reverse(bytes.begin(), bytes.end());
    text += bytes;
  };
  put(std::int16_t{-3});
  put(std::uint8_t{2});
  put(1.0F);
  put(2.0F);
  for (int v = 0; v < 4; ++v) {
    put(0.5F);
    put(v == 1 || v == 2 ? 0.1 : 0.0);
    put(v >= 2 ? 1.0F : 0.0F);
    put(0.0F);
    put(std::uint8_t{255});
    put(v == 1 || v == 2 ? 1.0F : 0.0F);
    put(v >= 2 ? 1.0F : 0.0F);
  }
  for (const std::vector<std::uint32_t>& face : {std::vector<std::uint32_t>{0, 1, 2, 3}, {3, 2, 1}}) {
    put(std::int8_t{-1});
    put(static_cast<std::uint8_t>(face.size()));
    for (const std::uint32_t v : face) put(v);
    put(std::uint8_t{1});
    put(7.0F);
  }
  return text;
}

TEST(ReadPly, SkipsWhatItDoesNotKnowInEitherByteOrder) {
  const TemporaryFolder folder;
  for (const bool big_endian : {false, true}) {
    write_file_atomic(folder / "a.ply", rich_ply(big_endian));
    const TriangleMesh mesh = read_mesh(folder / "a.ply");
    EXPECT_EQ(mesh.V.rows(), 4);
    EXPECT_EQ(mesh.F.rows(), 3);
    EXPECT_EQ(mesh.V(1, 0), 0.1);  // doubles stay doubles
    ASSERT_EQ(mesh.UV.rows(), 4);
    EXPECT_EQ(mesh.UV(2, 0), 1);
    EXPECT_EQ(mesh.UV(2, 1), 1);
  }
}

TEST(ReadPly, EveryTruncationIsAnError) {
  const TemporaryFolder folder;
  const std::string ascii = kPlyHeader + kPlyPoints + kPlyFaces, binary = rich_ply(false);
  for (std::size_t size = 1; size + 1 < ascii.size(); size += 3) {
    write_quickly(folder / "a.ply", ascii.substr(0, size));
    error_of(folder / "a.ply", ErrorKind::geometry);
  }
  for (std::size_t size = 1; size < binary.size(); size += 3) {
    write_quickly(folder / "a.ply", binary.substr(0, size));
    error_of(folder / "a.ply", ErrorKind::geometry);
  }
}

TEST(ReadPly, BrokenHeadersAreErrors) {
  const TemporaryFolder folder;
  const auto error_with = [&](const std::string& from, const std::string& to) {
    std::string text = kPlyHeader + kPlyPoints + kPlyFaces;
    text.replace(text.find(from), from.size(), to);
    write_file_atomic(folder / "a.ply", text);
    return error_of(folder / "a.ply", ErrorKind::geometry);
  };
  EXPECT_THAT(error_with("ascii", "text"), HasSubstr("unknown format 'text'"));
  EXPECT_THAT(error_with("vertex 4", "vertex -4"), HasSubstr("odd header line"));
  EXPECT_THAT(error_with("vertex 4", "vertex 4000000000"), HasSubstr("a.ply"));
  EXPECT_THAT(error_with("float x", "half x"), HasSubstr("unknown type 'half'"));
  EXPECT_THAT(error_with("float x", "float a"), HasSubstr("without x, y or z"));
  EXPECT_THAT(error_with("vertex_indices", "corners"), HasSubstr("without vertex_indices"));
  EXPECT_THAT(error_with("1 0 0", "1 O 0"), HasSubstr("'O' for a number, in element vertex"));
  EXPECT_THAT(error_with("3 0 2 1", "3 0 -2 1"), HasSubstr("refers to vertex -2"));
  EXPECT_THAT(error_with("3 0 2 1", "-3 0 2 1"), HasSubstr("list of odd length"));
}

TEST(WritePly, ReadsBack) {
  const TemporaryFolder folder;
  TriangleMesh mesh;
  mesh.V = kPoints * 0.1;
  mesh.F = kFaces;
  write_ply(folder / "a.ply", mesh);
  const TriangleMesh again = read_mesh(folder / "a.ply");
  EXPECT_EQ(again.V, mesh.V);
  EXPECT_EQ(again.F, mesh.F);
}

}  // namespace
}  // namespace vivify

#include "core/error.h"
#include "core/scratch_folder.h"
#include "mesh_bytes.h"
#include "scene/mesh.h"

#include <gmock/gmock.h>

namespace nacre {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TriangleMesh obj(const std::string& text) { return parse_obj(text, "m.obj"); }
TriangleMesh ply(const std::string& text) { return parse_ply(bytes_of(text), "m.ply"); }
SerializedMesh serialized(const std::string& text, int index = 0) {
  return parse_serialized(bytes_of(text), index, "m.serialized");
}
std::string obj_error(const std::string& text) {
  return message_of([&] { obj(text); });
}
std::string ply_error(const std::string& text) {
  return message_of([&] { ply(text); });
}

const std::string square_obj = "# a square\nmtllib x.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                               "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 3\n";

TEST(Obj, PolygonBecomesAFanThatSharesVertices) {
  const TriangleMesh m = obj(square_obj + "usemtl a\ns off\nf 1/1/1 2/2/1 3/3/1 4/4/1\n");
  ASSERT_EQ(m.positions.size(), 4u);
  ASSERT_EQ(m.triangles.size(), 2u);
  EXPECT_EQ(m.triangles[0], (std::array<std::uint32_t, 3>{0, 1, 2}));
  EXPECT_EQ(m.triangles[1], (std::array<std::uint32_t, 3>{0, 2, 3}));
  EXPECT_FLOAT_EQ(m.normals[2].z, 1); // made unit length
  EXPECT_FLOAT_EQ(m.uvs[3].y, 1);
}

TEST(Obj, CornersMayLackUvOrNormal) {
  EXPECT_TRUE(obj(square_obj + "f 1 2 3").normals.empty());
  EXPECT_TRUE(obj(square_obj + "f 1 2 3").uvs.empty());
  EXPECT_TRUE(obj(square_obj + "f 1//1 2//1 3//1").uvs.empty());
  EXPECT_TRUE(obj(square_obj + "f 1/1 2/2 3/3").normals.empty());
  const TriangleMesh mixed = obj(square_obj + "f 1//1 2 3");
  EXPECT_FLOAT_EQ(mixed.normals[1].z, 1); // smooth normal of the same face
}

TEST(Obj, NegativeIndicesCountFromTheLatest) {
  const TriangleMesh m = obj("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\n");
  EXPECT_FLOAT_EQ(m.positions[1].x, 1);
  EXPECT_EQ(m.positions.size(), 3u);
}

TEST(Obj, OneVertexPerCombination) {
  const TriangleMesh m = obj(square_obj + "f 1/1 2/2 3/3\nf 1/2 2/2 3/3\n");
  EXPECT_EQ(m.positions.size(), 4u);
  EXPECT_EQ(m.triangles[1][1], m.triangles[0][1]);
}

TEST(Obj, WindowsLinesContinuationsAndWeightsAreRead) {
  const TriangleMesh m = obj("v 0 0 0 1\r\nv 1 0 0 0.5 0.5 0.5\r\nv 0 +1.5 0\r\nf 1 \\\r\n2 3\r\n");
  EXPECT_FLOAT_EQ(m.positions[2].y, 1.5f);
}

TEST(Obj, ErrorsSayLineAndColumn) {
  EXPECT_THAT(obj_error("v 0 0 0\nv 1 nan 0\n"), StartsWith("m.obj:2:5: "));
  EXPECT_THAT(obj_error("v 0 0 1e39\n"), HasSubstr("not a finite number"));
  EXPECT_THAT(obj_error("v 0 inf 0\n"), HasSubstr("not a finite number"));
  EXPECT_THAT(obj_error("v 0 0\n"), StartsWith("m.obj:1:6: expected z of a vertex"));
  EXPECT_THAT(obj_error("v 0 0x3 0\n"), HasSubstr("'0x3'"));
  EXPECT_THAT(obj_error(square_obj + "f 1 2 5\n"), StartsWith("m.obj:12:7: there is no vertex 5"));
  EXPECT_THAT(obj_error(square_obj + "f 0 1 2\n"), HasSubstr("there is no vertex 0"));
  EXPECT_THAT(obj_error(square_obj + "f -5 1 2\n"), HasSubstr("there is no vertex -5"));
  EXPECT_THAT(obj_error(square_obj + "f 1/9 2 3\n"), HasSubstr("texture coordinate 9"));
  EXPECT_THAT(obj_error(square_obj + "f 1//2 2 3\n"), HasSubstr("normal 2"));
  EXPECT_THAT(obj_error(square_obj + "f 1 2\n"), HasSubstr("at least 3"));
  EXPECT_THAT(obj_error(square_obj + "f 99999999999999999999 2 3\n"), HasSubstr("index"));
  EXPECT_THAT(obj_error("surf 0 1\n"), HasSubstr("free-form"));
  EXPECT_THAT(obj_error(""), HasSubstr("has none"));
  EXPECT_THAT(obj_error("\x7f"
                        "ELF\n"),
              HasSubstr("expected an OBJ statement"));
}

TEST(Obj, FileAndFolderAreTold) {
  const ScratchFolder folder;
  EXPECT_EQ(read_obj(folder.write("a.obj", square_obj + "f 1 2 3")).triangles.size(), 1u);
  EXPECT_THAT(message_of([&] { read_obj(folder.path()); }), HasSubstr(folder.path()));
  EXPECT_THAT(message_of([&] { read_obj(folder / "b.obj"); }), HasSubstr("b.obj"));
}

const std::string ascii_ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                              "property float z\nproperty float quality\nelement face 2\n"
                              "property list uchar int vertex_index\nend_header\n"
                              "0 0 0 1\n1 0 0 1\n1 1 0 1\n0 1 0 1\n";

TEST(Ply, AsciiMixesTrianglesAndQuads) {
  const TriangleMesh m = ply(ascii_ply + "3 0 1 2\n4 0 1 2 3\n");
  EXPECT_EQ(m.positions.size(), 4u);
  ASSERT_EQ(m.triangles.size(), 3u);
  EXPECT_EQ(m.triangles[2], (std::array<std::uint32_t, 3>{0, 2, 3}));
  EXPECT_TRUE(m.normals.empty());
}

TEST(Ply, BinaryOfBothByteOrdersIsTheSameMesh) {
  for (const bool big_endian : {false, true}) {
    const TriangleMesh m = ply(binary_ply(big_endian));
    ASSERT_EQ(m.positions.size(), 4u) << big_endian;
    EXPECT_EQ(m.triangles.size(), 2u);
    EXPECT_FLOAT_EQ(m.positions[2].x, 1);
    EXPECT_FLOAT_EQ(m.positions[2].y, 1);
    EXPECT_FLOAT_EQ(m.normals[1].z, 1);
    EXPECT_FLOAT_EQ(m.uvs[3].y, 1);
  }
}

TEST(Ply, EveryTruncationIsAnError) {
  for (const bool big_endian : {false, true}) {
    const std::string whole = binary_ply(big_endian);
    for (std::size_t n = 0; n < whole.size(); ++n)
      EXPECT_THROW(ply(whole.substr(0, n)), Error) << n << " bytes of " << whole.size();
  }
  const std::string ascii = ascii_ply + "3 0 1 2\n4 0 1 2 3";
  for (std::size_t n = 0; n < ascii.size(); ++n)
    EXPECT_THROW(ply(ascii.substr(0, n)), Error) << n;
}

TEST(Ply, ErrorsSayWhere) {
  EXPECT_THAT(ply_error(ascii_ply + "3 0 1 4\n3 0 1 2\n"), StartsWith("m.ply:15:7: face 0 names a vertex"));
  EXPECT_THAT(ply_error(ascii_ply + "3 0 1 -1\n3 0 1 2\n"), HasSubstr("names a vertex"));
  EXPECT_THAT(ply_error(ascii_ply + "2 0 1\n3 0 1 2\n"), HasSubstr("at least 3"));
  EXPECT_THAT(ply_error(ascii_ply + "-3 0 1 2\n3 0 1 2\n"), HasSubstr("impossible"));
  EXPECT_THAT(ply_error("ply\nformat ascii 1.0\nelement vertex 1\nproperty flaot x\n"), HasSubstr("'float'"));
  EXPECT_THAT(ply_error("not a mesh"), HasSubstr("not a PLY file"));
  std::string nan = ascii_ply + "3 0 1 2\n3 0 1 2\n";
  nan.replace(nan.find("1 1 0 1"), 1, "nan");
  EXPECT_THAT(ply_error(nan), StartsWith("m.ply:13:1: x of vertex 2"));
  std::string binary_nan = binary_ply(false);
  const std::size_t first_vertex = binary_nan.find("end_header\n") + 11 + 5;
  const double bad = std::nan("");
  std::memcpy(binary_nan.data() + first_vertex, &bad, 8);
  EXPECT_THAT(ply_error(binary_nan),
              StartsWith("m.ply: byte " + std::to_string(first_vertex) + ": x of vertex 0"));
}

TEST(Ply, ImpossibleSizesAreRefusedBeforeMemoryIsTaken) {
  const std::string head = "ply\nformat binary_little_endian 1.0\nelement vertex ";
  const std::string tail = "\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
                           "property list uint int vertex_indices\nend_header\n";
  EXPECT_THAT(ply_error(head + "4294967295" + tail + "abcdefgh"),
              HasSubstr("more than the rest of the file"));
  EXPECT_THAT(ply_error(head + "99999999999999999999" + tail), HasSubstr("number of elements"));
  std::string list = head + "1" + tail + std::string(12, '\0');
  append<std::uint32_t>(list, 0xfffffff0u);
  EXPECT_THAT(ply_error(list + "abcdefgh"), HasSubstr("impossible"));
}

TEST(Serialized, FindsEachMeshOfAFile) {
  for (const std::uint16_t version : {std::uint16_t(3), std::uint16_t(4)})
    for (const bool doubles : {false, true})
      for (int k = 0; k < 3; ++k) {
        const SerializedMesh m = serialized(serialized_file(3, version, doubles), k);
        EXPECT_EQ(m.name, version == 4 ? "mesh" + std::to_string(k) : "");
        ASSERT_EQ(m.mesh.positions.size(), 3u);
        EXPECT_FLOAT_EQ(m.mesh.positions[2].z, static_cast<float>(k));
        EXPECT_FLOAT_EQ(m.mesh.positions[2].y, 1);
        EXPECT_EQ(m.mesh.normals.empty(), doubles);
        EXPECT_EQ(m.mesh.uvs.empty(), !doubles);
        EXPECT_EQ(m.face_normals, !doubles);
      }
}

TEST(Serialized, EveryTruncationOfAMeshIsAnError) {
  const std::string whole = serialized_mesh(0, 4, false);
  // The stream ends with zlib's checksum of 4 bytes, which comes after the last number.
  for (std::size_t n = 0; n + 5 < whole.size(); ++n)
    EXPECT_THROW(serialized(whole.substr(0, n)), Error) << n << " bytes of " << whole.size();
}

TEST(Serialized, ErrorsSayWhere) {
  const std::string file = serialized_file(2);
  const auto error = [](const std::string& bytes, int index) {
    return message_of([&] { serialized(bytes, index); });
  };
  EXPECT_THAT(error(file, 2), HasSubstr("there is no mesh of shape_index 2: the file has 2"));
  EXPECT_THAT(error(file, -1), HasSubstr("0 or more"));
  EXPECT_THAT(error("PK", 0), HasSubstr("byte 0"));
  std::string version = file;
  version[2] = 9;
  EXPECT_THAT(error(version, 0), HasSubstr("version 9"));
  std::string damaged = file;
  damaged[12] = static_cast<char>(damaged[12] ^ 0x55);
  damaged[20] = static_cast<char>(damaged[20] ^ 0x55);
  EXPECT_FALSE(error(damaged, 0).empty());
  std::string count = file;
  std::memset(count.data() + count.size() - 4, 0xff, 4);
  EXPECT_THAT(error(count, 1), HasSubstr("more than it can hold"));
}

TEST(Serialized, ImpossibleSizesAreRefusedBeforeMemoryIsTaken) {
  for (const std::uint64_t vertices : {std::uint64_t(1) << 31, std::uint64_t(1) << 40, ~std::uint64_t(0)}) {
    std::string body;
    append<std::uint32_t>(body, 0x1000);
    body += '\0';
    append<std::uint64_t>(body, vertices);
    append<std::uint64_t>(body, vertices > (std::uint64_t(1) << 32) ? vertices : 1);
    std::string file;
    append<std::uint16_t>(file, 0x041c);
    append<std::uint16_t>(file, 4);
    EXPECT_THROW(serialized(file + deflated(body)), Error) << vertices;
  }
}

TEST(Serialized, RealFileHasTheMeshesOfItsTable) {
  const std::string path =
      std::string(NACRE_SOURCE_DIR) + "/../shared/data/scenes/mitsuba/common/meshes/matpreview.serialized";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  for (int k = 0; k < 3; ++k) {
    const TriangleMesh mesh = read_serialized(path, k).mesh;
    EXPECT_GT(mesh.triangles.size(), 0u);
    for (const auto& n : mesh.normals)
      ASSERT_NEAR(length(n), 1, 1e-5);
  }
  EXPECT_THROW(read_serialized(path, 3), Error);
}

TEST(VertexNormals, OfACubeWithSharedCornersPointAlongTheDiagonals) {
  // The weights are angles, so the diagonal split of each face does not matter.
  TriangleMesh cube = cube_mesh(), shared;
  shared.positions = {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1},
                      {-1, -1, 1},  {1, -1, 1},  {-1, 1, 1},  {1, 1, 1}};
  for (const auto& t : cube.triangles) {
    std::array<std::uint32_t, 3> s{};
    for (int i = 0; i < 3; ++i) {
      const Vec3f p = cube.positions[t[i]];
      s[i] = (p.x > 0) + 2 * (p.y > 0) + 4 * (p.z > 0);
    }
    shared.triangles.push_back(s);
  }
  complete_vertex_normals(shared);
  for (std::size_t i = 0; i < 8; ++i)
    EXPECT_NEAR(dot(shared.normals[i], normalize(shared.positions[i])), 1, 1e-6) << i;
}

TEST(Cube, FacesPointOutwardsWithTheirNormals) {
  const TriangleMesh m = cube_mesh();
  EXPECT_EQ(m.triangles.size(), 12u);
  for (const auto& t : m.triangles) {
    const Vec3f n = cross(m.positions[t[1]] - m.positions[t[0]], m.positions[t[2]] - m.positions[t[0]]);
    for (const std::uint32_t i : t) {
      EXPECT_FLOAT_EQ(dot(n, m.normals[i]), 4); // twice the area of half a face
      EXPECT_GT(dot(m.positions[i], m.normals[i]), 0);
    }
  }
}

TEST(PlaceMesh, FacesAndNormalsAgreeUnderMirroringAndFlipping) {
  for (const double x : {2.0, -2.0})
    for (const bool flip : {false, true}) {
      TriangleMesh m = cube_mesh();
      place_mesh(m, Transform::translate({5, 0, 0}) * Transform::scale({x, 1, 1}), flip);
      for (const auto& t : m.triangles) {
        const Vec3f n = cross(m.positions[t[1]] - m.positions[t[0]], m.positions[t[2]] - m.positions[t[0]]);
        const Vec3f outwards = m.positions[t[0]] - Vec3f{5, 0, 0};
        EXPECT_GT(dot(n, m.normals[t[0]]), 0);
        EXPECT_EQ(dot(n, outwards) < 0, flip);
        EXPECT_NEAR(length(m.normals[t[0]]), 1, 1e-6);
      }
    }
}

TEST(PlaceMesh, RefusesWhatLeavesFloat) {
  TriangleMesh m = cube_mesh();
  EXPECT_THROW(place_mesh(m, Transform::scale({1e39, 1, 1}), false), Error);
}

} // namespace
} // namespace nacre

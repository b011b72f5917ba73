#include "core/error.h"
#include "core/scratch_folder.h"
#include "mesh_bytes.h"
#include "scene/mesh.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace nacre {
namespace {

using testing::HasSubstr;

/// Four corners of a square in z = 0, and two triangles of 16-bit indices: 48 + 12 bytes.
std::string square_bytes() {
  std::string bytes;
  for (const Vec2f& p : {Vec2f{0, 0}, Vec2f{1, 0}, Vec2f{1, 1}, Vec2f{0, 1}})
    for (const float x : {p.x, p.y, 0.0f})
      append(bytes, x);
  for (const std::uint16_t i : {0, 1, 2, 0, 2, 3})
    append(bytes, i);
  return bytes;
}

std::string square_json(const std::string& node, const std::string& buffer, int index_count = 6) {
  return fmt::format(
      R"({{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{}],
    "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}],
    "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}},
                  {{"bufferView": 1, "componentType": 5123, "count": {}, "type": "SCALAR"}}],
    "bufferViews": [{{"buffer": 0, "byteLength": 48}}, {{"buffer": 0, "byteOffset": 48, "byteLength": 12}}],
    "buffers": [{{"byteLength": 60{}}}]}})",
      node, index_count, buffer);
}

std::string glb(std::string text, std::string bytes) {
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string file = "glTF";
  append<std::uint32_t>(file, 2);
  append<std::uint32_t>(file, std::uint32_t(28 + text.size() + bytes.size()));
  append<std::uint32_t>(file, std::uint32_t(text.size()));
  file += "JSON" + text;
  append<std::uint32_t>(file, std::uint32_t(bytes.size()));
  return file + std::string("BIN\0", 4) + bytes;
}

TEST(Gltf, BufferBesideItAndInsideAreTheSameMesh) {
  const ScratchFolder folder;
  folder.write("square.bin", square_bytes());
  const std::string node = R"({"mesh": 0})";
  const TriangleMesh a = read_gltf(folder.write("a.gltf", square_json(node, R"(, "uri": "square.bin")"))),
                     b = read_gltf(folder.write("b.glb", glb(square_json(node, ""), square_bytes())));
  ASSERT_EQ(a.positions.size(), 4u);
  EXPECT_EQ(a.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(a.positions[2].x, 1);
  EXPECT_EQ(a.positions[2].y, 1);
  EXPECT_TRUE(a.normals.empty());
  EXPECT_EQ(a.triangles, b.triangles);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(length(a.positions[i] - b.positions[i]), 0);
}

TEST(Gltf, NodesPlaceItAndMirrorsTurnItsFaces) {
  const ScratchFolder folder;
  // Scaled by 2, turned by 90 degrees about z, moved by 10 along x: (1, 0) goes to (10, 2).
  const TriangleMesh turned =
      read_gltf(folder.write("a.glb", glb(square_json(R"({"children": [1], "translation": [10, 0, 0]},
                         {"mesh": 0, "scale": [2, 2, 2], "rotation": [0, 0, 0.70710678, 0.70710678]})",
                                                      ""),
                                          square_bytes())));
  EXPECT_NEAR(turned.positions[1].x, 10, 1e-6);
  EXPECT_NEAR(turned.positions[1].y, 2, 1e-6);
  const TriangleMesh moved = read_gltf(folder.write(
      "b.glb", glb(square_json(R"({"mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 5,6,7,1]})", ""),
                   square_bytes())));
  EXPECT_NEAR(moved.positions[2].z, 7, 1e-6);
  EXPECT_NEAR(moved.positions[2].y, 7, 1e-6);
}

TEST(Gltf, DamagedFilesAreErrors) {
  const ScratchFolder folder;
  const auto error = [&](const std::string& bytes) {
    const std::string path = folder.write("x.glb", bytes);
    return message_of([&] { read_gltf(path); });
  };
  const std::string node = R"({"mesh": 0})", whole = glb(square_json(node, ""), square_bytes());
  for (std::size_t n = 0; n < whole.size(); n += 7)
    EXPECT_FALSE(error(whole.substr(0, n)).empty()) << "of the first " << n << " bytes";
  EXPECT_THAT(error(glb(square_json(node, "", 7), square_bytes())), HasSubstr("leaves its view"));
  EXPECT_THAT(error(glb(square_json(node, "", 2000000000), square_bytes())), HasSubstr("claims"));
  EXPECT_THAT(error(glb(square_json(R"({"mesh": 3})", ""), square_bytes())), HasSubstr("no entry 3"));
  EXPECT_THAT(error(glb(square_json(R"({"children": [0]})", ""), square_bytes())), HasSubstr("without end"));
  EXPECT_THAT(error("{}"), HasSubstr("asset"));
  std::string far = square_bytes();
  far[48] = 9;
  EXPECT_THAT(error(glb(square_json(node, ""), far)), HasSubstr("index 9"));
}

} // namespace
} // namespace nacre

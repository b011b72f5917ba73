// Scenes that do not work: status 1, one line with file, line and column, and no picture.

#include "run_command.h"
#include "small_input.h"

namespace nacre {
namespace {

/// Rendering `scene` fails with `parts` in its message and writes nothing.
void expect_refused(const ScratchFolder& folder, const std::string& scene,
                    const std::vector<std::string>& parts) {
  const std::vector<std::string> before = folder.contents();
  expect_failure(1, {"render", scene, "-o", folder / "out.exr", "--spp", "1"}, parts);
  EXPECT_EQ(folder.contents(), before);
}

std::string mesh_shape(const std::string& type, const std::string& file) {
  return "<shape type='" + type + "'><string name='filename' value='" + file + "'/></shape>";
}

TEST(BadScene, AMissingMeshIsNamedAtItsLineWithTheNearestName) {
  const ScratchFolder folder;
  write(folder, "teapot.obj", "v 0 0 0\n");
  const std::string scene = scene_of(folder, mesh_shape("obj", "taepot.obj"));
  expect_refused(folder, scene, {"scene.xml:4:", "taepot.obj: no such file", "did you mean 'teapot.obj'?"});
  expect_refused(folder, scene_of(folder, mesh_shape("ply", "nowhere.ply")), {"scene.xml:4:", "nowhere.ply"});
  expect_refused(folder, scene_of(folder, mesh_shape("serialized", "x.serialized")), {"scene.xml:4:"});
}

TEST(BadScene, ADirectoryAsMeshOrSceneIsSaidToBe) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "mesh.obj");
  std::filesystem::create_directory(folder / "folder.xml");
  expect_refused(folder, scene_of(folder, mesh_shape("obj", "mesh.obj")),
                 {"scene.xml:4:", "mesh.obj: is a directory, expected a file"});
  expect_refused(folder, folder / "folder.xml", {"folder.xml: is a directory, expected a file"});
  expect_refused(folder, folder / "missing.xml", {"missing.xml: no such file"});
}

TEST(BadScene, AnUnknownPluginIsNamedWithTheNearest) {
  const ScratchFolder folder;
  expect_refused(folder, scene_of(folder, "<shape type='sphere'>\n<bsdf type='difuse'/></shape>"),
                 {"scene.xml:5:7", "bsdf 'difuse' is not supported", "did you mean 'diffuse'?"});
  expect_refused(folder, scene_of(folder, "<shape type='spherre'/>"),
                 {"scene.xml:4:8", "did you mean 'sphere'?"});
  expect_refused(folder, scene_of(folder, "<integrator type='bdpt'/>"), {"scene.xml:4:13", "'bdpt'", "path"});
  expect_refused(folder, scene_of(folder, "<emitter type='pont'/>"),
                 {"scene.xml:4:10", "did you mean 'point'?"});
}

TEST(BadScene, AMisspeltParameterIsNamedWithTheNearest) {
  const ScratchFolder folder;
  expect_refused(folder, scene_of(folder, "<shape type='sphere'><float name='radios' value='1'/></shape>"),
                 {"scene.xml:4:", "'radios'", "did you mean 'radius'?"});
}

TEST(BadScene, AMalformedNumberIsShownAtItsColumn) {
  const ScratchFolder folder;
  const auto radius = [&](const std::string& value) {
    return scene_of(folder, "<shape type='sphere'><float name='radius' value='" + value + "'/></shape>");
  };
  expect_refused(folder, radius("1.x"), {"scene.xml:4:43", "expected a number, found '1.x'"});
  expect_refused(folder, radius("nan"), {"scene.xml:4:43", "finite", "'nan'"});
  expect_refused(folder, radius(""), {"scene.xml:4:43"});
  expect_refused(folder, radius("1e400"), {"scene.xml:4:43"});
  expect_refused(folder, radius("0"), {"scene.xml:4:", "radius"});
  expect_refused(folder,
                 scene_of(folder, "<shape type='sphere'><transform name='to_world'><translate x='1e300'/>"
                                  "</transform></shape>"),
                 {"scene.xml:4:", "to_world", "1e+18"});
}

TEST(BadScene, AValueOutsideItsDomainIsNamedAtItsPlace) {
  const ScratchFolder folder;
  const auto bsdf = [&](const std::string& type, const std::string& inside) {
    return scene_of(folder, "<shape type='sphere'>\n<bsdf type='" + type + "'>" + inside + "</bsdf></shape>");
  };
  expect_refused(folder, bsdf("roughconductor", "<float name='alpha' value='7'/>"),
                 {"scene.xml:5:", "[0.001, 1]", "7"});
  expect_refused(folder, bsdf("roughconductor", "<float name='alpha' value='-1'/>"),
                 {"scene.xml:5:", "alpha"});
  expect_refused(folder, bsdf("dielectric", "<float name='int_ior' value='1000'/>"), {"scene.xml:5:"});
  expect_refused(folder, bsdf("diffuse", "<rgb name='reflectance' value='2,2,2'/>"),
                 {"scene.xml:5:", "[0, 1]"});
}

TEST(BadScene, VerticesThatAreNoNumbersAreNamedInTheMesh) {
  const ScratchFolder folder;
  write(folder, "nan.obj", "v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n");
  write(folder, "nan.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
        "end_header\n0 0 0\n1 0 0\nnan 1 0\n3 0 1 2\n");
  std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::size_t vertices = binary.size();
  binary += std::string(36, '\0') + std::string("\3\0\0\0\0\1\0\0\0\2\0\0\0", 13);
  const float nan = std::nanf("");
  std::memcpy(binary.data() + vertices + 16, &nan, sizeof nan); // y of vertex 1
  write(folder, "binary.ply", binary);
  expect_refused(folder, scene_of(folder, mesh_shape("obj", "nan.obj")), {"nan.obj:3:3", "finite"});
  expect_refused(folder, scene_of(folder, mesh_shape("ply", "nan.ply")), {"nan.ply:12:1", "vertex 2"});
  expect_refused(folder, scene_of(folder, mesh_shape("ply", "binary.ply")),
                 {"binary.ply: byte ", "vertex 1"});
}

TEST(BadScene, ABrokenMeshIsNamedWithThePlace) {
  const ScratchFolder folder;
  for (const char* type : {"obj", "ply", "serialized"}) {
    write(folder, std::string("empty.") + type, "");
    expect_refused(folder, scene_of(folder, mesh_shape(type, std::string("empty.") + type)),
                   {"empty." + std::string(type)});
  }
  write(folder, "huge.ply",
        "ply\nformat binary_little_endian 1.0\nelement vertex 2147483647\nproperty float x\n"
        "property float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\n"
        "end_header\n0000");
  expect_refused(folder, scene_of(folder, mesh_shape("ply", "huge.ply")), {"huge.ply: byte ", "2147483647"});
  write(folder, "index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
  expect_refused(folder, scene_of(folder, mesh_shape("obj", "index.obj")), {"index.obj:4:"});
  write(folder, "number.obj", "v 0 0 0\nv 1 0 zero\n");
  expect_refused(folder, scene_of(folder, mesh_shape("obj", "number.obj")), {"number.obj:2:", "'zero'"});
}

TEST(BadScene, ATruncatedTableOrTextureIsNamedWithTheByte) {
  const ScratchFolder folder;
  truncated(folder, small_table(folder), "cut.binary", 1000);
  truncated(folder, small_picture(folder, "whole.exr"), "cut.exr", 400);
  expect_refused(folder,
                 scene_of(folder, "<shape type='sphere'><bsdf type='merl'><string name='filename' "
                                  "value='cut.binary'/></bsdf></shape>"),
                 {"cut.binary: byte 1000", "24588"});
  expect_refused(
      folder, scene_of(folder, "<emitter type='envmap'><string name='filename' value='cut.exr'/></emitter>"),
      {"cut.exr: byte "});
}

TEST(BadScene, TextThatIsNoSceneIsNamedWithThePlace) {
  const ScratchFolder folder;
  expect_refused(folder, write(folder, "a.xml", ""), {"a.xml:1:1"});
  expect_refused(folder, write(folder, "b.xml", "<html></html>"), {"b.xml:1:", "<scene>", "<html>"});
  expect_refused(folder, write(folder, "c.xml", "<scene version='3.0.0'>\n<shape type='sphere'>\n"),
                 {"c.xml:"});
  expect_refused(folder, write(folder, "d.txt", scene_text()), {"d.txt", ".xml"});
  expect_refused(folder, "/dev/null", {"/dev/null", ".xml"});
  expect_refused(folder, "", {"''"});
}

// The many includes would be 4^14 files, the deep elements would overflow a recursive reader's stack.
TEST(BadScene, BombsAreRefusedQuickly) {
  const ScratchFolder folder;
  const std::string head = "<scene version='3.0.0'>\n";
  expect_refused(folder, write(folder, "self.xml", head + "<include filename='self.xml'/></scene>"),
                 {"self.xml:2:10", "includes itself"});
  write(folder, "ping.xml", head + "<include filename='pong.xml'/></scene>");
  expect_refused(folder, write(folder, "pong.xml", head + "<include filename='ping.xml'/></scene>"),
                 {"ping.xml:2:10", "includes itself"});
  for (int i = 0; i < 14; ++i) {
    std::string text = head;
    for (int j = 0; j < 4; ++j)
      text += "<include filename='many" + std::to_string(i + 1) + ".xml'/>";
    write(folder, "many" + std::to_string(i) + ".xml", text + "</scene>");
  }
  write(folder, "many14.xml", head + "</scene>");
  expect_refused(folder, folder / "many0.xml", {"more than 1000 files"});
  std::string deep = "<shape type='sphere'>";
  for (int i = 0; i < 100000; ++i)
    deep += "<bsdf type='twosided'>";
  for (int i = 0; i < 100000; ++i)
    deep += "</bsdf>";
  expect_refused(folder, scene_of(folder, deep + "</shape>"), {"scene.xml:4:", "nested more than 64 deep"});
}

TEST(BadScene, AFilmOfNoSizeOrOfTooMuchIsRefused) {
  const ScratchFolder folder;
  const auto film = [&](const std::string& width, const std::string& height) {
    SceneParts parts;
    parts.film =
        "\n<integer name='width' value='" + width + "'/><integer name='height' value='" + height + "'/>";
    return small_scene(folder, parts);
  };
  for (const char* width : {"0", "-3", "1000000000"})
    expect_refused(folder, film(width, "16"),
                   {"scene.xml:3:", "'width' must lie in [1, 65536]", "found " + std::string(width)});
  expect_refused(folder, film("99999999999999999999", "16"), {"scene.xml:3:", "expected an integer"});
  expect_refused(folder, film("65536", "65536"), {"65536 x 65536", "GB of memory"});
  for (const char* samples : {"0", "-4", "1000000000000"}) {
    SceneParts parts;
    parts.samples = samples;
    // --spp on the command line does not hide that the scene is wrong.
    expect_refused(folder, small_scene(folder, parts), {"scene.xml:2:"});
  }
}

TEST(BadScene, ASceneWithoutSensorHasADefaultOneAndSaysSo) {
  const ScratchFolder folder;
  const std::string scene =
      write(folder, "a.xml", "<scene version='3.0.0'><emitter type='constant'/></scene>");
  const Outcome o = expect_success({"render", scene, "-o", folder / "a.exr", "--spp", "1", "--quiet"});
  EXPECT_NE(o.err.find("a.xml:1:2: the scene has no sensor"), std::string::npos) << o.err;
  expect_failure(1, {"render", scene, "-o", folder / "b.exr", "--strict"}, {"a.xml:1:2", "no sensor"});
}

} // namespace
} // namespace nacre

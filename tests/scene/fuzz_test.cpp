#include "core/error.h"
#include "mesh_bytes.h"
#include "scene/mesh.h"
#include "scene/mitsuba.h"

#include <functional>
#include <random>

#include <gtest/gtest.h>

namespace nacre {
namespace {

/// Changes, removes, repeats and inserts a few bytes, now and then ones that mean something.
std::string mutated(std::string text, std::mt19937& random) {
  static const std::string tokens[] = {
      "-1", "nan", "1e999", "99999999999",   "'",  "\"",   "<", "/>", "$", "#", "\n", " ", "\\",
      "//", "&",   "id",    "<ref id='a'/>", "\0", "\xff", "0"};
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  const std::size_t changes = 1 + below(4);
  for (std::size_t i = 0; i < changes && !text.empty(); ++i) {
    const std::size_t at = below(text.size());
    switch (below(6)) {
    case 0:
      text[at] = static_cast<char>(below(256));
      break;
    case 1:
      text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
      break;
    case 2:
      text.erase(at, 1 + below(8));
      break;
    case 3:
      text.insert(at, text.substr(at, 1 + below(40)));
      break;
    case 4:
      text.insert(at, tokens[below(std::size(tokens))]);
      break;
    case 5:
      text.resize(at);
      break;
    }
  }
  return text;
}

/// Only nacre::Error may come out, and some mutations must still be read: else the test tests nothing.
void fuzz(const std::string& seed, int count, const std::function<void(const std::string&)>& read) {
  std::mt19937 random(20240501);
  ASSERT_NO_THROW(read(seed));
  int accepted = 0;
  for (int i = 0; i < count; ++i) {
    const std::string text = mutated(seed, random);
    try {
      read(text);
      ++accepted;
    } catch (const Error& e) {
      ASSERT_FALSE(std::string(e.what()).empty());
    } catch (const std::exception& e) {
      FAIL() << "mutation " << i << " gives " << e.what();
    }
  }
  EXPECT_GT(accepted, 0);
  EXPECT_LT(accepted, count);
}

TEST(Fuzz, ObjReaderThrowsErrorsAlone) {
  const std::string seed = "# m\no a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\nvt 0 0\nvt 1 1\nvn 0 0 1\n"
                           "f 1/1/1 2/2/1 3/1/1 4/2/1\nf -1 -2 -3\n";
  fuzz(seed, 4000, [](const std::string& text) {
    for (const auto& t : parse_obj(text, "f").triangles)
      ASSERT_TRUE(t[0] < 64 && t[1] < 64 && t[2] < 64);
  });
}

TEST(Fuzz, PlyReaderThrowsErrorsAlone) {
  const auto read = [](const std::string& text) {
    const TriangleMesh m = parse_ply(bytes_of(text), "f");
    for (const auto& t : m.triangles)
      for (const std::uint32_t i : t)
        ASSERT_LT(i, m.positions.size());
  };
  fuzz(binary_ply(false), 2000, read);
  fuzz(binary_ply(true), 1000, read);
  fuzz("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
       "element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
       2000, read);
}

TEST(Fuzz, SerializedReaderThrowsErrorsAlone) {
  const auto read = [](int index) {
    return [index](const std::string& text) {
      const TriangleMesh m = parse_serialized(bytes_of(text), index, "f").mesh;
      for (const auto& t : m.triangles)
        for (const std::uint32_t i : t)
          ASSERT_LT(i, m.positions.size());
    };
  };
  fuzz(serialized_file(3, 4, false), 1500, read(0));
  fuzz(serialized_file(3, 4, true), 1500, read(2));
  fuzz(serialized_file(2, 3, false), 1000, read(1));
  // The same with the compression undone and done again, so that mutations reach what is inside.
  std::string inside;
  append<std::uint32_t>(inside, 0x1000);
  inside += std::string("m") + '\0';
  append<std::uint64_t>(inside, 3);
  append<std::uint64_t>(inside, 1);
  for (int i = 0; i < 9; ++i)
    append<float>(inside, static_cast<float>(i * i));
  for (std::uint32_t i = 0; i < 3; ++i)
    append<std::uint32_t>(inside, i);
  fuzz(inside, 3000, [&](const std::string& text) {
    std::string file;
    append<std::uint16_t>(file, 0x041c);
    append<std::uint16_t>(file, 4);
    read(0)(file + deflated(text));
  });
}

TEST(Fuzz, MitsubaReaderThrowsErrorsAlone) {
  const std::string seed = R"(<scene version="3.0.0"><default name="spp" value="16"/>
    <integrator type="path"><integer name="max_depth" value="6"/></integrator>
    <sensor type="perspective"><float name="fov" value="40"/><transform name="to_world">
      <scale x="-1"/><lookat origin="0, 1, 2" target="0 0 0" up="0 1 0"/></transform>
      <film type="hdrfilm"><integer name="width" value="64"/><rfilter type="box"/></film>
      <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler></sensor>
    <texture type="checkerboard" id="t"><transform name="to_uv"><scale x="5" y="5"/></transform></texture>
    <bsdf type="twosided" id="a"><bsdf type="diffuse"><ref name="reflectance" id="t"/></bsdf></bsdf>
    <bsdf type="mask" id="b"><float name="opacity" value="0.5"/><bsdf type="roughconductor">
      <string name="material" value="Au"/><float name="alpha" value="0.2"/></bsdf></bsdf>
    <shape type="sphere"><point name="center" x="1" y="0" z="0"/><ref id="a"/><emitter type="area">
      <spectrum name="radiance" value="400:1, 500:2, 600:3"/></emitter></shape>
    <shape type="shapegroup" id="g"><shape type="cube"><ref id="b"/></shape></shape>
    <shape type="instance"><ref id="g"/><transform name="to_world"><rotate y="1" angle="45"/></transform></shape>
    <emitter type="point"><point name="position" value="1 2 3"/><rgb name="intensity" value="0.3"/></emitter></scene>)";
  fuzz(seed, 4000, [](const std::string& text) { parse_mitsuba_scene(text, "f.xml"); });
}

} // namespace
} // namespace nacre

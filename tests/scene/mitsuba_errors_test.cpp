#include "scene/reader.h"
#include "small_scene.h"

#include <gmock/gmock.h>

namespace nacre {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(MitsubaErrors, SayFileLineAndColumn) {
  const std::string text = "<scene version='3.0.0'>\n  <shape type='sphere'>\n    <float name='radius'\n"
                           "      value='two'/>\n  </shape>\n</scene>";
  EXPECT_THAT(message_of([&] { parse_mitsuba_scene(text, "dir/s.xml"); }),
              StartsWith("dir/s.xml:4:7: expected a number, found 'two'"));
  EXPECT_THAT(message_of([&] { parse_mitsuba_scene("<scene version='3.0.0'>\n<shape", "s.xml"); }),
              StartsWith("s.xml:2:"));
  EXPECT_THAT(message_of([&] { parse_mitsuba_scene("", "s.xml"); }), HasSubstr("not well-formed XML"));
  EXPECT_THAT(message_of([&] { parse_mitsuba_scene("<mesh/>", "s.xml"); }), HasSubstr("expected <scene>"));
  EXPECT_THAT(message_of([&] { parse_mitsuba_scene("<scene version='4.0.0'/>", "s.xml"); }),
              HasSubstr("versions up to 3"));
}

TEST(MitsubaErrors, UnknownNamesComeWithTheNearest) {
  EXPECT_THAT(error("<bsdf type='difuse' id='a'/>"), HasSubstr("did you mean 'diffuse'?"));
  EXPECT_THAT(error("<bsdf type='irawan' id='a'/>"), HasSubstr("known: diffuse, conductor"));
  EXPECT_THAT(error("<shape type='sphere'><float name='radios' value='2'/></shape>"),
              HasSubstr("shape 'sphere' has no parameter 'radios' (did you mean 'radius'?)"));
  EXPECT_THAT(error("<bsdf type='diffuse' id='grey'/><shape type='sphere'><ref id='gray'/></shape>"),
              HasSubstr("did you mean 'grey'?"));
  EXPECT_THAT(error("<shap type='sphere'/>"), HasSubstr("unknown element <shap> (did you mean 'shape'?)"));
  EXPECT_THAT(error("<shape type='sphere'><float nmae='radius' value='2'/></shape>"),
              HasSubstr("did you mean 'name'?"));
  EXPECT_THAT(error("<bsdf type='conductor' id='a'><string name='material' value='al'/></bsdf>"),
              HasSubstr("'Al'"));
  EXPECT_THAT(error("<bsdf type='dielectric' id='a'><string name='int_ior' value='watr'/></bsdf>"),
              HasSubstr("did you mean 'water'?"));
  EXPECT_THAT(error("<integrator type='ptracer'/>"), HasSubstr("known: path, direct"));
  EXPECT_THAT(error("<bsdf type='roughconductor' id='a'><string name='distribution' value='phong'/></bsdf>"),
              HasSubstr("known: beckmann, ggx"));
}

TEST(MitsubaErrors, UnsupportedFeaturesAreNamed) {
  EXPECT_THAT(error("<bsdf type='null' id='a'/>"), HasSubstr("'null' is not supported"));
  EXPECT_THAT(error("<sensor type='thinlens'/>", {{}, {}, true}), HasSubstr("more than one sensor"));
  EXPECT_THAT(message_of([] {
                parse_mitsuba_scene("<scene version='3.0.0'><sensor type='thinlens'/></scene>", "s.xml");
              }),
              HasSubstr("'thinlens' is not supported"));
  EXPECT_THAT(message_of([] {
                parse_mitsuba_scene(
                    "<scene version='3.0.0'><sensor type='perspective'><film type='hdrfilm'><integer "
                    "name='crop_width' value='3'/></film></sensor></scene>",
                    "s.xml");
              }),
              HasSubstr("cropped film"));
  const std::string checks = "type='checkerboard'/>";
  EXPECT_THAT(error("<emitter type='spot'><rgb name='texture' value='1'/></emitter>"),
              HasSubstr("'texture' must be a texture, found <rgb>"));
  EXPECT_THAT(error("<emitter type='spot'><float name='cutoff_angle' value='90'/><texture name='texture' " +
                    checks + "</emitter>"),
              HasSubstr("below 90 degrees"));
  EXPECT_THAT(error("<emitter type='projector'/>"), HasSubstr("'irradiance'"));
  EXPECT_THAT(error("<emitter type='projector'><rgb name='irradiance' value='1'/></emitter>"),
              HasSubstr("must be a texture, found <rgb>"));
  const std::string projector = "<emitter type='projector'><texture name='irradiance' " + checks;
  EXPECT_THAT(error(projector + "<transform name='to_world'><scale value='2'/></transform></emitter>"),
              HasSubstr("not scaled or sheared"));
  EXPECT_THAT(error(projector + "<float name='scale' value='-1'/></emitter>"), HasSubstr("negative"));
  EXPECT_THAT(error("<emitter type='point'><texture name='intensity' " + checks + "</emitter>"),
              HasSubstr("a texture cannot be used here"));
  EXPECT_THAT(error("<medium type='homogeneous' id='m'/>"), HasSubstr("media"));
  EXPECT_THAT(error("<shape type='sphere'><transform name='to_world'><scale x='2'/></transform></shape>"),
              HasSubstr("stretch or shear"));
}

TEST(MitsubaErrors, ContradictionsAreFound) {
  EXPECT_THAT(error("<bsdf type='diffuse' id='a'/>\n<bsdf type='diffuse' id='a'/>"),
              HasSubstr("the id 'a' is taken: see s.xml:1:"));
  EXPECT_THAT(
      error("<shape type='sphere'><float name='radius' value='1'/><float name='radius' value='2'/></shape>"),
      HasSubstr("given twice"));
  EXPECT_THAT(error("<shape type='sphere' type='cube'/>"), HasSubstr("given twice"));
  EXPECT_THAT(error("<shape type='sphere'><bsdf type='diffuse'/><bsdf type='plastic'/></shape>"),
              HasSubstr("more than one bsdf"));
  EXPECT_THAT(error("<emitter type='area' id='e'/>"), HasSubstr("belongs into a shape"));
  EXPECT_THAT(error("<bsdf type='twosided' id='a'><bsdf type='dielectric'/></bsdf>"), HasSubstr("transmits"));
  EXPECT_THAT(error("<bsdf type='diffuse' id='a'><bsdf type='diffuse'/></bsdf>"), HasSubstr("nested <bsdf>"));
  EXPECT_THAT(error("<shape type='sphere'>stray</shape>"), HasSubstr("found text 'stray'"));
}

TEST(MitsubaErrors, ValuesOutsideTheirDomainAreRefused) {
  const auto diffuse = [](const std::string& inside) {
    return error("<bsdf type='diffuse' id='a'>" + inside + "</bsdf>");
  };
  EXPECT_THAT(diffuse("<rgb name='reflectance' value='2 0 0'/>"), StartsWith("s.xml:1:"));
  EXPECT_THAT(diffuse("<rgb name='reflectance' value='nan'/>"), HasSubstr("finite"));
  EXPECT_THAT(diffuse("<rgb name='reflectance' value='0.1 0.2'/>"), HasSubstr("one or three"));
  EXPECT_THAT(diffuse("<spectrum name='reflectance' value='500:1, 400:1'/>"), StartsWith("s.xml:1:"));
  EXPECT_THAT(diffuse("<spectrum name='reflectance' value='400:1, 500'/>"), HasSubstr("'500'"));
  EXPECT_THAT(diffuse("<string name='reflectance' value='red'/>"), HasSubstr("found <string>"));
  EXPECT_THAT(error("<shape type='sphere'><float name='radius' value='0'/></shape>"),
              HasSubstr("must not be 0"));
  EXPECT_THAT(
      error("<shape type='rectangle'><transform name='to_world'><scale value='0'/></transform></shape>"),
      HasSubstr("singular"));
  EXPECT_THAT(error("<shape type='disk'><transform name='to_world'><rotate angle='5'/></transform></shape>"),
              HasSubstr("axis"));
  EXPECT_THAT(
      error("<shape type='disk'><transform name='to_world'><matrix value='1 2 3'/></transform></shape>"),
      HasSubstr("16 or 9"));
  EXPECT_THAT(error("<integrator type='path'><integer name='max_depth' value='2.5'/></integrator>"),
              HasSubstr("an integer"));
  EXPECT_THAT(error("<integrator type='path'><boolean name='hide_emitters' value='yes'/></integrator>"),
              HasSubstr("true or false"));
  EXPECT_THAT(error("<emitter type='sky'><float name='turbidity' value='99'/></emitter>"),
              HasSubstr("turbidity"));
}

TEST(MitsubaErrors, LoopsEnd) {
  EXPECT_THAT(
      error("<bsdf type='twosided' id='a'><ref id='b'/></bsdf><bsdf type='mask' id='b'><ref id='a'/></bsdf>"),
      HasSubstr("refers to itself"));
  const ScratchFolder folder;
  const std::string a = folder.write("a.xml", "<scene version='3.0.0'><include filename='b.xml'/></scene>");
  folder.write("b.xml", "<scene version='3.0.0'>\n <include filename='./a.xml'/></scene>");
  EXPECT_THAT(message_of([&] { read_scene(a); }),
              StartsWith(folder / "b.xml" + ":2:11: the file includes itself"));
  // Many short files that include the next twice would make 2^n elements.
  for (int i = 0; i < 14; ++i) {
    std::string name = "n";
    name += std::to_string(i) + ".xml";
    std::string next = "<include filename='n";
    next += std::to_string(i + 1) + ".xml'/>";
    folder.write(name, "<scene version='3.0.0'>" + next + next + "</scene>");
  }
  folder.write("n14.xml", "<scene version='3.0.0'/>");
  EXPECT_THAT(message_of([&] { read_scene(folder / "n0.xml"); }), HasSubstr("more than 1000 files"));
}

TEST(MitsubaErrors, DepthIsBounded) {
  std::string open, close;
  for (int i = 0; i < 100000; ++i) {
    open += "<bsdf type='twosided'>";
    close += "</bsdf>";
  }
  EXPECT_THAT(error(open + close), HasSubstr("more than 64 deep"));
  std::string chain;
  for (int i = 0; i < 1000; ++i)
    chain += "<bsdf type='twosided' id='m" + std::to_string(i) + "'><ref id='m" + std::to_string(i + 1) +
             "'/></bsdf>";
  EXPECT_THAT(error(chain + "<bsdf type='diffuse' id='m1000'/>"), HasSubstr("more than 64 deep"));
}

TEST(MitsubaErrors, MissingFilesAndFoldersAreTold) {
  const ScratchFolder folder;
  EXPECT_THAT(message_of([&] { read_scene(folder / "none.xml"); }), HasSubstr("none.xml"));
  EXPECT_THAT(message_of([&] { read_mitsuba_scene(folder.path()); }), HasSubstr(folder.path()));
  EXPECT_THAT(message_of([&] { read_scene(folder / "scene.gltf"); }), HasSubstr(".xml (Mitsuba)"));
  EXPECT_THAT(error("<bsdf type='merl' id='a'><string name='filename' value='no.binary'/></bsdf>"),
              HasSubstr("no.binary"));
  EXPECT_THAT(error("<bsdf type='merl' id='a'/>"), HasSubstr("lacks the parameter 'filename'"));
  EXPECT_THAT(error("<path value='no/such/folder'/>"), HasSubstr("no folder"));
}

} // namespace
} // namespace nacre

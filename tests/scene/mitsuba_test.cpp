#include "bsdf/list.h"
#include "core/error.h"
#include "core/image.h"
#include "core/scratch_folder.h"
#include "mesh_bytes.h"
#include "scene/mitsuba.h"
#include "scene/reader.h"
#include "small_scene.h"
#include "spectra/ior.h"

#include <gmock/gmock.h>

namespace nacre {
namespace {

using testing::HasSubstr;

Material material(const std::string& bsdf) {
  const Scene scene = parse("<shape type='rectangle'>" + bsdf + "</shape>");
  return scene.materials.at(static_cast<std::size_t>(scene.shapes.at(0).material));
}
/// The parameter of that name of a material's first lobe.
ParameterSource parameter(const Material& m, const std::string& name) {
  const auto& all = find_model(m.lobes.at(0).model).parameters;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].name == name) return m.lobes[0].parameters.at(i);
  throw Error("no parameter " + name);
}
float number(const Material& m, const std::string& name) { return std::get<float>(parameter(m, name)); }
SpectrumSource spectrum(const Material& m, const std::string& name) {
  return std::get<SpectrumSource>(parameter(m, name));
}

TEST(Mitsuba, CameraFilmSamplerAndIntegratorAreRead) {
  const Scene s = parse_mitsuba_scene(R"(<scene version="3.0.0">
    <integrator type="moment"><integrator type="path"><integer name="max_depth" value="7"/>
      <integer name="rr_depth" value="9"/></integrator></integrator>
    <sensor type="perspective">
      <float name="fov" value="33"/><string name="fov_axis" value="smaller"/>
      <float name="near_clip" value="1"/><float name="far_clip" value="50"/><float name="focus_distance" value="3"/>
      <transform name="to_world"><lookat origin="1, 2, 3" target="1 2 4" up="0 1 0"/></transform>
      <film type="hdrfilm"><integer name="width" value="320"/><integer name="height" value="200"/>
        <string name="pixel_format" value="rgb"/><rfilter type="tent"/></film>
      <sampler type="multijitter"><integer name="sample_count" value="64"/></sampler>
    </sensor></scene>)",
                                      "s.xml");
  EXPECT_EQ(s.integrator.name, "path");
  EXPECT_EQ(s.integrator.max_depth, 7);
  EXPECT_EQ(s.integrator.russian_roulette_depth, 9);
  EXPECT_EQ(s.camera.fov_deg, 33);
  EXPECT_EQ(s.camera.fov_axis, Camera::FovAxis::smaller);
  EXPECT_EQ(s.camera.near_clip, 1);
  EXPECT_NEAR(s.camera.to_world.point({0, 0, 1}).z, 4, 1e-12);
  EXPECT_EQ(s.film.width, 320);
  EXPECT_EQ(s.film.filter, FilterKind::tent);
  EXPECT_EQ(s.sampler, "sobol");
  EXPECT_EQ(s.samples_per_pixel, 64);
  EXPECT_TRUE(s.warnings.empty());
}

TEST(Mitsuba, WithoutAFieldOfViewTheLensIsFiftyMillimetres) {
  const Camera c = parse("").camera;
  EXPECT_EQ(c.fov_axis, Camera::FovAxis::diagonal);
  EXPECT_NEAR(c.fov_deg, 46.793, 1e-3); // 2 atan(43.267 / 100)
}

TEST(Mitsuba, TransformsApplyInTheOrderWritten) {
  const Scene s =
      parse("<shape type='disk'><transform name='to_world'><scale value='2'/><rotate z='1' angle='90'/>"
            "<translate x='1'/><matrix value='1 0 0 0 0 1 0 0 0 0 1 5 0 0 0 1'/></transform></shape>");
  const Vec3d p = std::get<Disk>(s.shapes[0].geometry).to_world.point({1, 0, 0});
  EXPECT_NEAR(p.x, 1, 1e-12);
  EXPECT_NEAR(p.y, 2, 1e-12);
  EXPECT_NEAR(p.z, 5, 1e-12);
}

TEST(Mitsuba, DiffuseTakesEveryKindOfColour) {
  EXPECT_FLOAT_EQ(spectrum(material(""), "reflectance").eval(500), 0.5f);
  const auto reflectance = [](const std::string& inside) {
    return spectrum(material("<bsdf type='diffuse'>" + inside + "</bsdf>"), "reflectance");
  };
  EXPECT_FLOAT_EQ(reflectance("<float name='reflectance' value='0.3'/>").eval(500), 0.3f);
  EXPECT_FLOAT_EQ(reflectance("<spectrum name='reflectance' value='0.78'/>").eval(700), 0.78f);
  EXPECT_FLOAT_EQ(reflectance("<spectrum name='reflectance' value='400:0.2, 600:0.4'/>").eval(500), 0.3f);
  EXPECT_NEAR(reflectance("<rgb name='reflectance' value='0.25'/>").eval(444), 0.25f, 1e-5);
  const RGB rgb = reflectance("<rgb name='reflectance' value='0.7, 0.4 0.1'/>").to_srgb_reflectance();
  EXPECT_NEAR(rgb[0], 0.7, 2e-3);
  EXPECT_NEAR(rgb[1], 0.4, 2e-3);
  EXPECT_NEAR(rgb[2], 0.1, 2e-3);
}

TEST(Mitsuba, EmittersTurnRgbAndNumbersIntoMultiplesOfD65) {
  const auto light = [](const std::string& inside) {
    return std::get<ConstantLight>(parse("<emitter type='constant'>" + inside + "</emitter>").lights.at(0))
        .radiance;
  };
  EXPECT_NEAR(light("").luminance(), 1, 1e-4);
  EXPECT_NEAR(light("").to_srgb_emission()[2], 1, 1e-3); // D65 is white
  EXPECT_NEAR(light("<float name='radiance' value='3'/>").luminance(), 3, 1e-3);
  EXPECT_NEAR(light("<spectrum name='radiance' value='3'/>").luminance(), 3, 1e-3);
  EXPECT_NEAR(light("<rgb name='radiance' value='3'/>").luminance(), 3, 1e-2);
  EXPECT_FLOAT_EQ(light("<spectrum name='radiance' value='400:0, 500:8'/>").eval(450), 4);
}

TEST(Mitsuba, ConductorsTakeMetalsOrIndices) {
  const Material al = material("<bsdf type='roughconductor'><string name='material' value='Al'/>"
                               "<string name='distribution' value='ggx'/><float name='alpha_u' value='0.25'/>"
                               "<float name='alpha_v' value='0.05'/></bsdf>");
  EXPECT_EQ(al.lobes[0].model, "ggx_conductor");
  EXPECT_FLOAT_EQ(number(al, "alpha_x"), 0.25f);
  EXPECT_FLOAT_EQ(number(al, "alpha_y"), 0.05f);
  EXPECT_FLOAT_EQ(spectrum(al, "k").eval(550), find_metal("Al")->k.eval(550));
  EXPECT_EQ(number(al, "separable"), 1);
  const Material values = material("<bsdf type='conductor'><rgb name='eta' value='2'/>"
                                   "<spectrum name='k' value='400:3,800:3'/></bsdf>");
  EXPECT_NEAR(spectrum(values, "eta").eval(600), 2, 1e-3);
  EXPECT_FLOAT_EQ(spectrum(values, "k").eval(600), 3);
  const Material mirror = material("<bsdf type='conductor'/>");
  EXPECT_EQ(spectrum(mirror, "eta").eval(600), 0);
  EXPECT_EQ(spectrum(mirror, "k").eval(600), 1);
  EXPECT_EQ(material("<bsdf type='roughconductor'/>").lobes[0].model, "beckmann_conductor");
  EXPECT_FLOAT_EQ(number(material("<bsdf type='roughconductor'/>"), "alpha_x"), 0.1f);
}

TEST(Mitsuba, PrincipledIsBurleysModelWithMitsubasDefaults) {
  const Material m = material("<bsdf type='principled'><rgb name='base_color' value='0.5'/>"
                              "<float name='spec_tint' value='0.3'/></bsdf>");
  EXPECT_EQ(m.lobes[0].model, "disney_2015");
  EXPECT_FLOAT_EQ(number(m, "eta"), 1.5f); // specular = 0.5
  EXPECT_EQ(number(m, "specular_tint"), 0.3f);
  EXPECT_EQ(number(m, "clearcoat_gloss"), 0);
  EXPECT_THAT(error("<bsdf type='principled' id='a'><float name='eta' value='1.4'/>"
                    "<float name='specular' value='0.4'/></bsdf>"),
              HasSubstr("exclude each other"));
}

TEST(Mitsuba, DielectricsAndPlasticsHaveMitsubasIndices) {
  EXPECT_FLOAT_EQ(number(material("<bsdf type='dielectric'/>"), "eta"), 1.5046f / 1.000277f);
  EXPECT_FLOAT_EQ(number(material("<bsdf type='dielectric'><float name='int_ior' value='1.9'/>"
                                  "<float name='ext_ior' value='1'/></bsdf>"),
                         "eta"),
                  1.9f);
  const Material diamond =
      material("<bsdf type='roughdielectric'><string name='int_ior' value='diamond'/></bsdf>");
  EXPECT_EQ(diamond.lobes[0].model, "beckmann_dielectric");
  EXPECT_NEAR(number(diamond, "eta"), 2.418, 2e-3);
  const Material plastic = material("<bsdf type='roughplastic'><string name='distribution' value='ggx'/>"
                                    "<boolean name='nonlinear' value='true'/></bsdf>");
  EXPECT_EQ(plastic.lobes[0].model, "ggx_plastic");
  EXPECT_FLOAT_EQ(number(plastic, "eta"), 1.49f / 1.000277f);
  EXPECT_EQ(number(plastic, "nonlinear"), 1);
  EXPECT_EQ(number(material("<bsdf type='plastic'/>"), "nonlinear"), 0);
}

TEST(Mitsuba, ModifiersWrapLobes) {
  const Material m =
      material("<bsdf type='mask'><float name='opacity' value='0.25'/><bsdf type='twosided'>"
               "<bsdf type='blendbsdf'><float name='weight' value='0.25'/><bsdf type='diffuse'/>"
               "<bsdf type='conductor'/></bsdf></bsdf></bsdf>");
  EXPECT_TRUE(m.two_sided);
  EXPECT_FLOAT_EQ(std::get<float>(*m.opacity), 0.25f);
  ASSERT_EQ(m.lobes.size(), 2u);
  EXPECT_FLOAT_EQ(m.lobes[0].weight, 0.75f);
  EXPECT_FLOAT_EQ(m.lobes[1].weight, 0.25f);
}

TEST(Mitsuba, EveryLobeHasTheParametersItsModelDeclares) {
  for (const char* type : {"diffuse", "conductor", "roughconductor", "dielectric", "roughdielectric",
                           "plastic", "roughplastic"}) {
    const Material m = material(std::string("<bsdf type='") + type + "'/>");
    const ModelInfo& info = find_model(m.lobes.at(0).model);
    ASSERT_EQ(m.lobes[0].parameters.size(), info.parameters.size()) << type;
    for (std::size_t i = 0; i < info.parameters.size(); ++i)
      EXPECT_EQ(std::holds_alternative<float>(m.lobes[0].parameters[i]), !info.parameters[i].per_channel)
          << type << " " << info.parameters[i].name;
  }
}

TEST(Mitsuba, ShapesHaveTheirPlaces) {
  const Scene s = parse(R"(
    <shape type="sphere"><point name="center" x="1" y="2" z="3"/><float name="radius" value="2"/>
      <transform name="to_world"><scale value="3"/><translate x="1"/></transform></shape>
    <shape type="rectangle"><transform name="to_world"><translate z="4"/></transform></shape>
    <shape type="rectangle"><boolean name="flip_normals" value="true"/></shape>
    <shape type="cylinder"><point name="p0" x="1" y="0" z="0"/><point name="p1" x="1" y="5" z="0"/>
      <float name="radius" value="0.5"/></shape>
    <shape type="cube"/>)");
  const auto& sphere = std::get<Sphere>(s.shapes[0].geometry);
  EXPECT_FLOAT_EQ(sphere.radius, 6);
  EXPECT_FLOAT_EQ(sphere.center.x, 4);
  EXPECT_FLOAT_EQ(sphere.center.z, 9);
  const auto& quad = std::get<Quad>(s.shapes[1].geometry);
  EXPECT_FLOAT_EQ(quad.corner.z, 4);
  EXPECT_FLOAT_EQ(cross(quad.edge_u, quad.edge_v).z, 4);
  const auto& flipped = std::get<TriangleMesh>(s.shapes[2].geometry);
  for (const auto& t : flipped.triangles) {
    const auto& p = flipped.positions;
    EXPECT_LT(cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]).z, 0);
  }
  for (std::size_t i = 0; i < 4; ++i) // uv stay where they were
    EXPECT_FLOAT_EQ(2 * flipped.uvs[i].x - 1, flipped.positions[i].x);
  const auto& cylinder = std::get<Cylinder>(s.shapes[3].geometry).to_world;
  EXPECT_NEAR(cylinder.point({0, 0, 1}).y, 5, 1e-12);
  EXPECT_NEAR(length(cylinder.vector({1, 0, 0})), 0.5, 1e-12);
  EXPECT_EQ(std::get<TriangleMesh>(s.shapes[4].geometry).triangles.size(), 12u);
}

TEST(Mitsuba, MeshesAreTreatedAsMitsubaDoes) {
  const ScratchFolder folder;
  const std::string mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0.25\nf 1/1 2/1 3/1\n";
  folder.write("m.obj", mesh);
  folder.write("m.ply", binary_ply(true));
  folder.write("m.serialized", serialized_file(2));
  const auto read = [&](const std::string& type, const std::string& more) {
    const Scene s = read_mitsuba_scene(folder.write(
        "s.xml", "<scene version='3.0.0'>" + sensor + "<shape type='" + type +
                     "'><string name='filename' value='m." + type + "'/>" + more + "</shape></scene>"));
    return std::get<TriangleMesh>(s.shapes[0].geometry);
  };
  EXPECT_FLOAT_EQ(read("obj", "").uvs[0].y, 0.75f); // flipped by default
  EXPECT_FLOAT_EQ(read("obj", "<boolean name='flip_tex_coords' value='false'/>").uvs[0].y, 0.25f);
  EXPECT_FLOAT_EQ(read("obj", "").normals.at(0).z, 1); // computed
  EXPECT_TRUE(read("obj", "<boolean name='face_normals' value='true'/>").normals.empty());
  EXPECT_FLOAT_EQ(read("obj", "<boolean name='flip_normals' value='true'/>").normals.at(0).z, -1);
  EXPECT_FLOAT_EQ(read("ply", "").uvs[2].y, 1); // not flipped
  EXPECT_FLOAT_EQ(read("serialized", "<integer name='shape_index' value='1'/>").positions[0].z, 1);
  EXPECT_TRUE(read("serialized", "").normals.empty()); // the file's flag asks for facets
}

TEST(Mitsuba, GroupsAreReadOnceAndPlacedByInstances) {
  const Scene s = parse(R"(<shape type="shapegroup" id="g"><shape type="sphere"/><shape type="cube"/></shape>
    <shape type="instance"><ref id="g"/></shape>
    <shape type="instance"><ref id="g"/><transform name="to_world"><translate x="3"/></transform></shape>)");
  EXPECT_TRUE(s.shapes.empty());
  ASSERT_EQ(s.groups.size(), 1u);
  EXPECT_EQ(s.groups[0].shapes.size(), 2u);
  ASSERT_EQ(s.instances.size(), 2u);
  EXPECT_EQ(s.instances[1].to_world.point({0, 0, 0}).x, 3);
}

TEST(Mitsuba, LightsAreRead) {
  const Scene s = parse(R"(
    <emitter type="point"><point name="position" x="1" y="2" z="3"/><rgb name="intensity" value="2"/></emitter>
    <emitter type="spot"><float name="cutoff_angle" value="40"/></emitter>
    <emitter type="directional"><vector name="direction" x="0" y="-2" z="0"/></emitter>
    <emitter type="sunsky"><float name="turbidity" value="4"/><integer name="resolution" value="32"/></emitter>
    <shape type="sphere"><emitter type="area"><rgb name="radiance" value="5"/></emitter></shape>)");
  EXPECT_FLOAT_EQ(std::get<PointLight>(s.lights[0]).position.z, 3);
  EXPECT_FLOAT_EQ(std::get<SpotLight>(s.lights[1]).cutoff_rad, static_cast<float>(40 * pi / 180));
  EXPECT_FLOAT_EQ(std::get<SpotLight>(s.lights[1]).beam_width_rad, static_cast<float>(30 * pi / 180));
  EXPECT_FLOAT_EQ(std::get<DirectionalLight>(s.lights[2]).direction.y, -1);
  EXPECT_EQ(std::get<EnvironmentLight>(s.lights[3]).radiance->width, 64);
  EXPECT_NEAR(std::get<SpectrumSource>(*s.shapes[0].emission).luminance(), 5, 0.02);
}

TEST(Mitsuba, PicturesCanBeProjectedAndEmitted) {
  const ScratchFolder folder;
  Image picture(4, 2, {"R", "G", "B"});
  std::fill(picture.data.begin(), picture.data.end(), 1.0f);
  write_png(picture, folder / "white.png");
  const auto white = [](const std::string& name) {
    return "<texture type='bitmap' name='" + name + "'><string name='filename' value='white.png'/></texture>";
  };
  const Scene s = parse("<emitter type='spot'>" + white("texture") + "</emitter><emitter type='projector'>" +
                            white("irradiance") +
                            "<float name='scale' value='15'/><float name='fov' value='30'/></emitter>"
                            "<shape type='rectangle'><emitter type='area'>" +
                            white("radiance") + "</emitter></shape>",
                        {{folder.path()}, {}, false});
  const Wavelengths w = sample_wavelengths(0.3f);
  const SampledSpectrum daylight = SpectrumSource::d65(1).eval(w);
  // The spot's light is its intensity's; the others' pictures are white as D65 is.
  EXPECT_NEAR(std::get<SpotLight>(s.lights.at(0)).picture->eval({0.5f, 0.5f}, w)[0], 1, 1e-4);
  const auto& projector = std::get<ProjectorLight>(s.lights.at(1));
  EXPECT_EQ(projector.scale, 15);
  EXPECT_EQ(projector.lens.fov_deg, 30);
  EXPECT_EQ(projector.picture->resolution(), (std::array<int, 2>{4, 2}));
  EXPECT_NEAR(projector.picture->eval({0.5f, 0.5f}, w)[0], daylight[0], 1e-4f * daylight[0]);
  const auto& emission = std::get<std::shared_ptr<const Texture>>(*s.shapes.at(0).emission);
  EXPECT_NEAR(emission->eval({0.2f, 0.7f}, w)[1], daylight[1], 1e-4f * daylight[1]);
}

TEST(Mitsuba, EnvironmentMapHasItsChannelsInOrder) {
  const ScratchFolder folder;
  Image map(4, 3, {"B", "G", "R"});
  for (std::size_t i = 0; i < map.data.size(); ++i)
    map.data[i] = static_cast<float>(i % 3);
  map.data[0] = -1;
  write_exr(map, folder / "env.exr");
  const Scene s = read_mitsuba_scene(
      folder.write("s.xml", "<scene version='3.0.0'>" + sensor +
                                "<emitter type='envmap'><string name='filename' value='env.exr'/>"
                                "<float name='scale' value='2'/></emitter></scene>"));
  const auto& light = std::get<EnvironmentLight>(s.lights[0]);
  EXPECT_EQ(light.scale, 2);
  EXPECT_EQ(light.radiance->at(1, 1)[0], 2); // R
  EXPECT_EQ(light.radiance->at(1, 1)[2], 0); // B
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_THAT(s.warnings[0], HasSubstr("1 negative"));
}

TEST(Mitsuba, NormalAndBumpMapsAreLaidOverAMaterial) {
  const ScratchFolder folder;
  Image picture(2, 1, {"Y"});
  picture.data = {0, 0.5f};
  write_png(picture, folder / "t.png");
  const std::string texture = "<texture type='bitmap' name='normalmap'><string name='filename' value='" +
                              (folder / "t.png") + "'/><boolean name='raw' value='true'/></texture>";
  const Material map = material("<bsdf type='normalmap'>" + texture + "<bsdf type='diffuse'/></bsdf>");
  EXPECT_TRUE(map.normal_map && !map.bump_map);
  EXPECT_EQ(map.normal_mapping, NormalMapping::turned_frame);
  const Material facets = material("<bsdf type='normalmap'><string name='method' value='microfacet'/>" +
                                   texture + "<bsdf type='twosided'><bsdf type='diffuse'/></bsdf></bsdf>");
  EXPECT_EQ(facets.normal_mapping, NormalMapping::microfacet);
  EXPECT_TRUE(facets.two_sided);
  const Material bump = material("<bsdf type='bumpmap'><float name='scale' value='3'/>" + texture +
                                 "<bsdf type='roughplastic'/></bsdf>");
  ASSERT_TRUE(bump.bump_map && !bump.normal_map);
  EXPECT_EQ(bump.bump_scale, 3);
  EXPECT_EQ(bump.lobes.at(0).model, "beckmann_plastic");

  const auto said = [](const std::string& bsdf) {
    return error("<shape type='rectangle'>" + bsdf + "</shape>");
  };
  EXPECT_THAT(said("<bsdf type='bumpmap'><bsdf type='diffuse'/></bsdf>"), HasSubstr("takes one texture"));
  EXPECT_THAT(said("<bsdf type='bumpmap'>" + texture + "</bsdf>"), HasSubstr("takes one nested bsdf"));
  EXPECT_THAT(said("<bsdf type='bumpmap'><texture type='checkerboard'/><bsdf type='diffuse'/></bsdf>"),
              HasSubstr("must be a bitmap"));
  EXPECT_THAT(said("<bsdf type='bumpmap'>" + texture + "<bsdf type='normalmap'>" + texture +
                   "<bsdf type='diffuse'/></bsdf></bsdf>"),
              HasSubstr("on another is not supported"));
  EXPECT_THAT(said("<bsdf type='bumpmap'><string name='method' value='microfacet'/>" + texture +
                   "<bsdf type='dielectric'/></bsdf>"),
              HasSubstr("transmits light"));
}

TEST(Mitsuba, TexturesAreSharedAndMapped) {
  const ScratchFolder folder;
  Image picture(2, 1, {"Y"});
  picture.data = {0, 0.5f};
  write_png(picture, folder / "t.png");
  const std::string scene = "<scene version='3.0.0'>" + sensor + R"(
    <texture type="bitmap" id="t"><string name="filename" value="t.png"/><string name="filter_type" value="nearest"/>
      <transform name="to_uv"><scale x="2" y="1"/></transform></texture>
    <bsdf type="diffuse" id="a"><ref name="reflectance" id="t"/></bsdf>
    <bsdf type="diffuse" id="b"><ref name="reflectance" id="t"/></bsdf>
    <bsdf type="roughplastic" id="c"><texture name="alpha" type="bitmap"><string name="filename" value="t.png"/>
      <boolean name="raw" value="true"/></texture></bsdf></scene>)";
  const Scene s = read_mitsuba_scene(folder.write("s.xml", scene));
  ASSERT_EQ(s.materials.size(), 3u);
  const auto texture = [&](int m, const std::string& name) {
    return std::get<std::shared_ptr<const Texture>>(
        parameter(s.materials[static_cast<std::size_t>(m)], name));
  };
  EXPECT_EQ(texture(0, "reflectance"), texture(1, "reflectance"));
  // 0.5 is stored as 128 / 255, which is 0.2159 in linear light, and lies at u = 1/4 after scaling.
  EXPECT_NEAR(texture(0, "reflectance")->eval({0.3f, 0.5f}, sample_wavelengths(0.5f))[0], 0.2159, 2e-4);
  EXPECT_NEAR(texture(2, "alpha")->eval_scalar({0.75f, 0.5f}), 128 / 255.0, 1e-5);
}

TEST(Mitsuba, ReferencesMayPrecedeWhatTheyName) {
  const Scene s = parse("<shape type='sphere'><ref id='m'/><ref id='e'/></shape>"
                        "<shape type='sphere'><ref name='bsdf' id='n'/></shape>"
                        "<bsdf type='diffuse' id='m'/><emitter type='area' id='e'/><alias id='m' as='n'/>");
  EXPECT_EQ(s.shapes[0].material, s.shapes[1].material);
  EXPECT_TRUE(s.shapes[0].emission.has_value());
  EXPECT_EQ(s.materials.size(), 1u);
}

TEST(Mitsuba, ParametersComeFromOutsideOrFromDefaults) {
  const std::string scene = "<default name='res' value='40'/><default name='name' value='tent'/>"
                            "<shape type='sphere'><float name='radius' value='$res'/></shape>";
  EXPECT_FLOAT_EQ(std::get<Sphere>(parse(scene).shapes[0].geometry).radius, 40);
  MitsubaOptions options;
  options.definitions["res"] = "7";
  EXPECT_FLOAT_EQ(std::get<Sphere>(parse(scene, options).shapes[0].geometry).radius, 7);
  options.definitions["rse"] = "7";
  EXPECT_THAT(error(scene, options), HasSubstr("no parameter 'rse'"));
  EXPECT_THAT(error("<shape type='$shap'/>"), HasSubstr("'$shap' has no value"));
}

TEST(Mitsuba, OldScenesHaveTheirNamesConverted) {
  const Scene s = parse_mitsuba_scene(R"(<scene version="0.5.0"><integrator type="path">
      <integer name="maxDepth" value="4"/></integrator>
    <sensor type="perspective"><string name="fovAxis" value="y"/><float name="fov" value="20"/>
      <transform name="toWorld"><lookAt origin="0,0,0" target="0,0,1" up="0,1,0"/></transform>
      <film type="hdrfilm"><boolean name="banner" value="false"/><string name="pixelFormat" value="rgb"/></film>
      <sampler type="ldsampler"><integer name="sampleCount" value="9"/></sampler></sensor>
    <shape type="sphere"><bsdf type="roughplastic"><float name="intIOR" value="2"/>
      <rgb name="diffuseReflectance" value="0.1 0.2 0.3"/></bsdf></shape>
    <shape type="sphere"><bsdf type="conductor"/></shape>
    <shape type="sphere"><bsdf type="diffuse"><texture type="checkerboard" name="reflectance">
      <float name="uscale" value="8"/><float name="voffset" value="3"/></texture></bsdf></shape></scene>)",
                                      "s.xml");
  EXPECT_EQ(s.integrator.max_depth, 4);
  EXPECT_EQ(s.camera.fov_axis, Camera::FovAxis::y);
  EXPECT_EQ(s.samples_per_pixel, 9);
  EXPECT_FLOAT_EQ(number(s.materials[0], "eta"), 2 / 1.000277f);
  EXPECT_FLOAT_EQ(spectrum(s.materials[1], "eta").eval(500), find_metal("Cu")->eta.eval(500));
  const auto texture = std::get<std::shared_ptr<const Texture>>(parameter(s.materials[2], "reflectance"));
  EXPECT_EQ(texture->to_uv[0], 8);
  EXPECT_EQ(texture->to_uv[5], 3);
}

TEST(Mitsuba, IncludesAndPathsAreFollowed) {
  const ScratchFolder folder;
  folder.write("common/m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("parts/bsdfs.xml",
               "<scene version='0.5.0'><default name='size' value='5'/>"
               "<bsdf type='dielectric' id='glass'><float name='intIOR' value='$n'/></bsdf></scene>");
  const std::string scene = folder.write(
      "s.xml",
      "<scene version='3.0.0'><default name='n' value='1.7'/><path value='common'/>" + sensor +
          "<include filename='parts/bsdfs.xml'/><shape type='obj'><string name='filename' value='m.obj'/>"
          "<ref id='glass'/></shape><shape type='sphere'><float name='radius' "
          "value='$size'/></shape></scene>");
  const Scene s = read_scene(scene);
  EXPECT_FLOAT_EQ(number(s.materials[0], "eta"), 1.7f / 1.000277f);
  EXPECT_FLOAT_EQ(std::get<Sphere>(s.shapes[1].geometry).radius, 5);
}

TEST(Mitsuba, FoldersAreSearchedAfterTheScenesOwn) {
  const ScratchFolder folder;
  folder.write("other/m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::string scene =
      folder.write("s.xml", "<scene version='3.0.0'>" + sensor +
                                "<shape type='obj'><string name='filename' value='m.obj'/></shape></scene>");
  EXPECT_THAT(message_of([&] { read_scene(scene); }),
              HasSubstr("m.obj: no such file in '" + folder.path() + "'"));
  EXPECT_EQ(read_scene(scene, {{folder / "other"}, {}, false}).shapes.size(), 1u);
}

TEST(Mitsuba, StrictTurnsWarningsIntoErrors) {
  const std::string scene = "<bsdf type='roughconductor' id='a'><float name='alpha' value='0.00001'/></bsdf>";
  ASSERT_EQ(parse(scene).warnings.size(), 1u);
  EXPECT_THAT(parse(scene).warnings[0], HasSubstr("is raised to"));
  EXPECT_THAT(error(scene, {{}, {}, true}), HasSubstr("is raised to"));
}

TEST(Mitsuba, RealScenesAreRead) {
  namespace fs = std::filesystem;
  const fs::path root = fs::path(NACRE_SOURCE_DIR) / "../shared/data/scenes";
  if (!fs::exists(root)) GTEST_SKIP() << "no " << root;
  for (const char* name :
       {"mitsuba/scenes/hello.xml", "mitsuba/scenes/cbox/cbox.xml", "mitsuba/scenes/cbox/cbox-rgb.xml",
        "mitsuba/scenes/cbox/cbox-spectral.xml", "mitsuba/tests/scenes/bsdf_spheres/test_arealight_path.xml",
        "mitsuba/tests/scenes/bsdf_spheres/test_constant_path.xml",
        "mitsuba/tests/scenes/bsdf_spheres/test_envmap_path.xml",
        "mitsuba/tests/scenes/bsdf_spheres/test_normalmap_roughconductor_path.xml",
        "mitsuba/tests/scenes/bsdf_spheres/test_roughdielectric_path.xml",
        "mitsuba/tests/scenes/bsdf_spheres/test_roughplastic_linear_path.xml",
        "mitsuba/tests/scenes/bsdf_spheres/test_textured_diffuse_path.xml",
        "mitsuba/tests/scenes/instancing/test_instancing_path.xml",
        "mitsuba/tests/scenes/orthographic_sensor/test_orthographic_path.xml",
        "mitsuba/tests/scenes/spot_light/test_spot_direct.xml", "lajolla/veach_mi/mi.xml",
        "lajolla/disney_bsdf_test/simple_sphere.xml"}) {
    const Scene s = read_scene((root / name).string());
    EXPECT_FALSE(s.shapes.empty() && s.instances.empty()) << name;
    EXPECT_TRUE(s.warnings.empty()) << name << ": " << s.warnings[0];
    for (const Shape& shape : s.shapes)
      EXPECT_LT(shape.material, static_cast<int>(s.materials.size()));
  }
  EXPECT_EQ(read_scene((root / "lajolla/sponza/sponza.xml").string()).shapes.size(), 38u);
}

} // namespace
} // namespace nacre

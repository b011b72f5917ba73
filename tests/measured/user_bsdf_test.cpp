// Users' .brdf files wherever materials are: as text, as JSON, as scattering.
#include "measured/user_bsdf.h"

#include "bsdf/user_shader.h"
#include "core/file.h"
#include "core/random.h"
#include "core/scratch_folder.h"
#include "core/statistics.h"
#include "measured/material_as_measurement.h"
#include "measured/measured_albedo.h"

#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

using testing::HasSubstr;
using user_shader::body;
using user_shader::cloth;

/// A folder with cloth.brdf in it.
class UserMaterial : public testing::Test {
protected:
  UserMaterial() { write("cloth.brdf", cloth()); }
  void write(const std::string& name, const std::string& text) {
    std::filesystem::create_directories(std::filesystem::path(path(name)).parent_path());
    write_file_atomically(path(name), text);
  }
  std::string path(const std::string& name) const { return folder_ / name; }
  std::string message(const std::string& text, const FileFinder& find = {}) const {
    try {
      parse_material(text, find);
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  }

  ScratchFolder folder_;
  const Vec3d wo = spherical_direction(0.4, 0.3), wi = spherical_direction(0.7, 2.0);
};

TEST_F(UserMaterial, AFileIsAMaterialWithItsParameters) {
  const MaterialSpec plain = parse_material(path("cloth.brdf"));
  ASSERT_EQ(plain.lobes.size(), 1u);
  EXPECT_EQ(plain.lobes[0].values[0], (std::array{0.6, 0.3, 0.1}));
  EXPECT_FALSE(plain.lobes[0].is_table());
  const MaterialSpec m = parse_material(path("cloth.brdf") + ":base=0.8/0.2/0.1,gloss=0.25,sharp=1");
  EXPECT_EQ(m.lobes[0].values[0], (std::array{0.8, 0.2, 0.1}));
  const auto model = UserModel::parse(cloth(), "cloth.brdf");
  const auto direct = model->eval<double>(std::vector{0.8, 0.2, 0.1, 0.25, 0.5, 0.5, 1.0}, wo, wi);
  const auto f = make_bsdf<double>(m).eval(wo, wi);
  for (int c = 0; c < 3; ++c)
    EXPECT_EQ(f[c], direct[c]);
}

// As nacre eval says it: plots show a hole there, where a curve through 0 would be a lie.
TEST_F(UserMaterial, WhatIsNoNumberStaysNoneInPacks) {
  write("nan.brdf", body("return vec3(sqrt(-L.z), -1.0, 0.5);"));
  const MaterialSpec material = parse_material(path("nan.brdf"));
  const auto bsdf = make_bsdf<Pack>(material);
  const auto pack = [](const Vec3d& w) {
    return Vec3<Pack>{Pack(float(w.x)), Pack(float(w.y)), Pack(float(w.z))};
  };
  const auto f = bsdf.eval(pack(wo), pack(wi));
  EXPECT_TRUE(std::isnan(lane(f[0], 0)));
  EXPECT_EQ(lane(f[1], 0), 0.0f);
  EXPECT_EQ(lane(f[2], 0), 0.5f);
}

TEST_F(UserMaterial, TakesPartInSums) {
  const auto value = [&](const std::string& text) {
    return make_bsdf<double>(parse_material(text)).eval(wo, wi)[1];
  };
  const std::string file = path("cloth.brdf");
  EXPECT_NEAR(value("0.5*" + file + ":gloss=0.2+lambert:reflectance=0.3+" + file),
              0.5 * value(file + ":gloss=0.2") + value("lambert:reflectance=0.3") + value(file), 1e-12);
}

TEST_F(UserMaterial, TextAndJsonReadBackToTheSameMaterial) {
  for (const std::string& text :
       {path("cloth.brdf"), path("cloth.brdf") + ":base=0.25/1/0,gloss=0.0625,sharp=1",
        "0.3*" + path("cloth.brdf") + ":tint=1+lambert:reflectance=0.125"}) {
    const MaterialSpec m = parse_material(text);
    for (const MaterialSpec& again :
         {parse_material(to_text(m)), material_from_json(to_json(m), "memory.json"),
          material_from_json(nlohmann::json::parse(to_json(m).dump()), path("fit.json"))}) {
      ASSERT_EQ(again.lobes.size(), m.lobes.size());
      for (std::size_t l = 0; l < m.lobes.size(); ++l) {
        EXPECT_EQ(again.lobes[l].values, m.lobes[l].values) << text;
        EXPECT_EQ(again.lobes[l].weight, m.lobes[l].weight);
        EXPECT_EQ(bool(again.lobes[l].user), bool(m.lobes[l].user));
      }
      EXPECT_EQ(make_bsdf<double>(again).eval(wo, wi)[0], make_bsdf<double>(m).eval(wo, wi)[0]);
    }
  }
}

TEST_F(UserMaterial, JsonNamesAFileBesideIt) {
  write("sub/inner.brdf", body("return vec3(0.75);"));
  write("sub/m.json", R"({"lobes": [{"model": "inner.brdf", "parameters": {"a": 1}}]})");
  EXPECT_EQ(make_bsdf<double>(parse_material(path("sub/m.json"))).eval(wo, wi)[0], 0.75);
}

TEST_F(UserMaterial, WhoeverLooksForFilesDecidesWhichMayBeRead) {
  const FileFinder locked = [](const std::string& name) -> std::string { throw Error("not " + name); };
  write("m.json", R"({"lobes": [{"model": "cloth.brdf", "parameters": {}}]})");
  for (const std::string& text : {path("cloth.brdf"), path("cloth.brdf") + ":gloss=0.3",
                                  "lambert+" + path("cloth.brdf"), path("m.json"), path("x.binary")})
    EXPECT_THAT(message(text, locked), HasSubstr("not ")) << text;
  const FileFinder here = [&](const std::string& name) { return path(name); };
  EXPECT_EQ(message("cloth.brdf:gloss=0.3+lambert", here), "no error");
}

TEST_F(UserMaterial, SignsInAPathAreThoseOfThePath) {
  for (const char* name : {"a+b.brdf", "a,b.brdf", "a:b.brdf", "with blanks.brdf"}) {
    write(name, cloth());
    EXPECT_EQ(message(path(name)), "no error") << name;
    if (std::string_view(name) == "a+b.brdf") continue;
    EXPECT_EQ(message(path(name) + ":gloss=0.3"), "no error") << name;
  }
}

TEST_F(UserMaterial, ErrorsNameTheMistakeAndTheNearestName) {
  const std::string file = path("cloth.brdf");
  EXPECT_THAT(message(path("clot.brdf")), HasSubstr("clot.brdf: no such file (did you mean 'cloth.brdf'?)"));
  EXPECT_THAT(message("lambert+" + path("none/cloth.brdf")), HasSubstr("none/cloth.brdf: no such file"));
  EXPECT_THAT(message(file + ":glos=0.3"), HasSubstr("did you mean 'gloss'"));
  EXPECT_THAT(message(file + ":gloss=3"), HasSubstr("gloss = 3 lies outside its domain [0.05, 1]"));
  EXPECT_THAT(message(file + ":gloss=0.1/0.2/0.3"), HasSubstr("one number"));
  EXPECT_THAT(message(file + ":sharp=0.5"), HasSubstr("a switch is 0 or 1"));
  EXPECT_THAT(message(file + ":gloss=0.3,gloss=0.4"), HasSubstr("given twice"));
  EXPECT_THAT(message(file + ":metal=Au"), HasSubstr("metal sets eta and k"));
  write("wrong.brdf", body("return wrong;"));
  EXPECT_THAT(message(path("wrong.brdf")), HasSubstr("wrong.brdf:10: 'wrong' : undeclared"));
}

TEST_F(UserMaterial, IsIsotropicWhereItsTangentPlaysNoPart) {
  EXPECT_TRUE(parse_material(path("cloth.brdf")).lobes[0].measured->is_isotropic());
  write("brushed.brdf", body("vec3 H = normalize(L + V); return vec3(exp(-a * dot(H, X) * dot(H, X)));"));
  EXPECT_FALSE(parse_material(path("brushed.brdf")).lobes[0].measured->is_isotropic());
  EXPECT_TRUE(parse_material(path("brushed.brdf") + ":a=0").lobes[0].measured->is_isotropic());
}

TEST_F(UserMaterial, IsTabulatedLikeAnyMaterial) {
  const auto measured = as_measurement(parse_material(path("cloth.brdf")));
  EXPECT_TRUE(measured->is_isotropic());
  EXPECT_GT(measured->samples().size(), 5000u);
}

// Some say 0/0 at the mirror direction or at grazing: others are not to suffer.
TEST_F(UserMaterial, ValuesThatAreNoNumbersLeaveTheSamplingSound) {
  write("half.brdf", body("return L.x > 0.0 ? vec3(0.0 / (a - a)) : vec3(0.25);"));
  const MaterialSpec m = parse_material(path("half.brdf"));
  EXPECT_TRUE(std::isnan(make_bsdf<double>(m).eval(wo, spherical_direction(0.7, 0.0))[0]));
  for (int i = 0; i < 2000; ++i) {
    const auto u = [i](int d) { return unit_double(hash(9, i, d)); };
    const Vec3d w = m.lobes[0].measured->sample(wo, u(0), {u(1), u(2)});
    EXPECT_TRUE(std::isfinite(w.x) && std::isfinite(m.lobes[0].measured->pdf(wo, w)));
  }
}

double luminance(const std::array<double, 3>& rgb) {
  return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

/// Variance of the estimate of the albedo over its squared mean.
template <class Sample>
double relative_variance(Sample sample) {
  RunningMoments m;
  for (int i = 0; i < 4000; ++i) {
    const auto u = [i](int d) { return unit_double(hash(8, i, d)); };
    m.add(sample(u(0), Vec2d{u(1), u(2)}));
  }
  return m.variance() / sqr(m.mean());
}

// The public files with their defaults: what is gained over the cosine, and that little is left.
TEST(LongUserBsdf, PublicFilesAreSampledByTheirOwnLobes) {
  bool any = false;
  for (const char* name : {"ashikhman_shirley", "compare", "cooktorrance", "disney", "ward"}) {
    const std::string file = std::string(NACRE_SOURCE_DIR) + "/../shared/data/brdf/" + name + ".brdf";
    if (!std::filesystem::exists(file)) continue;
    any = true;
    const MaterialSpec m = parse_material(file);
    const MeasuredBsdf& measured = *m.lobes[0].measured;
    double own = 0, cosine = 0, uniform = 0;
    for (const double theta : {0.2, 0.7, 1.1}) {
      const Vec3d wo = spherical_direction(theta, 0.4);
      own += relative_variance([&](double u_lobe, const Vec2d& u) {
               const Vec3d wi = measured.sample(wo, u_lobe, u);
               const double pdf = measured.pdf(wo, wi);
               return pdf > 0 && wi.z > 0 ? luminance(measured.rgb(wo, wi)) * wi.z / pdf : 0;
             }) /
             3;
      cosine += relative_variance([&](double, const Vec2d& u) {
                  const double r = std::sqrt(u.x), phi = 2 * pi * u.y;
                  const Vec3d wi{r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - u.x)};
                  return luminance(measured.rgb(wo, wi)) * pi;
                }) /
                3;
      uniform += relative_variance([&](double, const Vec2d& u) {
                   const double r = std::sqrt(1 - u.x * u.x), phi = 2 * pi * u.y;
                   const Vec3d wi{r * std::cos(phi), r * std::sin(phi), u.x};
                   return luminance(measured.rgb(wo, wi)) * wi.z * 2 * pi;
                 }) /
                 3;
    }
    EXPECT_LT(own, 0.3) << name;
    EXPECT_LT(own, 0.9 * cosine + 0.02) << name;
    std::printf("%-18s relative variance of a sample: own %.3g, cosine %.3g, uniform %.3g\n", name, own,
                cosine, uniform);
  }
  if (!any) GTEST_SKIP() << "no public .brdf files beside the project";
}

} // namespace
} // namespace nacre

#include "measured/formats/kaist_pbsdf.h"

#include "core/error.h"
#include "core/file.h"
#include "core/quadrature.h"
#include "core/random.h"
#include "measured/formats.h"
#include "measured/rusinkiewicz.h"
#include "measured/tensor_file.h"

#include <cstring>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <iostream>

namespace nacre {
namespace {

using testing::HasSubstr;

const std::string spectralon_path = NACRE_SOURCE_DIR "/../shared/data/measured/pbrdf/spectralon_lowres.pbsdf";

double random(int i, int d) { return unit_double(hash(61, i, d)); }
Vec3d random_direction(int i, int d) {
  const double z = random(i, d), phi = 2 * pi * random(i, d + 1), s = std::sqrt(1 - z * z);
  return {s * std::cos(phi), s * std::sin(phi), z};
}

/// Linear in the three angles and in wavelength, each entry of the matrix differently.
double entry(double phi_d, double theta_d, double theta_h, double nm, std::size_t e) {
  return (1 + 0.1 * double(e)) * (2 + 0.3 * phi_d + theta_d - 0.5 * theta_h + 0.002 * (nm - 500));
}
MuellerTable small_table() {
  MuellerTable t;
  for (int i = 0; i < 9; ++i)
    t.phi_d.push_back(-pi + i * pi / 4);
  t.theta_d = {0, 0.5, 1.1, pi / 2};
  t.theta_h = {0, 0.2, 0.8, pi / 2};
  t.wavelengths_nm = {450, 550, 600};
  for (const double p : t.phi_d)
    for (const double d : t.theta_d)
      for (const double h : t.theta_h)
        for (const double nm : t.wavelengths_nm)
          for (std::size_t e = 0; e < 16; ++e)
            t.entries.push_back(float(entry(p, d, h, nm, e)));
  return t;
}

TEST(KaistPbsdf, IsExactForFunctionsLinearInAnglesAndWavelength) {
  const KaistPbsdf table(small_table());
  for (int i = 0; i < 2000; ++i) {
    const Vec3d wo = random_direction(i, 0), wi = random_direction(i, 2);
    const auto a = half_difference(wo, wi);
    std::array<float, 3> f;
    ASSERT_TRUE(table.evaluate(wo, wi, f));
    for (std::size_t c = 0; c < 3; ++c) {
      const double expected = entry(a.phi_d, a.theta_d, a.theta_h, table.table().wavelengths_nm[c], 0);
      EXPECT_NEAR(f[c], expected, 2e-6 * expected);
    }
    const double nm = 430 + 200 * random(i, 4), held = std::clamp(nm, 450.0, 600.0);
    const auto m = table.mueller(wo, wi, nm);
    ASSERT_TRUE(m);
    for (std::size_t e = 0; e < 16; ++e) {
      const double expected = entry(a.phi_d, a.theta_d, a.theta_h, held, e);
      EXPECT_NEAR(m->rows[e / 4][e % 4], expected, 2e-6 * expected);
    }
  }
  EXPECT_FALSE(table.mueller({0, 0, 1}, {0.6, 0, -0.8}, 500));
}

TEST(KaistPbsdf, AnAxisThatStopsShortOfATurnGoesOnAtItsBeginning) {
  MuellerTable t = small_table(); // seven nodes from -135 to 135 degrees, with the values 1 to 7
  t.phi_d = {t.phi_d.begin() + 1, t.phi_d.end() - 1};
  const std::size_t slab = t.entries.size() / 9;
  t.entries.resize(7 * slab);
  for (std::size_t i = 0; i < t.entries.size(); ++i)
    t.entries[i] = float(i / slab) + 1;
  const KaistPbsdf table(t);
  for (const double phi : {7 * pi / 8, -7 * pi / 8}) { // a quarter and three of the way from 7 to 1
    const auto pair = directions(HalfDifference<double>{0.3, 0.4, phi});
    std::array<float, 3> f;
    ASSERT_TRUE(table.evaluate(pair.wo, pair.wi, f));
    EXPECT_NEAR(f[0], phi > 0 ? 0.75 * 7 + 0.25 : 0.25 * 7 + 0.75, 1e-5);
  }
}

TEST(KaistPbsdf, HolesTakeNoPartAndAreHolesWhereNothingElseIs) {
  MuellerTable t = small_table();
  const std::size_t node = 3 * 16;
  int i = 0;
  for (std::size_t n = 0; n < t.entries.size(); n += node, ++i)
    if (random(i, 9) < 0.7)
      std::fill_n(t.entries.begin() + std::ptrdiff_t(n), node, i % 2 ? 0.0f : std::nanf(""));
    else
      std::fill_n(t.entries.begin() + std::ptrdiff_t(n), node, 0.3f);
  const KaistPbsdf table(t);
  EXPECT_GT(table.hole_count(), 80u);
  int holes = 0;
  for (int k = 0; k < 3000; ++k) {
    std::array<float, 3> f;
    const bool known = table.evaluate(random_direction(k, 0), random_direction(k, 2), f);
    holes += !known;
    EXPECT_NEAR(f[1], known ? 0.3 : 0.0, 1e-6);
  }
  EXPECT_GT(holes, 20);
  EXPECT_LT(holes, 2000);
}

/// A file field by field, as Mitsuba 3 reads it.
std::vector<std::uint8_t> encode(const MuellerTable& t, bool with_axes = true) {
  std::vector<std::uint16_t> nm(t.wavelengths_nm.begin(), t.wavelengths_nm.end());
  std::vector<std::vector<float>> axes;
  for (const auto* axis : {&t.theta_d, &t.theta_h, &t.phi_d})
    axes.push_back(with_axes ? std::vector<float>(axis->begin(), axis->end()) : std::vector<float>());
  const std::uint64_t rows = with_axes;
  std::vector<Tensor> fields{
      tensor("theta_d", {rows, t.theta_d.size()}, axes[0]),
      tensor("theta_h", {rows, t.theta_h.size()}, axes[1]),
      tensor("phi_d", {rows, t.phi_d.size()}, axes[2]),
      {"wvls",
       TensorType::uint16,
       {nm.size()},
       {reinterpret_cast<const std::uint8_t*>(nm.data()), nm.size() * 2}},
      tensor("M", {t.phi_d.size(), t.theta_d.size(), t.theta_h.size(), nm.size(), 4, 4}, t.entries)};
  return encode_tensor_file(fields);
}
std::string message_of(std::span<const std::uint8_t> bytes) {
  try {
    parse_kaist(bytes, "x.pbsdf");
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST(KaistPbsdf, FileIsReadAsItsFieldsSay) {
  const MuellerTable t = small_table();
  const KaistPbsdf table = parse_kaist(encode(t), "x.pbsdf");
  EXPECT_EQ(table.table().entries, t.entries);
  EXPECT_EQ(table.channels().wavelengths_nm(), t.wavelengths_nm);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(table.table().theta_h[i], t.theta_h[i], 1e-6);
  EXPECT_FALSE(table.table().axes_assumed);
}

TEST(KaistPbsdf, WhatDoesNotFitIsAnErrorWithItsPlace) {
  const auto broken = [](auto change) {
    MuellerTable t = small_table();
    change(t);
    return message_of(encode(t));
  };
  EXPECT_THAT(broken([](MuellerTable& t) { std::swap(t.theta_h[1], t.theta_h[2]); }), HasSubstr("'theta_h'"));
  EXPECT_THAT(broken([](MuellerTable& t) { t.phi_d.back() = 4; }), HasSubstr("'phi_d'"));
  EXPECT_THAT(broken([](MuellerTable& t) { t.wavelengths_nm[0] = 600; }), HasSubstr("'wvls'"));
  EXPECT_THAT(broken([](MuellerTable& t) { t.entries[7] = std::nanf(""); }), HasSubstr("finite entries"));
  EXPECT_THAT(broken([](MuellerTable& t) { t.entries[7] = HUGE_VALF; }), HasSubstr("found inf"));
  EXPECT_THAT(broken([](MuellerTable& t) { t.entries[7] = 1e35f; }), HasSubstr("at most 1e30"));
  // Without axes 9 phi_d are every 45th of 361, but no step leaves 4 of 91.
  EXPECT_EQ(message_of(encode(small_table(), false)), "no error");
  MuellerTable odd = small_table();
  odd.theta_d.assign(60, 0.0);
  odd.entries.resize(odd.entries.size() / 4 * 60);
  EXPECT_THAT(message_of(encode(odd, false)), HasSubstr("no even part"));
  const auto bytes = encode(small_table());
  for (std::size_t n = 0; n < bytes.size(); n += n < 400 ? 1 : 37)
    EXPECT_THAT(message_of(std::span(bytes).first(n)), HasSubstr("byte")) << n;
  for (int i = 0; i < 4000; ++i) {
    auto flipped = bytes;
    flipped[hash(8, i, 0) % (i % 2 ? 300 : bytes.size())] ^= std::uint8_t(1u << (hash(8, i, 1) % 8));
    const std::string message = message_of(flipped);
    EXPECT_TRUE(message == "no error" || message.find("x.pbsdf: byte ") == 0) << message;
  }
}

class SpectralonFile : public testing::Test {
protected:
  void SetUp() override {
    if (!std::filesystem::exists(spectralon_path)) GTEST_SKIP() << "no ../shared/data/measured/pbrdf";
    bytes_ = read_file(spectralon_path);
  }
  std::vector<std::uint8_t> bytes_;
};

TEST_F(SpectralonFile, AssumedAxesPutNoValueBelowTheHorizon) {
  const KaistPbsdf table = parse_kaist(bytes_, spectralon_path);
  const auto& [phi_d, theta_d, theta_h, wavelengths, entries, assumed] = table.table();
  EXPECT_TRUE(assumed);
  EXPECT_EQ(wavelengths, (std::vector<double>{450, 500, 550, 600, 650}));
  std::size_t i = 0, below = 0, unseen = 0;
  for (const double p : phi_d)
    for (const double d : theta_d)
      for (const double h : theta_h) {
        const bool above = above_horizon(HalfDifference<double>{h, d, p});
        below += !above && table.is_known(i);
        unseen += above && !table.is_known(i);
        ++i;
      }
  EXPECT_EQ(i, 22u * 9 * 9);
  EXPECT_EQ(below, 0u); // with theta_h a degree apart instead there are 152
  std::cout << unseen << " of " << i << " nodes are above the horizon and holes\n";
}

TEST_F(SpectralonFile, IsNearlyDiffuseAwayFromGrazing) {
  // Spectralon reflects 0.99, evenly. The file's numbers are lower: 0.41 to 0.49 is what they integrate to,
  // since f pi is 0.68 near the normal and falls with the angle. The database's scale is its own; the shape
  // is what is asked for here.
  const auto table = read_measured(spectralon_path);
  std::vector<double> albedos;
  for (const double theta_deg : {0.0, 15.0, 30.0, 45.0, 60.0}) {
    const Vec3d wo = spherical_direction(theta_deg * pi / 180, 0.3);
    std::array<double, 5> albedo{};
    for (const auto& [wi, weight] : hemisphere_rule(48, 96)) {
      std::array<float, 5> f;
      ASSERT_TRUE(table->evaluate(wo, wi, f)) << theta_deg;
      for (std::size_t c = 0; c < 5; ++c)
        albedo[c] += weight * wi.z * double(f[c]);
      if (theta_deg <= 30 && wi.z > 0.6) {
        EXPECT_GT(f[2] * pi, 0.3);
        EXPECT_LT(f[2] * pi, 0.75);
      }
    }
    for (std::size_t c = 0; c < 5; ++c) // white
      EXPECT_NEAR(albedo[c] / albedo[2], 1, 0.05) << table->channels().wavelengths_nm()[c] << " nm";
    std::cout << "albedo at " << theta_deg << " degrees: " << albedo[2] << '\n';
    albedos.push_back(albedo[2]);
  }
  const auto [low, high] = std::minmax_element(albedos.begin(), albedos.end());
  EXPECT_GT(*low, 0.40);
  EXPECT_LT(*high, 0.50);
}

TEST_F(SpectralonFile, DepolarisesExceptForTheGlossThatIsPolarisedAcrossThePlane) {
  const KaistPbsdf table = parse_kaist(bytes_, spectralon_path);
  const auto near_normal = table.mueller(spherical_direction(0.3, 0.0), spherical_direction(0.2, 2.0), 550);
  ASSERT_TRUE(near_normal);
  for (std::size_t e = 1; e < 16; ++e)
    EXPECT_LT(std::abs(near_normal->rows[e / 4][e % 4]), 0.1 * near_normal->rows[0][0]) << e;
  // The mirror direction near Brewster's angle: a dielectric reflects what oscillates across the plane, Q >
  // 0, and the file's sign of Q depends on its frames being those that are claimed.
  const double theta = 60 * pi / 180;
  const auto gloss =
      table.mueller(spherical_direction(theta, 1.0), spherical_direction(theta, 1.0 + pi), 550);
  ASSERT_TRUE(gloss);
  EXPECT_GT(gloss->rows[1][0], 0.4 * gloss->rows[0][0]);
  EXPECT_GT(gloss->rows[0][1], 0.4 * gloss->rows[0][0]);
}

} // namespace
} // namespace nacre

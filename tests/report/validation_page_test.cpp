#include "report/validation_page.h"

#include "core/image.h"
#include "core/scratch_folder.h"
#include "display/colormap.h"

#include <cmath>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nacre {
namespace {

using testing::HasSubstr;

std::string page_of(const std::string& text) {
  ValidateOptions options;
  options.samples = 2000, options.directions = 500;
  const MaterialSpec material = parse_material(text);
  return validation_page(material, validate(material, options));
}

std::vector<std::string> embedded(const std::string& page) {
  std::vector<std::string> all;
  const std::string before = "data:image/png;base64,";
  for (std::size_t at = page.find(before); at != std::string::npos; at = page.find(before, at)) {
    at += before.size();
    all.push_back(page.substr(at, page.find('\'', at) - at));
  }
  return all;
}

Image decoded(const std::string& base64) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned word = 0, bits = 0;
  for (const char c : base64) {
    if (c == '=') break;
    word = word << 6 | unsigned(digits.find(c)), bits += 6;
    if (bits >= 8) bits -= 8, bytes.push_back(char(word >> bits & 255));
  }
  const ScratchFolder folder;
  std::ofstream(folder / "map.png", std::ios::binary) << bytes;
  return read_ldr(folder / "map.png");
}

void expect_colour(const Image& map, int x, int y, const std::array<float, 3>& code) {
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(map.at(x, y)[c], code[c], 0.51 / 255) << x << " " << y;
}

TEST(ValidationPage, HasEveryLawItsVerdictAndTheCommandOfAViolation) {
  const std::string page = page_of("oren_nayar:reflectance=1,sigma=0.2");
  EXPECT_THAT(page, HasSubstr("✗ 1 violated"));
  for (const char* law :
       {"finiteness", "positivity", "reciprocity", "energy conservation", "pdf normalisation",
        "chi-square of directions", "bounded weights", "channels do not mix"})
    EXPECT_THAT(page, HasSubstr("<td>" + std::string(law) + "<td>"));
  EXPECT_THAT(page, HasSubstr("--albedo</code>"));
  EXPECT_THAT(page, HasSubstr("Directional albedo"));
  EXPECT_THAT(page_of("lambert"), HasSubstr("✓ holds"));
}

TEST(ValidationPage, MapsOfLambertAreOfOneColour) {
  const auto maps = embedded(page_of("lambert"));
  ASSERT_EQ(maps.size(), 4u); // f at three azimuths, and reciprocity
  for (std::size_t i = 0; i < 4; ++i) {
    const Image map = decoded(maps[i]);
    for (const int cell : {0, 17, 44, 89})
      expect_colour(map, cell, 89 - cell / 2, error_colour(i < 3 ? 1.0f : 0.0f));
  }
}

// phong: f(o, i) = lobe / cos_i, so |f - f'| / mean is 2 |cos_o - cos_i| / (cos_o + cos_i).
TEST(ValidationPage, MapShowsByHowMuchReciprocityIsBroken) {
  const auto maps = embedded(page_of("phong:ks=1,exponent=1"));
  ASSERT_EQ(maps.size(), 4u);
  const Image map = decoded(maps[3]);
  const auto cosine = [](int cell) { return std::cos((cell + 0.5) * std::acos(-1.0) / 180); };
  for (const auto& [o, i] : {std::pair{10, 60}, {60, 10}, {5, 45}}) {
    const double departure = 2 * std::abs(cosine(o) - cosine(i)) / (cosine(o) + cosine(i));
    expect_colour(map, o, 89 - i, error_colour(float(1 + std::log10(departure) / 12)));
  }
  expect_colour(map, 30, 89 - 30, error_colour(0));
}

// Both axes go on below a surface that transmits; f of glass there is the light that goes through.
TEST(ValidationPage, WhatTransmitsIsMappedBelowTheSurfaceToo) {
  const auto maps = embedded(page_of("ggx_dielectric:alpha_x=0.5,alpha_y=0.5"));
  ASSERT_EQ(maps.size(), 4u);
  const Image map = decoded(maps[0]);
  const float dark = error_colour(0)[0];
  EXPECT_GT(map.at(5, 2)[0], dark + 0.2f);  // theta_o 11, theta_i 175: straight on
  EXPECT_GT(map.at(84, 5)[0], dark + 0.2f); // both below
}

} // namespace
} // namespace nacre

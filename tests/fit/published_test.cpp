#include "fit/published.h"

#include "core/error.h"
#include "fit/synthetic.h"

#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

const std::string data = NACRE_SOURCE_DIR "/../shared/data/";

nlohmann::json ward_fit() {
  return nlohmann::json::parse(R"({"source": "x", "materials": {"red": [
    {"model": "Lambertian", "albedo": [0.3, 0.1, 0.05]},
    {"model": "NganWard", "albedo": [0.1, 0.2, 0.15], "roughness": 0.12}]}})");
}

std::string error_of(const nlohmann::json& json) {
  try {
    published_from_json(json, "f.json");
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST(PublishedSets, BecomeMaterialsWithTheMetricOfTheirPaper) {
  const PublishedSet set = published_from_json(ward_fit(), "dir/ngan_ward.json");
  ASSERT_NE(set.find("red"), nullptr);
  EXPECT_EQ(set.find("blue"), nullptr);
  EXPECT_EQ(set.name, "ngan_ward");
  const PublishedFit& fit = *set.find("red");
  EXPECT_EQ(fit.options.metric, Metric::cosine);
  EXPECT_EQ(fit.options.model, "ward+lambert");
  const auto same = parse_material("lambert:reflectance=0.3/0.1/0.05+"
                                   "ward:specular_reflectance=0.1/0.2/0.15,alpha_x=0.12,alpha_y=0.12");
  for (std::size_t l = 0; l < 2; ++l)
    EXPECT_EQ(fit.published.lobes[l].values, same.lobes[l].values);
}

TEST(PublishedSets, WhatIsWrongIsNamedWithItsMaterial) {
  using testing::AllOf;
  using testing::HasSubstr;
  EXPECT_THAT(error_of(nlohmann::json::array()), HasSubstr("materials"));
  auto json = ward_fit();
  json["materials"]["red"][1]["model"] = "NganWrad";
  EXPECT_THAT(error_of(json), AllOf(HasSubstr("red"), HasSubstr("NganWard")));
  json = ward_fit();
  json["materials"]["red"][1]["roughness"] = 7;
  EXPECT_THAT(error_of(json), AllOf(HasSubstr("alpha_x"), HasSubstr("found 7")));
  json = ward_fit();
  json["materials"]["red"][1].erase("roughness");
  EXPECT_THAT(error_of(json), HasSubstr("'roughness' is missing"));
  json = ward_fit();
  json["materials"]["red"][1]["albedo"] = {1, 2};
  EXPECT_THAT(error_of(json), HasSubstr("three numbers"));
  json = ward_fit();
  json["materials"]["red"] = 3;
  EXPECT_THAT(error_of(json), HasSubstr("1 to 4 lobes"));
}

// read_published throws for a value outside: a fit inside narrower bounds could lose against the publication.
TEST(PublishedSets, AllPublishedParametersLieInsideTheDomains) {
  if (!std::filesystem::exists(data + "fits")) GTEST_SKIP() << "no published fits at " << data;
  std::size_t fits = 0;
  for (const auto& entry : std::filesystem::directory_iterator(data + "fits"))
    fits += read_published(entry.path().string()).fits.size();
  EXPECT_EQ(fits, 7u * 86 + 7 * 100);
}

TEST(PublishedSets, AFitOfTheSameModelIsNeverWorse) {
  if (!std::filesystem::exists(data + "fits")) GTEST_SKIP() << "no published fits at " << data;
  // A material that none of the models describes, at MERL's spacing but coarse.
  const MerlTable table = tabulate("ggx_conductor:eta=0.3,k=3,alpha_x=0.12,alpha_y=0.12+"
                                   "oren_nayar:reflectance=0.2/0.1/0.05,sigma=0.7",
                                   0.02, 3, {45, 30, 30});
  const FitData data_of_table(table);
  for (const char* name : {"ngan_ward", "ngan_cooktorrance", "ngan_lafortune", "low_ashikhminshirley_E2",
                           "low_lowmicrofacet_E2"}) {
    const PublishedSet set = read_published(data + "fits/" + name + ".json");
    const PublishedComparison c =
        compare_with_published(data_of_table, set, *set.find("gold-metallic-paint"), {});
    EXPECT_LE(c.fitted, c.published) << name;
    EXPECT_GT(c.fitted, 0) << name;
  }
}

} // namespace
} // namespace nacre

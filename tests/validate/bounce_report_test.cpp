#include "validate/bounce_report.h"

#include "bsdf/models/rough_conductor.h"
#include "core/quadrature.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

BounceOptions small() {
  BounceOptions options;
  options.alphas = {1.0};
  options.thetas_deg = {60};
  options.lobe_thetas_deg = {};
  options.nodes = 2000;
  options.walks = 2000;
  return options;
}

TEST(BounceReport, ComparesEveryWay) {
  const BounceReport report = compare_bounces(small());
  ASSERT_EQ(report.cells.size(), 11u); // two metals by four ways, glass by three
  for (const BounceCell& c : report.cells)
    if (c.material == "white") {
      EXPECT_NEAR(c.walk, 1, 1e-3);
      EXPECT_NEAR(c.albedo, c.way == "ggx_conductor" ? 0.4507 : 1, 0.01) << c.way;
    }
  EXPECT_THAT(to_text(report), testing::HasSubstr("| invariance_conductor |"));
  EXPECT_EQ(to_json(report)["cells"].size(), 11u);
}

/// By another quadrature: over directions instead of visible normals.
double kept_by_quadrature(double alpha) {
  GgxConductor<double, 1> m = default_model<GgxConductor<double, 1>>();
  m.eta[0] = 1e-3, m.k[0] = 1e5, m.alpha_x = m.alpha_y = alpha;
  return integrate(gauss_legendre(24, 0, 1), [&](double c) {
    const Vec3d wo{std::sqrt(1 - c * c), 0, c};
    return 2 * c * integrate_hemisphere([&](const Vec3d& wi) { return m.eval(wo, wi)[0] * wi.z; }, 160, 96);
  });
}

/// Pinned to four digits: hemispherical albedo of white GGX facets with correlated heights, one bounce.
TEST(BounceReport, EnergyThatSingleScatteringKeepsIsPinned) {
  BounceOptions options = small();
  options.alphas = {0.1, 0.3, 0.5, 0.7, 1.0};
  options.thetas_deg = {};
  const BounceReport report = compare_bounces(options);
  const double kept[] = {0.9718, 0.8469, 0.7002, 0.5663, 0.4091};
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_NEAR(report.kept[i], kept[i], 1e-4) << options.alphas[i];
  EXPECT_NEAR(kept_by_quadrature(0.5), report.kept[2], 3e-4);
  EXPECT_NEAR(kept_by_quadrature(1.0), report.kept[4], 1e-4);
}

/// The table of docs/models/multiple-bounces.md.
TEST(LongBounceReport, EachWayIsAsFarFromTheWalkAsDocumented) {
  const BounceReport report = compare_bounces();
  puts(to_text(report).c_str());
  for (const BounceCell& c : report.cells) {
    const std::string where =
        c.material + " " + c.way + " " + std::to_string(c.alpha) + " " + std::to_string(c.theta_deg);
    const bool single = c.way == "ggx_conductor" || c.way == "ggx_dielectric";
    if (c.material == "white") {
      EXPECT_NEAR(c.walk, 1, 1e-4) << where;
      EXPECT_TRUE(single || std::abs(c.albedo - 1) < 5e-3) << where << " " << c.albedo;
    }
    if (c.material == "glass") {
      EXPECT_NEAR(c.walk, 1, 1e-3) << where;
      EXPECT_TRUE(single || std::abs(c.albedo - 1) < 5e-3) << where << " " << c.albedo;
    }
    if (c.material == "gold" && !single) {
      const double far = c.way == "invariance_conductor"    ? 0.035
                         : c.way == "kulla_conty_conductor" ? 0.05
                                                            : 0.07;
      EXPECT_NEAR(c.albedo, c.walk, far) << where;
    }
    if (c.lobe >= 0 && c.way == "invariance_conductor") {
      EXPECT_LT(c.lobe, c.lobe_noise + 0.025) << where;
    }
  }
}

} // namespace
} // namespace nacre

#include "spectra/named_ior.h"

#include "core/quadrature.h"
#include "spectra/illuminants.h"
#include "spectra/ior.h"

#include <complex>
#include <gtest/gtest.h>

namespace nacre {
namespace {

double fresnel(double cos_i, double eta, double k) {
  const std::complex<double> n(eta, k), ct = std::sqrt(1.0 - (1 - cos_i * cos_i) / (n * n));
  return 0.5 *
         (std::norm((cos_i - n * ct) / (cos_i + n * ct)) + std::norm((n * cos_i - ct) / (n * cos_i + ct)));
}
RGB spectral(const ConductorIor& metal, double cos_i) {
  return xyz_to_srgb * integrate_xyz([&](float l) {
           return fresnel(cos_i, metal.eta.eval(l), metal.k.eval(l)) * static_cast<double>(unit_d65()(l));
         });
}

TEST(NamedIor, MetalsHaveTheirColorAtNormalIncidence) {
  for (const auto& name : metal_names()) {
    const RgbIor ior = metal_rgb(name).value();
    const RGB wanted = spectral(*find_metal(name), 1);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(fresnel(1, ior.eta[i], ior.k[i]), std::clamp(wanted[i], 0.0, 1.0), 1e-4)
          << name << " " << i;
      EXPECT_TRUE(ior.eta[i] >= 0.01 && ior.eta[i] <= 20 && ior.k[i] >= 0 && ior.k[i] <= 30)
          << name << " " << ior.eta[i] << " " << ior.k[i];
    }
  }
}

TEST(NamedIor, MetalsKeepTheirColorAwayFromNormalIncidence) {
  const QuadratureRule rule = gauss_legendre(12, 0, 1);
  for (const auto& name : metal_names()) {
    const RgbIor ior = metal_rgb(name).value();
    RGB exact{}, channels{};
    for (std::size_t n = 0; n < rule.node.size(); ++n) {
      const double mu = rule.node[n], weight = 2 * mu * rule.weight[n];
      const RGB s = spectral(*find_metal(name), mu);
      for (int i = 0; i < 3; ++i) {
        exact[i] += weight * s[i];
        channels[i] += weight * fresnel(mu, ior.eta[i], ior.k[i]);
      }
    }
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(channels[i], std::min(exact[i], 1.0), 0.01) << name << " " << i;
    }
  }
}

TEST(NamedIor, GoldCopperAndSilverAreOfThePublishedOrder) {
  // Values that shading tables of the field give for gold: eta (0.14, 0.37, 1.44), k (3.98, 2.39, 1.60).
  const RgbIor gold = metal_rgb("Au").value();
  EXPECT_NEAR(gold.eta[1], 0.37, 0.15);
  EXPECT_NEAR(gold.k[1], 2.39, 0.3);
  EXPECT_NEAR(gold.eta[2], 1.44, 0.2);
  EXPECT_NEAR(gold.k[2], 1.60, 0.3);
  EXPECT_FALSE(metal_rgb("gold-plated").has_value());
}

TEST(NamedIor, GlassesHaveTheirIndex) {
  EXPECT_NEAR(glass_eta("BK7").value(), 1.5168, 1e-5);
  EXPECT_NEAR(glass_eta("SF11").value(), 1.78472, 1e-5);
  EXPECT_EQ(glass_eta("pyrex"), 1.470);
  EXPECT_EQ(glass_eta("unknown"), std::nullopt);
}

} // namespace
} // namespace nacre

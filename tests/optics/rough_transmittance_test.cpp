#include "optics/rough_transmittance.h"

#include "optics/fresnel.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

const RoughTransmittance& ggx() { return RoughTransmittance::table<Ggx>(); }

TEST(RoughTransmittance, OfASmoothInterfaceIsFresnels) {
  for (const double eta : {1.1, 1.5, 2.3})
    for (const double c : {1.0, 0.8, 0.5, 0.3, 0.1})
      EXPECT_NEAR(ggx().outside(c, 0.0, eta), 1 - fresnel_dielectric(c, eta).reflectance, 4e-3)
          << c << " " << eta;
}

TEST(RoughTransmittance, InsideOfASmoothInterfaceIsWalshsAverage) {
  for (const double eta : {1.05, 1.313636364, 1.5, 2.5})
    EXPECT_NEAR(ggx().diffuse_reflectance_inside(0.0, eta), fresnel_dielectric_average_inside(eta), 4e-3)
        << eta;
}

TEST(RoughTransmittance, FallsWithRoughnessByWhatMultipleBouncesWouldCarry) {
  double last = 1;
  for (const double alpha : {0.01, 0.1, 0.3, 0.6, 1.0}) {
    const double T = ggx().outside(0.6, alpha, 1.5);
    EXPECT_LT(T, last);
    EXPECT_GT(T, 0.4);
    last = T;
  }
}

TEST(RoughTransmittance, IsTheSameForPacksAndDoubles) {
  for (const double c : {0.03, 0.4, 0.97})
    EXPECT_NEAR(lane(ggx().outside(Pack(float(c)), Pack(0.37f), Pack(1.6f)), 0),
                ggx().outside(c, double(0.37f), double(1.6f)), 1e-5);
}

} // namespace
} // namespace nacre

#pragma once
// The diffuse light below a glossy layer, less of it towards grazing angles of either direction as the layer
// keeps it: the companion of ashikhmin_shirley with the same f0. Keeps all laws. Source: Ashikhmin and
// Shirley 2000, An Anisotropic Phong BRDF Model, eq. 5.

#include "bsdf/model.h"
#include "core/warp.h"

namespace nacre {

template <class R, int C>
struct AshikhminShirleyDiffuse : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color reflectance, f0;

  static constexpr std::string_view name = "ashikhmin_shirley_diffuse";
  static constexpr std::string_view source = "Ashikhmin and Shirley 2000, eq. 5";
  static constexpr std::string_view summary = "diffuse reflection below a glossy layer";
  static constexpr auto parameters() {
    using M = AshikhminShirleyDiffuse;
    return std::tuple{Parameter{&M::reflectance, "reflectance", "1", 0, 1, 0.5, "albedo of the base"},
                      Parameter{&M::f0, "f0", "1", 0, 1, 0.04,
                                "reflectance of the layer at normal incidence; 1 - f0 reaches the base",
                                false}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto up = same_upper_side(wo, wi);
    const R passages = constant<R>(28 / 23.0 * inv_pi) * passage(wo.z) * passage(wi.z);
    Color f;
    for (int c = 0; c < C; ++c)
      f[c] = reflectance[c] * (R(1) - f0[c]) * passages;
    return select(up, f, Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    return select(same_upper_side(wo, wi), wi.z * constant<R>(inv_pi), R(0));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& u) const {
    const Vec3<R> wi = square_to_cosine_hemisphere(u);
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

private:
  static R passage(const R& cos_theta) {
    const R x = R(1) - R(0.5f) * max(cos_theta, R(0)), x2 = x * x;
    return R(1) - x2 * x2 * x;
  }
};

} // namespace nacre

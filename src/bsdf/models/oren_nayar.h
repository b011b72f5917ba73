#pragma once
// Diffuse reflection from a surface of V-shaped Lambertian cavities: brighter towards the light than Lambert,
// flatter at the limb. Clay, plaster, the full moon. The paper's qualitative model (without interreflection).
// Reciprocal and positive; its fit gains up to 1.6 % energy at grazing angles when sigma is near 0.2 rad.
// Source: Oren and Nayar 1994, Generalization of Lambert's Reflectance Model, eq. 30.

#include "bsdf/model.h"
#include "core/warp.h"

namespace nacre {

template <class R, int C>
struct OrenNayar : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color reflectance;
  R sigma;

  static constexpr std::string_view name = "oren_nayar";
  static constexpr std::string_view source = "Oren and Nayar 1994, eq. 30";
  static constexpr std::string_view summary = "rough diffuse reflection, V-cavities";
  static constexpr Laws laws{.energy_gain = 0.016};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&OrenNayar::reflectance, "reflectance", "1", 0, 1, 0.5, "albedo of the facets"},
        Parameter{&OrenNayar::sigma, "sigma", "rad", 0, 1.5, 0.3, "standard deviation of facet slope angle"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto up = same_upper_side(wo, wi);
    const R s2 = sigma * sigma;
    const R A = R(1) - R(0.5f) * s2 / (s2 + R(0.33f));
    const R B = R(0.45f) * s2 / (s2 + R(0.09f));
    // cos(phi_i - phi_o) sin(alpha) tan(beta), with alpha the larger and beta the smaller angle
    const R geometry = max(wo.x * wi.x + wo.y * wi.y, R(0)) / select(up, max(wo.z, wi.z), R(1));
    return select(up, reflectance * (constant<R>(inv_pi) * (A + B * geometry)), Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    return select(same_upper_side(wo, wi), wi.z * constant<R>(inv_pi), R(0));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& u) const {
    const Vec3<R> wi = square_to_cosine_hemisphere(u);
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }
};

} // namespace nacre

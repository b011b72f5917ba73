#pragma once
// Ideal diffuse reflection: the same radiance into every direction. Keeps all laws. The first approximation
// of matte paint, paper and plaster away from grazing angles. Source: Lambert 1760, Photometria; f = rho /
// pi, Nicodemus et al. 1977.

#include "bsdf/model.h"
#include "core/warp.h"

namespace nacre {

template <class R, int C>
struct Lambert : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color reflectance;

  static constexpr std::string_view name = "lambert";
  static constexpr std::string_view source = "Lambert 1760, Photometria";
  static constexpr std::string_view summary = "ideal diffuse reflection";
  static constexpr auto parameters() {
    return std::tuple{Parameter{&Lambert::reflectance, "reflectance", "1", 0, 1, 0.5, "directional albedo"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    return select(same_upper_side(wo, wi), reflectance * constant<R>(inv_pi), Color());
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

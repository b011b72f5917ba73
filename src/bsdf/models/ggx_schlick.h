#pragma once
// The workhorse of fitting: single reflection from isotropic GGX facets with Schlick's Fresnel and a colour
// at normal incidence. Together with `lambert` it describes most plastics, paints and metals. Reciprocal,
// positive, loses the energy of multiple bounces. Source: Walter et al. 2007, eq. 20; Schlick 1994, eq. 15.

#include "bsdf/microfacet_reflection.h"
#include "optics/fresnel.h"

namespace nacre {

template <class R, int C>
struct GgxSchlick : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color f0;
  R alpha;

  static constexpr std::string_view name = "ggx_schlick";
  static constexpr std::string_view source = "Walter et al. 2007, eq. 20; Schlick 1994, eq. 15";
  static constexpr std::string_view summary =
      "rough reflection with a colour at normal incidence, GGX facets";
  static constexpr auto parameters() {
    return std::tuple{Parameter{&GgxSchlick::f0, "f0", "1", 0, 1, 0.04, "reflectance at normal incidence"},
                      Parameter{&GgxSchlick::alpha, "alpha", "1", 1e-3, 1, 0.2, "roughness"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto facets = reflect_from_facets(distribution(), wo, wi, R(0));
    return f0.map([&](const R& f) { return R(fresnel_schlick(facets.cos_m, f) * facets.value); });
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const { return facet_reflection_pdf(distribution(), wo, wi); }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& u) const {
    const Vec3<R> wi = reflect(wo, distribution().sample_visible(wo, u));
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

  /// The microsurface, for the validator and plots.
  Ggx<R> distribution() const { return {alpha, alpha}; }
};

} // namespace nacre

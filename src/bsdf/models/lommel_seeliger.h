#pragma once
// Light scattered once in a deep, dark powder of isotropic scatterers: a flat disk of a moon, no darkening of
// the limb. Reciprocal; reflects at most half of the light. Source: Seeliger 1888, Zur Photometrie
// zerstreut reflectirender Substanzen; Hapke 1981, Bidirectional Reflectance Spectroscopy 1, eq. 7.

#include "bsdf/hemisphere_lobes.h"
#include "bsdf/model.h"

namespace nacre {

template <class R, int C>
struct LommelSeeliger : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color albedo;

  static constexpr std::string_view name = "lommel_seeliger";
  static constexpr std::string_view source = "Seeliger 1888; Hapke 1981, eq. 7";
  static constexpr std::string_view summary = "single scattering in a deep dark powder, lunar";
  static constexpr auto parameters() {
    return std::tuple{Parameter{&LommelSeeliger::albedo, "albedo", "1", 0, 1, 0.5,
                                "share of light scattered per collision"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto up = same_upper_side(wo, wi);
    return select(up, albedo * (constant<R>(0.25 * inv_pi) / select(up, wo.z + wi.z, R(1))), Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    return select(same_upper_side(wo, wi), diffusing_lobe(wo).pdf(wi), R(0));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& u) const {
    const Vec3<R> wi = diffusing_lobe(wo).sample(u);
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }
};

} // namespace nacre

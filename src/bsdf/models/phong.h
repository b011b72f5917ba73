#pragma once
// The first glossy reflection of computer graphics, in its published form: the highlight is added to a
// pixel as k_s cos^n(alpha), alpha from the mirror direction, without the cosine of incidence; so as a BRDF
// it is divided by that cosine. Not reciprocal, grows without bound towards grazing light, and the albedo is
// 2 pi / (n + 1) times k_s wherever the lobe is above the horizon, up to pi (Lewis 1993, Making Shaders More
// Physically Plausible). Use `modified_phong` in its place.
// Source: Phong 1975, Illumination for Computer Generated Pictures; CACM 18(6), p. 315.

#include "bsdf/power_lobe.h"

namespace nacre {

template <class R, int C>
struct Phong : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color ks;
  R exponent;

  static constexpr std::string_view name = "phong";
  static constexpr std::string_view source = "Phong 1975; Lewis 1993";
  static constexpr std::string_view summary = "the original highlight, not normalised, as it was published";
  static constexpr Laws laws{.reciprocal = false,
                             .energy_gain = pi - 1}; // at k_s = 1, n = 1, along the normal
  static constexpr auto parameters() {
    return std::tuple{Parameter{&Phong::ks, "ks", "1", 0, 1, 0.5, "peak of the highlight"},
                      Parameter{&Phong::exponent, "exponent", "1", 1, 2e5, 20, "sharpness n"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto up = same_upper_side(wo, wi);
    return select(up, ks * (lobe(wo).value(wi) / select(up, wi.z, R(1))), Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    return select(same_upper_side(wo, wi), lobe(wo).density(wi), R(0));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& u) const {
    const Vec3<R> wi = lobe(wo).sample(u);
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

private:
  PowerLobe<R> lobe(const Vec3<R>& wo) const { return {mirrored(wo), exponent}; }
};

} // namespace nacre

#pragma once
// A polished interface between two transparent media: glass, water. Light is mirrored or refracted, by
// Fresnel and Snell. Keeps all laws; radiance that enters the denser medium is compressed by eta^2. Source:
// Born and Wolf, Principles of Optics, 7th ed., section 1.5; radiance scaling: Veach 1997, section 5.2.

#include "bsdf/model.h"
#include "optics/fresnel.h"

namespace nacre {

template <class R, int C>
struct SmoothDielectric : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  R eta;
  Color specular_reflectance, specular_transmittance;

  static constexpr std::string_view name = "smooth_dielectric";
  static constexpr std::string_view source = "Born and Wolf, section 1.5";
  static constexpr std::string_view summary = "polished glass, mirror reflection and refraction";
  static constexpr Laws laws{.transmits = true};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&SmoothDielectric::eta, "eta", "1", 0.25, 4, 1.5, "index inside / index outside"},
        Parameter{&SmoothDielectric::specular_reflectance, "specular_reflectance", "1", 0, 1, 1.0,
                  "factor on the reflection; 1 is physical", false},
        Parameter{&SmoothDielectric::specular_transmittance, "specular_transmittance", "1", 0, 1, 1.0,
                  "factor on the transmission; 1 is physical", false}};
  }

  Color eval(const Vec3<R>&, const Vec3<R>&) const { return Color(); }
  R pdf(const Vec3<R>&, const Vec3<R>&) const { return R(0); }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& /*u*/) const {
    const auto fresnel = fresnel_dielectric(wo.z, eta);
    const R F = fresnel.reflectance;
    const auto reflected = u_lobe < F;
    const R inv_eta = R(1) / fresnel.eta_ti;
    const Vec3<R> wi = select(reflected, Vec3<R>{-wo.x, -wo.y, wo.z},
                              Vec3<R>{-wo.x * inv_eta, -wo.y * inv_eta, fresnel.cos_t});
    const R pdf = select(reflected, F, R(1) - F);
    const auto valid = (abs(wi.z) > R(0)) & (abs(wo.z) > R(0));
    const R inv_cos = R(1) / select(valid, abs(wi.z), R(1));
    const Color f = select(reflected, specular_reflectance * (F * inv_cos),
                           specular_transmittance * ((R(1) - F) * inv_cos * inv_eta * inv_eta));
    return {wi, select(valid, f, Color()), select(valid, pdf, R(0)), mask_t<R>(true)};
  }
};

} // namespace nacre

#pragma once
// A sheet of polished glass, so thin that light leaves it where it came in: window panes, soap bubbles,
// cellophane. All bounces between its two faces, added as intensities: a pane of more than some wavelengths.
// Mirror reflection, and transmission without a change of direction. Keeps all laws. Source: Stokes 1862, On
// the Intensity of the Light Reflected from or Transmitted through a Pile of Plates, eq. 4; PBR 4th ed.,
// section 9.5.1.

#include "bsdf/model.h"
#include "optics/fresnel.h"

namespace nacre {

template <class R, int C>
struct ThinDielectric : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  R eta;
  Color specular_reflectance, specular_transmittance;

  static constexpr std::string_view name = "thin_dielectric";
  static constexpr std::string_view source = "Stokes 1862, eq. 4; PBR 4th ed., section 9.5.1";
  static constexpr std::string_view summary = "thin sheet of polished glass";
  static constexpr Laws laws{.transmits = true, .thin = true};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&ThinDielectric::eta, "eta", "1", 0.25, 4, 1.5, "index of the sheet / index around it"},
        Parameter{&ThinDielectric::specular_reflectance, "specular_reflectance", "1", 0, 1, 1.0,
                  "factor on the reflection; 1 is physical", false},
        Parameter{&ThinDielectric::specular_transmittance, "specular_transmittance", "1", 0, 1, 1.0,
                  "factor on the transmission; 1 is physical", false}};
  }

  Color eval(const Vec3<R>&, const Vec3<R>&) const { return Color(); }
  R pdf(const Vec3<R>&, const Vec3<R>&) const { return R(0); }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& /*u*/) const {
    const R one_face = fresnel_dielectric(abs(wo.z), eta).reflectance;
    // F + T^2 F + T^2 F^3 + ... with T = 1 - F; the rest goes through.
    const R reflected = R(2) * one_face / (R(1) + one_face);
    const auto mirror = u_lobe < reflected, crosses = wo.z != R(0);
    const R p = select(mirror, reflected, R(1) - reflected);
    const Color f =
        select(mirror, specular_reflectance, specular_transmittance) * (p / select(crosses, abs(wo.z), R(1)));
    return {select(mirror, Vec3<R>{-wo.x, -wo.y, wo.z}, -wo), select(crosses, f, Color()),
            select(crosses, p, R(0)), mask_t<R>(true)};
  }
};

} // namespace nacre

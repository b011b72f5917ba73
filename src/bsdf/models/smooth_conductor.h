#pragma once
// A polished metal: mirror reflection with Fresnel's equations for a complex index. Keeps all laws.
// Source: Born and Wolf, Principles of Optics, 7th ed., section 14.2.

#include "bsdf/model.h"
#include "optics/fresnel.h"

namespace nacre {

template <class R, int C>
struct SmoothConductor : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color eta, k, specular_reflectance;

  static constexpr std::string_view name = "smooth_conductor";
  static constexpr std::string_view source = "Born and Wolf, section 14.2";
  static constexpr std::string_view summary = "polished metal, mirror reflection";
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&SmoothConductor::eta, "eta", "1", 0.01, 20, 1.0, "real part of the complex index"},
        Parameter{&SmoothConductor::k, "k", "1", 0, 30, 6.0, "imaginary part of the index, absorption"},
        Parameter{&SmoothConductor::specular_reflectance, "specular_reflectance", "1", 0, 1, 1.0,
                  "factor on the reflection; 1 is physical", false}};
  }

  Color eval(const Vec3<R>&, const Vec3<R>&) const { return Color(); }
  R pdf(const Vec3<R>&, const Vec3<R>&) const { return R(0); }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& /*u*/) const {
    const auto up = wo.z > R(0);
    const R c = select(up, wo.z, R(1));
    Color f;
    for (int i = 0; i < C; ++i)
      f[i] = specular_reflectance[i] * fresnel_conductor(c, eta[i], k[i]) / c;
    return {{-wo.x, -wo.y, wo.z}, select(up, f, Color()), select(up, R(1), R(0)), mask_t<R>(true)};
  }
};

} // namespace nacre

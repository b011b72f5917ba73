#pragma once
// The rough surface of a clear coat as light meets it from both sides: reflection outside, reflection inside,
// passage. The passage is kept in its symmetric form, without the eta^2 that radiance gains on entering and
// loses on leaving: a path that ends above the coat does both as often.

#include "bsdf/microfacet_reflection.h"
#include "optics/fresnel.h"

namespace nacre {

/// GGX facets of a dielectric. Source: Walter et al. 2007, eq. 20, 21.
template <class R>
struct CoatInterface {
  R eta;   ///< index of the coat / index outside, at least 1.05: the half vector of a passage needs a bend
  R alpha; ///< roughness, at least 1e-3

  Ggx<R> facets() const { return {alpha, alpha}; }

  /// BRDF of the outer side, directions above.
  R reflect_outside(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto f = reflect_from_facets(facets(), wo, wi, R(0));
    return fresnel_dielectric(f.cos_m, eta).reflectance * f.value;
  }
  /// BRDF of the inner side, directions mirrored to lie above.
  R reflect_inside(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto f = reflect_from_facets(facets(), wo, wi, R(0));
    return fresnel_dielectric(-f.cos_m, eta).reflectance * f.value;
  }

  /// value: eq. 21 without eta^2, symmetric; density: of `below` when `above` is refracted in a visible
  /// normal.
  struct Passage {
    R value, density;
  };
  Passage pass(const Vec3<R>& above, const Vec3<R>& below) const {
    const auto usable = (above.z > R(0)) & (below.z < R(0));
    const Vec3<R> a = select(usable, above, Vec3<R>{R(0), R(0), R(1)});
    const Vec3<R> b = select(usable, below, Vec3<R>{R(0), R(0), R(-1)});
    const Vec3<R> h = a + b * eta; // eq. 16; no shorter than eta - 1
    const R l2 = length_squared(h);
    const Vec3<R> wm = h * (R(-1) / sqrt(l2));
    const R c_a = dot(a, wm), c_b = -dot(b, wm);
    const auto facing = usable & (wm.z > R(0)) & (c_a > R(0)) & (c_b > R(0));
    const Ggx<R> d = facets();
    const R visible = d.D(wm) * c_a / (a.z + d.lambda_cos(a));
    const R jacobian = c_b / l2; // without eta^2, eq. 17
    const R F = fresnel_dielectric(c_a, eta).reflectance;
    const R cos_b = -b.z, g1_cos = R(1) / (cos_b + d.lambda_cos({b.x, b.y, cos_b}));
    return {select(facing, (R(1) - F) * visible * jacobian * g1_cos, R(0)),
            select(facing, visible * jacobian * eta * eta, R(0))};
  }
  /// `above` refracted in one of the facets it sees; not below (z >= 0) when the facet is too steep.
  Vec3<R> sample_pass(const Vec3<R>& above, const Vec2<R>& u) const {
    const Vec3<R> wm = facets().sample_visible(above, u);
    return refract_in(above, wm, R(1) / eta);
  }
  /// Snell: w above refracted in the facet wm it faces. The caller excludes total reflection.
  /// @param ratio  index on w's side / index on the other
  static Vec3<R> refract_in(const Vec3<R>& w, const Vec3<R>& wm, const R& ratio) {
    const R c = dot(w, wm);
    const R cos_t = safe_sqrt(R(1) - ratio * ratio * max(R(1) - c * c, R(0)));
    return normalize(wm * (ratio * c - cos_t) - w * ratio);
  }
};

} // namespace nacre

#pragma once
// Single reflection from a microfacet surface, whatever its distribution and Fresnel term: the part that all
// rough reflecting models share.

#include "bsdf/model.h"
#include "optics/microfacet.h"

namespace nacre {

/// D(wm) G2 / (4 cos_o cos_i) at the half vector, Walter et al. 2007, eq. 20 without F; `cos_m` is wo . wm,
/// the angle of Fresnel. Zero below the surface.
template <class R>
struct FacetReflection {
  R value, cos_m;
  mask_t<R> valid;
};

/// Half vector of two directions above the surface; the normal where `valid` is false: below, or so near the
/// horizon and opposite each other that their sum vanishes.
template <class R>
struct UpperHalfVector {
  Vec3<R> wm;
  mask_t<R> valid;

  UpperHalfVector(const Vec3<R>& wo, const Vec3<R>& wi) {
    const Vec3<R> sum = wo + wi, up{R(0), R(0), R(1)};
    valid = same_upper_side(wo, wi) & (length_squared(sum) > R(1e-30f));
    wm = normalize(select(valid, sum, up));
  }
};

template <class Distribution, class R>
FacetReflection<R> reflect_from_facets(const Distribution& d, const Vec3<R>& wo, const Vec3<R>& wi,
                                       const R& separable) {
  const auto [wm, valid] = UpperHalfVector<R>(wo, wi);
  const Vec3<R> up{R(0), R(0), R(1)};
  const Vec3<R> o = select(valid, wo, up), i = select(valid, wi, up);
  return {select(valid, d.D(wm) * visibility(d, o, i, separable), R(0)), dot(o, wm), valid};
}

/// Density of wi when normals are sampled by visibility and wo is mirrored in them: D_visible / (4 wo . wm),
/// eq. 17 of Heitz 2014.
template <class Distribution, class R>
R facet_reflection_pdf(const Distribution& d, const Vec3<R>& wo, const Vec3<R>& wi) {
  const auto [wm, valid] = UpperHalfVector<R>(wo, wi);
  const Vec3<R> up{R(0), R(0), R(1)};
  const Vec3<R> o = select(valid, wo, up);
  return select(valid, R(0.25f) * d.visible_density(o, wm), R(0));
}

} // namespace nacre

#pragma once
// Masking and shadowing by symmetric V-shaped grooves, each much longer than wide, and normals as such a
// surface shows them: the geometry of Torrance and Sparrow 1967, Cook and Torrance 1982. Each groove has two
// facets with normals wm = (x, y, z) and wm' = (-x, -y, z), so a groove is sampled first and then the facet
// that is seen. Source: Torrance and Sparrow 1967, appendix; sampling: Heitz and d'Eon 2014, Importance
// Sampling Microfacet-Based BSDFs using the Distribution of Visible Normals, section 4.2.

#include "core/vec.h"

namespace nacre {

/// G / (cos_o cos_i) with G = min(1, 2 cos_m cos_o / cos_om, 2 cos_m cos_i / cos_om).
/// All cosines > 0, as HalfSum has them.
/// @param cos_om  wo . wm = wi . wm
/// @param cos_m   wm . n
template <class R>
R v_cavity_visibility(const R& cos_o, const R& cos_i, const R& cos_om, const R& cos_m) {
  return min(R(1) / (cos_o * cos_i), R(2) * cos_m / (cos_om * max(cos_o, cos_i)));
}

/// G1 = min(1, 2 cos_m cos_w / (w . wm)) on the side of the facet that reflects, else 0.
template <class R>
R v_cavity_masking(const Vec3<R>& w, const Vec3<R>& wm) {
  const R c = dot(w, wm);
  const auto seen = (c > R(0)) & (w.z > R(0));
  return select(seen, min(R(1), R(2) * wm.z * w.z / select(seen, c, R(1))), R(0));
}

/// The facet of wm's groove that `wo` sees: each in proportion to its projected area.
template <class R>
Vec3<R> v_cavity_facet(const Vec3<R>& wo, const Vec3<R>& wm, const R& u) {
  const Vec3<R> other{-wm.x, -wm.y, wm.z};
  const R a = max(dot(wo, wm), R(0)), b = max(dot(wo, other), R(0));
  return select(u * (a + b) < a, wm, other);
}
/// Density of wi, per sr, when normals of this density are drawn, the facet chosen by v_cavity_facet and wo
/// mirrored in it: density 2 cos_om / (cos_om + max(0, wo . wm')) / (4 cos_om). For a density D cos_m of
/// normals these are the visible normals of the grooves.
template <class R>
R v_cavity_pdf(const R& density, const R& cos_o, const R& cos_om, const R& cos_m) {
  return density / (R(2) * max(cos_om, R(2) * cos_o * cos_m));
}

} // namespace nacre

#pragma once
// Light among Smith's microfacets: the steps of a random walk on the microsurface.
//
// Heights enter the model of Heitz et al. 2016 only through the share C1(h) of the surface that lies below h,
// so a walk keeps the depth e = -log C1(h), 0 above the surface, and whether heights are uniform or Gaussian
// makes no difference. Over de a ray meets facets at a constant rate: Lambda(r) going up, 1 + Lambda(-r)
// going down; it leaves the surface from depth e with probability exp(-e Lambda).
// Source: Heitz, Hanika, d'Eon, Dachsbacher 2016, Multiple-Scattering Microfacet BSDFs with the Smith Model.

#include "core/vec.h"

namespace nacre {

/// Bounces after which a walk is given up. White conductors of alpha = 1 lose less than 1e-4 of their light
/// to this (test).
inline constexpr int smith_walk_bounces = 32;

/// Area of the facets that `w` sees, projected along it, per area of the surface: cos theta (1 + Lambda) from
/// above, cos theta Lambda from below. Heitz et al. 2016.
template <class Distribution, class R>
R seen_area(const Distribution& d, const Vec3<R>& w) {
  const Vec3<R> up{w.x, w.y, abs(w.z)};
  return d.lambda_cos(up) + max(w.z, R(0));
}

/// Density of normals that `w` sees, from above or below, divided by w . wm.
template <class Distribution, class R>
R seen_density(const Distribution& d, const Vec3<R>& w, const Vec3<R>& wm) {
  return d.D(wm) / max(seen_area(d, w), R(1e-10f));
}

/// Depth that the ray `r` passes on average between two facets.
template <class Distribution, class R>
R free_path(const Distribution& d, const Vec3<R>& r) {
  return max(abs(r.z), R(1e-9f)) / max(seen_area(d, -r), R(1e-10f));
}

/// Probability that a ray starting upwards at this depth leaves the surface.
template <class R>
R escape_probability(const R& depth, const R& path) {
  return exp(-min(depth / path, R(80)));
}

/// Depth of the next facet that the ray `r` meets; not positive: it has left the surface.
template <class Distribution, class R>
R next_facet(const Distribution& d, const Vec3<R>& r, const R& depth, const R& u) {
  const R step = -log(R(1) - u) * free_path(d, r);
  return select(r.z > R(0), depth - step, depth + step);
}

/// The same for a ray that is known to meet one; `weight` is multiplied by the probability of that.
template <class Distribution, class R>
R next_facet_surely(const Distribution& d, const Vec3<R>& r, const R& depth, const R& u, R& weight) {
  const R path = free_path(d, r), hit = R(1) - escape_probability(depth, path);
  const auto rising = r.z > R(0);
  const R share = select(rising, u * hit, u);
  weight = select(rising, weight * hit, weight);
  const R step = -log(R(1) - share) * path;
  return select(rising, max(depth - step, R(0)), depth + step);
}

/// Depth as seen from the other side, where what lay below lies above: C1 becomes 1 - C1.
template <class R>
R depth_from_other_side(const R& depth) {
  return -log(max(R(1) - exp(-depth), R(1e-20f)));
}

/// Euler's beta function for p, q >= 1: with p = 1 + Lambda_o, q = 1 + Lambda_i the share of facets that are
/// lit from one side and seen from the other at once (Heitz et al. 2016; from the integral over
/// heights of C1^Lambda_o (1 - C1)^Lambda_i). Relative error below 1e-5 as far as p and q are rounded alike.
/// Stirling's series (Abramowitz and Stegun 1964, 6.1.41) after one step of the recurrence.
template <class R>
R beta(const R& p, const R& q) {
  const R a = p + R(1), b = q + R(1), s = a + b;
  const auto tail = [](const R& x) {
    const R inv = R(1) / x, inv2 = inv * inv;
    return inv * (constant<R>(1.0 / 12) - inv2 * (constant<R>(1.0 / 360) - inv2 * constant<R>(1.0 / 1260)));
  };
  // log(1 + x) with the rounding of 1 + x taken out again
  const auto log1p = [](const R& x) {
    const R y = R(1) + x, rounded = y - R(1);
    const auto plain = rounded > R(0);
    return select(plain, log(y) * (x / select(plain, rounded, R(1))), x);
  };
  // a^(a - 1/2) b^(b - 1/2) / s^(s - 1/2) = (1 + b/a)^(1/2 - a) (1 + a/b)^(1/2 - b) / sqrt(s)
  const R exponent =
      (R(0.5f) - a) * log1p(R(b / a)) + (R(0.5f) - b) * log1p(R(a / b)) + tail(a) + tail(b) - tail(s);
  const auto visible = exponent > R(-80); // beyond, float underflows
  const R power = select(visible, exp(select(visible, exponent, R(0))), R(0));
  return constant<R>(std::sqrt(2 * pi)) / sqrt(s) * power * ((p + q) * (s - R(1))) / (p * q);
}

} // namespace nacre

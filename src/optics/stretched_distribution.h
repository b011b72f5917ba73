#pragma once
// A full normal distribution from the isotropic shape of its slopes: anisotropy by stretching them, Smith's
// masking through the shape's own, V-cavity visible normals.

#include "optics/masking_table.h"
#include "optics/microfacet.h"
#include "optics/vcavity_normals.h"

namespace nacre {

/// A Shape offers, with the squared slope r^2 = h2 / z2 of a normal given as numerator and denominator:
///   density(h2, z2)             P22(r^2) / z2^2, in units where the stretch is 1
///   lambda_cos(s, z)            Smith's, for a direction (s, 0, z) of any length
///   radius2(u)                  a squared slope, for sampling
///   sampling_density(h2, z2)    its density as `density` would give it; the same function where sampling is
///                               exact
/// Source of the invariance to stretching: Heitz 2014, section 5.4.
template <class R, class Shape>
struct StretchedDistribution {
  Shape shape;
  R stretch_x, stretch_y;
  const MaskingTable<R>* masking = nullptr; ///< of the shape, or null: computed for each direction
  static constexpr std::string_view name = Shape::name;

  R D(const Vec3<R>& wm) const {
    return from_slopes(wm, [&](const R& h2, const R& z2) { return shape.density(h2, z2); });
  }
  R lambda_cos(const Vec3<R>& w) const {
    const R s = safe_sqrt(sqr(stretch_x * w.x) + sqr(stretch_y * w.y));
    if constexpr (pack_derivatives<R> >= 0)
      if (masking) return masking->lambda_cos(s, w.z);
    return shape.lambda_cos(s, w.z);
  }
  Vec3<R> sample_normal(const Vec2<R>& u) const {
    const R phi = constant<R>(2 * pi) * u.y;
    return normal(shape.radius2(u.x), cos(phi), sin(phi));
  }
  Vec3<R> sample_visible(const Vec3<R>& wo, const Vec2<R>& u) const {
    const R r2 = shape.radius2(u.x), x = stretch_x * wo.x, y = stretch_y * wo.y;
    const R s = safe_sqrt(x * x + y * y);
    const auto tilted = s > R(0);
    const R inv = R(1) / select(tilted, s, R(1));
    const R c = select(tilted, x * inv, R(1)), d = select(tilted, y * inv, R(0));
    const R phi = vcavity_visible_azimuth(R(safe_sqrt(r2) * s / max(wo.z, R(1e-20f))), u.y);
    return normal(r2, c * cos(phi) - d * sin(phi), d * cos(phi) + c * sin(phi));
  }
  R visible_density(const Vec3<R>& wo, const Vec3<R>& wm) const {
    const R q = from_slopes(wm, [&](const R& h2, const R& z2) { return shape.sampling_density(h2, z2); });
    return vcavity_visible_density(R(q * wm.z), wo, wm);
  }

private:
  template <class F>
  R from_slopes(const Vec3<R>& wm, F f) const {
    const auto up = wm.z > R(1e-5f); // steeper, z^4 leaves the range of float
    const R z2 = sqr(select(up, wm.z, R(1)));
    const R d = f(R(sqr(wm.x / stretch_x) + sqr(wm.y / stretch_y)), z2);
    return select(up, d / (stretch_x * stretch_y), R(0));
  }
  Vec3<R> normal(const R& r2, const R& c, const R& s) const {
    const R r = safe_sqrt(r2);
    return normalize(Vec3<R>{stretch_x * r * c, stretch_y * r * s, R(1)});
  }
};

} // namespace nacre

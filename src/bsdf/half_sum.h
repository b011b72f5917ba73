#pragma once
// The sum of two directions, the half vector before it is normalised, for models that divide by cosines.

#include "bsdf/model.h"

namespace nacre {

/// H = wo + wi of two directions above the surface, and their cosines. A direction less than 1e-9 above the
/// horizon counts as 1e-9 above it: products of cosines stay within the range of float, and no published
/// value is that grazing. Where `valid` is false, that is below the surface, all are those of the normal.
template <class R>
struct HalfSum {
  Vec3<R> H;
  R cos_o, cos_i;
  mask_t<R> valid;

  HalfSum(const Vec3<R>& wo, const Vec3<R>& wi) : valid(same_upper_side(wo, wi)) {
    const Vec3<R> up{R(0), R(0), R(1)}, o = select(valid, wo, up), i = select(valid, wi, up);
    cos_o = max(o.z, R(1e-9f)), cos_i = max(i.z, R(1e-9f));
    H = {o.x + i.x, o.y + i.y, cos_o + cos_i};
  }
  /// H . H = 2 wo . H; the cosine between wo and the half vector is half of its root.
  R squared() const { return length_squared(H); }
  /// 1 - cos(theta_h), exact near the normal.
  R one_minus_cos_h() const {
    const R l = sqrt(squared());
    return (sqr(H.x) + sqr(H.y)) / (l * (l + H.z));
  }
  /// Slope of the facet that mirrors wi to wo: tan(theta_h) in x and y.
  Vec2<R> slope() const { return {H.x / H.z, H.y / H.z}; }
};

} // namespace nacre

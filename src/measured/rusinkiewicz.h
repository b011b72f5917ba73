#pragma once
// Half and difference angles of a pair of directions, the coordinates of tabulated isotropic reflectance.
// Source: Rusinkiewicz 1998, A New Change of Variables for Efficient BRDF Representation.

#include "core/vec.h"

namespace nacre {

/// theta_h in [0, pi/2]: half vector to normal; theta_d in [0, pi/2]: wi to half vector; phi_d in [-pi, pi]:
/// azimuth of wi about the half vector, 0 where wi lies on the far side of it from the normal. Exchanging wo
/// and wi adds pi to phi_d; mirroring both about a plane through the normal negates it.
template <class R>
struct HalfDifference {
  R theta_h, theta_d, phi_d;
};

/// atan2(y, x) for numbers that are not both 0. For float without branches, to 1e-7, in half of libm's
/// time; the polynomial is Abramowitz and Stegun 1964, 4.4.49, whose relative error is at most 2e-8.
template <class R>
R angle_of(const R& y, const R& x) {
  if constexpr (std::is_same_v<R, float>) {
    const float ax = abs(x), ay = abs(y), t = min(ax, ay) / max(ax, ay), t2 = t * t;
    // In pairs (Estrin's scheme): the chain of dependent products is half as long.
    const float t4 = t2 * t2, t8 = t4 * t4;
    const float low = (1 - 0.3333314528f * t2) + t4 * (0.1999355085f - 0.1420889944f * t2);
    const float high = (0.1065626393f - 0.0752896400f * t2) + t4 * (0.0429096138f - 0.0161657367f * t2);
    float angle = t * (low + t8 * (high + t8 * 0.0028662257f));
    angle = ay > ax ? static_cast<float>(pi / 2) - angle : angle;
    angle = x < 0 ? static_cast<float>(pi) - angle : angle;
    return std::copysign(angle, y);
  } else {
    return atan2(y, x);
  }
}

/// The angles of two unit vectors on the upper side. With s = wo + wi and d = wi - wo, which are
/// perpendicular, every angle is an arc tangent of lengths: no cancellation near the mirror direction, where
/// arc cosines of nearly 1 would lose half the digits. Where theta_h or theta_d is 0, phi_d is arbitrary.
template <class R>
HalfDifference<R> half_difference(const Vec3<R>& wo, const Vec3<R>& wi) {
  const Vec3<R> s = wo + wi, d = wi - wo;
  const R s_length = length(s);
  // d in the frame of the half vector, both components multiplied by |s_xy|; as d.s = 0 the one along the
  // tangent, (s.z (s.x d.x + s.y d.y) - |s_xy|^2 d.z) / |s|, shortens to -d.z |s|.
  const R along = -d.z * s_length, across = s.x * d.y - s.y * d.x;
  const auto aligned = (abs(along) + abs(across)) < R(1e-30f);
  const auto opposite = s_length < R(1e-30f);
  return {select(opposite, R(0), angle_of(R(sqrt(s.x * s.x + s.y * s.y)), R(select(opposite, R(1), s.z)))),
          angle_of(length(d), R(select(opposite, R(1e-30f), s_length))),
          select(aligned, R(0), angle_of(across, R(select(aligned, R(1), along))))};
}

template <class R>
struct DirectionPair {
  Vec3<R> wo, wi;
};

/// Directions that have these angles, with the half vector in the xz plane (x >= 0).
template <class R>
DirectionPair<R> directions(const HalfDifference<R>& a) {
  const R sin_h = sin(a.theta_h), cos_h = cos(a.theta_h), sin_d = sin(a.theta_d), cos_d = cos(a.theta_d);
  const Vec3<R> h{sin_h, R(0), cos_h}, t{cos_h, R(0), -sin_h};
  const Vec3<R> along = h * cos_d,
                across = t * (sin_d * cos(a.phi_d)) + Vec3<R>{R(0), sin_d * sin(a.phi_d), R(0)};
  return {along - across, along + across};
}

/// True where both directions of `a` are above the surface: cos theta_h cos theta_d > sin theta_h sin theta_d
/// |cos phi_d|.
template <class R>
mask_t<R> above_horizon(const HalfDifference<R>& a) {
  return cos(a.theta_h) * cos(a.theta_d) > sin(a.theta_h) * sin(a.theta_d) * abs(cos(a.phi_d));
}

} // namespace nacre

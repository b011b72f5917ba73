#pragma once
// Microfacet normal distributions: GGX and Beckmann, and what every distribution (optics/ndf_*.h) offers.
//
//   D(wm)                    density of facet area over normals, per sr; the integral of D cos is 1
//   lambda_cos(w)            Smith's Lambda(w) times cos theta, which stays finite at grazing angles, where
//                            Lambda itself is infinite; for w above the surface
//   sample_normal(u)         a normal, whatever the view
//   sample_visible(wo, u)    a normal that wo sees, for wo above the surface
//   visible_density(wo, wm)  its density per sr divided by wo . wm, finite where a facet is seen edge-on
//
// What follows from them, with other masking functions in optics/masking.h:
//   G1(w)        = cos / (cos + lambda_cos)                                   Heitz 2014, eq. 43
//   G2 / (4 cos cos) with correlated heights (eq. 99) or separable G1 G1      see `visibility`
// Source: Heitz 2014, Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs, JCGT 3(2).

#include "core/vec.h"
#include "optics/erfinv.h"

#include <string_view>

namespace nacre {

/// GGX / Trowbridge-Reitz. alpha in (0, 1]; alpha_x along the tangent.
/// Source: Walter et al. 2007, eq. 33, 34; anisotropic: Heitz 2014, eq. 85, 86.
template <class R>
struct Ggx {
  R alpha_x, alpha_y;
  static constexpr std::string_view name = "GGX";

  R D(const Vec3<R>& wm) const {
    const R inv = R(1) / (alpha_x * alpha_y); // 1 / alpha_x = alpha_y inv: one division for both
    const R s = sqr(wm.x * (alpha_y * inv)) + sqr(wm.y * (alpha_x * inv)) + sqr(wm.z);
    return select(wm.z > R(0), inv * constant<R>(inv_pi) / sqr(s), R(0));
  }
  R lambda_cos(const Vec3<R>& w) const {
    return R(0.5f) * (sqrt(sqr(alpha_x * w.x) + sqr(alpha_y * w.y) + sqr(w.z)) - w.z);
  }
  /// Walter et al. 2007, eq. 35 with stretched slopes; density D cos.
  Vec3<R> sample_normal(const Vec2<R>& u) const {
    const R r = safe_sqrt(u.x / max(R(1) - u.x, R(1e-7f))), phi = constant<R>(2 * pi) * u.y;
    return normalize(Vec3<R>{alpha_x * r * cos(phi), alpha_y * r * sin(phi), R(1)});
  }
  /// Dupuy and Benyoub 2023, Sampling Visible GGX Normals with Spherical Caps, listing 3.
  Vec3<R> sample_visible(const Vec3<R>& wo, const Vec2<R>& u) const {
    const Vec3<R> wo_std = normalize(Vec3<R>{wo.x * alpha_x, wo.y * alpha_y, wo.z});
    const R phi = constant<R>(2 * pi) * u.x;
    const R z = (R(1) - u.y) * (R(1) + wo_std.z) - wo_std.z;
    const R sin_theta = safe_sqrt(R(1) - z * z);
    const Vec3<R> c{sin_theta * cos(phi), sin_theta * sin(phi), z};
    const Vec3<R> wm_std = c + wo_std;
    // From below the surface nothing is seen: any normal will do, if it is one.
    return normalize(Vec3<R>{wm_std.x * alpha_x, wm_std.y * alpha_y, max(wm_std.z, R(1e-8f))});
  }
  /// Heitz 2014, eq. 16.
  R visible_density(const Vec3<R>& wo, const Vec3<R>& wm) const { return D(wm) / (wo.z + lambda_cos(wo)); }
};

/// Beckmann-Spizzichino: Gaussian slopes. alpha = sqrt(2) times the RMS slope.
/// Source: Walter et al. 2007, eq. 25; anisotropic: Heitz 2014, eq. 80; Lambda: eq. 82, exact rather than its
/// rational fit.
template <class R>
struct Beckmann {
  R alpha_x, alpha_y;
  static constexpr std::string_view name = "Beckmann";

  R D(const Vec3<R>& wm) const {
    const auto up = wm.z > R(0.001f); // beyond, exp(-tan^2 / alpha^2) underflows for every alpha <= 1
    const R inv = R(1) / (alpha_x * alpha_y), inv_z2 = R(1) / sqr(select(up, wm.z, R(1)));
    const R e = (sqr(wm.x * (alpha_y * inv)) + sqr(wm.y * (alpha_x * inv))) * inv_z2;
    return select(up, exp(-e) * inv * constant<R>(inv_pi) * sqr(inv_z2), R(0));
  }
  R lambda_cos(const Vec3<R>& w) const {
    const R stretched_sin = safe_sqrt(sqr(alpha_x * w.x) + sqr(alpha_y * w.y));
    const R t = max(stretched_sin, w.z * R(0.05f)); // a <= 20: beyond, Lambda is 0 in double
    const R a = w.z / t;
    return R(0.5f) * (w.z * (erf(a) - R(1)) + t * exp(-a * a) * constant<R>(1 / std::sqrt(pi)));
  }
  /// Walter et al. 2007, eq. 28 with stretched slopes; density D cos.
  Vec3<R> sample_normal(const Vec2<R>& u) const {
    const R r = safe_sqrt(-log(max(R(1) - u.x, R(1e-7f)))), phi = constant<R>(2 * pi) * u.y;
    return normalize(Vec3<R>{alpha_x * r * cos(phi), alpha_y * r * sin(phi), R(1)});
  }
  /// The visible slope along the view, by inverting its distribution function (Heitz and d'Eon 2014,
  /// Importance Sampling Microfacet-Based BSDFs using the Distribution of Visible Normals, supplement 1) with
  /// a fixed number of safeguarded Newton steps in b = erf(slope), where the function is nearly linear.
  Vec3<R> sample_visible(const Vec3<R>& wo, const Vec2<R>& u) const {
    // Rays below the surface see facets too, from under the horizon; steeper than 3 sin_theta hardly one in
    // 10^6 of them, fewer than erf resolves in float.
    const Vec3<R> stretched{wo.x * alpha_x, wo.y * alpha_y, wo.z};
    const R steepest = R(-3) * safe_sqrt(sqr(stretched.x) + sqr(stretched.y));
    const Vec3<R> w = normalize(Vec3<R>{stretched.x, stretched.y, max(wo.z, min(steepest, R(-1e-20f)))});
    const R sin_theta = safe_sqrt(w.x * w.x + w.y * w.y);
    const auto tilted = sin_theta > R(1e-5f);
    const R sin_safe = select(tilted, sin_theta, R(1));
    const R inv_sqrt_pi = constant<R>(1 / std::sqrt(pi));
    const auto area = [&](const R& b, const R& slope) { // projected area of the facets up to this slope
      return R(0.5f) * (w.z * (R(1) + b) + sin_theta * inv_sqrt_pi * exp(-slope * slope));
    };
    const R slope_max = min(w.z / sin_safe, R(9)); // steeper facets are seen from behind
    const R b_max = select(tilted, erf(slope_max), R(1));
    const R target = u.x * area(b_max, select(tilted, slope_max, R(9)));
    R lo = R(-1), hi = b_max, b = R(-1) + (b_max + R(1)) * u.x;
    for (int i = 0; i < 10; ++i) {
      const R slope = erfinv(b), error = area(b, slope) - target;
      lo = select(error > R(0), lo, b);
      hi = select(error > R(0), b, hi);
      const R derivative = R(0.5f) * (w.z - slope * sin_theta);
      const R newton = b - error / select(derivative > R(1e-6f), derivative, R(1));
      const auto inside = (newton >= lo) & (newton <= hi) & (derivative > R(1e-6f));
      b = select(inside, newton, R(0.5f) * (lo + hi));
    }
    const R slope_x = erfinv(b), slope_y = erfinv(R(2) * u.y - R(1));
    // From the frame of the view to x, y, and back to the surface's roughness.
    const R cos_phi = select(tilted, w.x / sin_safe, R(1)), sin_phi = select(tilted, w.y / sin_safe, R(0));
    const R sx = alpha_x * (cos_phi * slope_x - sin_phi * slope_y);
    const R sy = alpha_y * (sin_phi * slope_x + cos_phi * slope_y);
    return normalize(Vec3<R>{-sx, -sy, R(1)});
  }
  /// Heitz 2014, eq. 16.
  R visible_density(const Vec3<R>& wo, const Vec3<R>& wm) const { return D(wm) / (wo.z + lambda_cos(wo)); }
};

/// Share of the facets of normal wm that `w` sees: Smith's masking for w above the surface.
template <class Distribution, class R>
R smith_g1(const Distribution& d, const Vec3<R>& w) {
  return w.z / (w.z + d.lambda_cos(w));
}

/// visible_density of a distribution that samples Smith's visible normals, where D is known already. Heitz
/// 2014, eq. 16.
template <class Distribution, class R>
R visible_density(const Distribution& d, const Vec3<R>& wo, const R& D) {
  return D / (wo.z + d.lambda_cos(wo));
}

/// G2(wo, wi) / (4 cos_o cos_i), finite at grazing angles, for wo and wi above the surface.
/// @param separable  0: heights of masking and shadowing are correlated, G2 = 1 / (1 + L_o + L_i) (Heitz
/// 2014, eq. 99);
///                   1: independent, G2 = G1 G1 = 1 / (1 + L_o + L_i + L_o L_i)
template <class Distribution, class R>
R visibility(const Distribution& d, const Vec3<R>& wo, const Vec3<R>& wi, const R& separable) {
  const R lo = d.lambda_cos(wo), li = d.lambda_cos(wi);
  return R(0.25f) / (wo.z * wi.z + lo * wi.z + li * wo.z + separable * lo * li);
}

} // namespace nacre

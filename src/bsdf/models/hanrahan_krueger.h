#pragma once
// Light that enters a layer through its smooth surface, is scattered once by particles or passes to a
// Lambertian base below and comes out again: skin, leaves, thin paint. The surface's own mirror reflection is
// another lobe. Reciprocal; what is scattered more than once is lost. Source: Hanrahan and Krueger 1993,
// Reflection from Layered Surfaces due to Subsurface Scattering, eq. 5 and section 5; Henyey and Greenstein
// 1941.

#include "bsdf/hemisphere_lobes.h"
#include "bsdf/model.h"
#include "optics/fresnel.h"

namespace nacre {

template <class R, int C>
struct HanrahanKrueger : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color albedo, base_reflectance;
  R depth, g, eta;

  static constexpr std::string_view name = "hanrahan_krueger";
  static constexpr std::string_view source = "Hanrahan and Krueger 1993, eq. 5";
  static constexpr std::string_view summary = "single scattering in a layer over a diffuse base";
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&HanrahanKrueger::albedo, "albedo", "1", 0, 1, 0.8,
                  "share of light scattered per collision"},
        Parameter{&HanrahanKrueger::base_reflectance, "base_reflectance", "1", 0, 1, 0.5,
                  "albedo of the base"},
        Parameter{&HanrahanKrueger::depth, "depth", "1", 0, 20, 1.0, "optical thickness of the layer"},
        Parameter{&HanrahanKrueger::g, "g", "1", -0.9, 0.9, 0.0,
                  "mean cosine of scattering; below 0 back to the light"},
        Parameter{&HanrahanKrueger::eta, "eta", "1", 1, 2.5, 1.4, "index of the layer / index outside"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto up = same_upper_side(wo, wi);
    const Vec3<R> normal{R(0), R(0), R(1)};
    const Inside o(select(up, wo, normal), eta), i(select(up, wi, normal), eta);
    // 80: exp(-80) is nothing, and no number type overflows
    const R through = exp(-min(depth / o.w.z + depth / i.w.z, R(80)));
    const R passes = o.transmittance * i.transmittance / (eta * eta);
    const R scattered = phase(R(-dot(o.w, i.w))) * (R(1) - through) / (o.w.z + i.w.z);
    const Color f = albedo * scattered + base_reflectance * (constant<R>(inv_pi) * through);
    return select(up, f * passes, Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto up = same_upper_side(wo, wi);
    const Vec3<R> normal{R(0), R(0), R(1)};
    const Vec3<R> outside = select(up, wi, normal);
    const Inside o(select(up, wo, normal), eta), i(outside, eta);
    const R jacobian = outside.z / (eta * eta * i.w.z); // of refraction, solid angle inside by outside
    const R p = phase_probability(o.w.z);
    const R back = phase(R(-dot(o.w, i.w))) * jacobian;
    return select(up, p * back + (R(1) - p) * diffusing_lobe(wo).pdf(wi), R(0));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const Inside o(select(wo.z > R(0), wo, Vec3<R>{R(0), R(0), R(1)}), eta);
    const Vec3<R> inside =
        Frame<R>::around(o.w).to_world(scattered(u)); // about -wo: back-scattering is at wo
    const Vec3<R> out{inside.x * eta, inside.y * eta, R(0)};
    const R cos2 = R(1) - sin2_theta(out);
    const auto leaves = (inside.z > R(0)) & (cos2 > R(0));
    const Vec3<R> refracted{out.x, out.y, sqrt(select(leaves, cos2, R(1)))};
    const auto from_phase = u_lobe < phase_probability(o.w.z);
    const Vec3<R> wi = select(from_phase, refracted, diffusing_lobe(wo).sample(u));
    const auto found = leaves | (!from_phase);
    return {wi, select(found, eval(wo, wi), Color()), select(found, pdf(wo, wi), R(0)), mask_t<R>(false)};
  }

private:
  /// A direction above the surface as it goes on below, on the same side of the normal.
  struct Inside {
    Vec3<R> w;
    R transmittance;
    Inside(const Vec3<R>& outside, const R& eta) {
      const auto fresnel = fresnel_dielectric(outside.z, eta);
      // at eta = 1 the cosine inside may be as small as a float gets
      w = {outside.x / eta, outside.y / eta, max(-fresnel.cos_t, R(1e-30f))};
      transmittance = R(1) - fresnel.reflectance;
    }
  };
  /// Henyey and Greenstein; `cosine` between the directions of travel.
  R phase(const R& cosine) const {
    const R d = R(1) + g * g - R(2) * g * cosine;
    return constant<R>(0.25 * inv_pi) * (R(1) - g * g) / (d * sqrt(d));
  }
  /// A direction about +z with the density phase(-z).
  Vec3<R> scattered(const Vec2<R>& u) const {
    const auto even = abs(g) < R(1e-3f);
    const R safe = select(even, R(1), g), s = (R(1) - g * g) / (R(1) + g * (R(2) * u.x - R(1)));
    const R cosine = select(even, R(2) * u.x - R(1), (R(1) + g * g - s * s) / (R(2) * safe));
    return warp_detail::lifted(R(R(1) + clamp(cosine, R(-1), R(1))), u.y);
  }
  /// A backward lobe is worth it always; of a forward one only the part that turns up again at grazing
  /// angles.
  R phase_probability(const R& cos_inside) const {
    return R(0.7f) * select(g < R(0), R(-g), R(g * sqr(R(1) - cos_inside)));
  }
};

} // namespace nacre

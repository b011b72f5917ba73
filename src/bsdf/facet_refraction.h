#pragma once
// Single refraction through a microfacet surface, whatever its distribution and Fresnel term.

#include "bsdf/model.h"
#include "optics/microfacet.h"

namespace nacre {

/// Walter et al. 2007, eq. 21 without 1 - F, over eta^2 for radiance; masking and shadowing multiplied. Zero
/// unless wo and wi lie on different sides and a facet takes one to the other.
template <class R>
struct FacetRefraction {
  R value;       ///< 1/sr
  R pdf;         ///< of wi, 1/sr, when normals are sampled by visibility and all refract
  R cos_outside; ///< cosine to the facet's normal of the direction that lies above the surface
};

/// @param eta  index below / index above, not 1
template <class Distribution, class R>
FacetRefraction<R> refract_through_facets(const Distribution& d, const Vec3<R>& wo_any, const Vec3<R>& wi_any,
                                          const R& eta) {
  const Vec3<R> up{R(0), R(0), R(1)}, down{R(0), R(0), R(-1)};
  const auto crosses = ((wo_any.z > R(0)) & (wi_any.z < R(0))) | ((wo_any.z < R(0)) & (wi_any.z > R(0)));
  const auto from_above = wo_any.z > R(0);
  const R side = select(from_above, R(1), R(-1)), eta_ti = select(from_above, eta, R(1) / eta);
  const Vec3<R> wo = select(crosses, wo_any * side, up), wi = select(crosses, wi_any * side, down);
  const Vec3<R> h = wo + wi * eta_ti; // eq. 16
  const R l2 = length_squared(h);
  const auto defined = l2 > R(1e-12f);
  Vec3<R> wm = select(defined, h, up) / sqrt(select(defined, l2, R(1)));
  wm = wm * select(wm.z < R(0), R(-1), R(1));
  const R c_o = dot(wo, wm), c_i = dot(wi, wm);
  const auto valid = crosses & defined & (c_o > R(0)) & (c_i < R(0));
  const R denominator = c_o + eta_ti * c_i;
  const R safe = select(abs(denominator) > R(1e-9f), denominator, R(1));
  const R jacobian = abs(c_i) * sqr(eta_ti / safe); // dwm/dwi, eq. 17
  const Vec3<R> i{wi.x, wi.y, -wi.z};
  const R seen = c_o * jacobian * d.D(wm) / (wo.z + d.lambda_cos(wo));
  return {select(valid, seen / ((i.z + d.lambda_cos(i)) * sqr(eta_ti)), R(0)), select(valid, seen, R(0)),
          select(valid, select(from_above, c_o, -c_i), R(1))};
}

/// wo refracted by a facet whose normal wm points to wo's side; on wo's own side where it reflects totally.
template <class R>
Vec3<R> refract_in_facet(const Vec3<R>& wo, const Vec3<R>& wm, const R& eta) {
  const R eta_ti = select(wo.z > R(0), eta, R(1) / eta), c = dot(wo, wm);
  const R cos2_t = R(1) - (R(1) - c * c) / (eta_ti * eta_ti);
  const Vec3<R> wi = wm * (c / eta_ti - safe_sqrt(cos2_t)) - wo / eta_ti;
  return select(cos2_t > R(0), normalize(wi), wo);
}

} // namespace nacre

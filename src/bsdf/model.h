#pragma once
// What a scattering model is: parameters as data, eval, sample, pdf.
//
// Directions are unit vectors of the local shading frame and point away from the surface; wo to the viewer,
// wi to the light. `eval` is the BSDF f(wo, wi) in 1/sr per channel without the cosine, with which radiance
// travels from wi to wo: L_o = integral of f L_i |cos theta_i| dwi. In transmission that is not symmetric:
// f(wo, wi) / eta_o^2 = f(wi, wo) / eta_i^2 (Veach 1997, eq. 5.14); the adjoint for importance is f with its
// arguments exchanged. A model for reflection alone is 0 where wo or wi lies below the surface.

#include "bsdf/parameter.h"
#include "core/vec.h"

#include <concepts>

namespace nacre {

/// What `sample` returns. A lane without a sample has pdf 0.
template <class R, int C>
struct BsdfSample {
  Vec3<R> wi;
  Spectrum<R, C> f; ///< 1/sr; for a delta lobe the value such that f |cos theta_i| / pdf is the lobe's weight
  R pdf;            ///< 1/sr; for a delta lobe the discrete probability of having chosen it
  mask_t<R> is_delta; ///< a mirror or smooth-refraction direction: eval and pdf know nothing of it
};

/// A model M = Model<R, C>. All of sample's randomness comes in as arguments: u_lobe chooses among lobes, u
/// the direction within one, all uniform in [0, 1).
template <class M>
concept ScatteringModel = requires(const M m, Vec3<typename M::Number> w, typename M::Number u,
                                   Vec2<typename M::Number> u2) {
  { M::name } -> std::convertible_to<std::string_view>;
  { M::source } -> std::convertible_to<std::string_view>;
  { M::summary } -> std::convertible_to<std::string_view>;
  { m.eval(w, w) } -> std::same_as<typename M::Color>;
  { m.pdf(w, w) } -> std::same_as<typename M::Number>;
  { m.sample(w, u, u2) } -> std::same_as<BsdfSample<typename M::Number, M::channel_count>>;
  M::parameters();
};

/// True where both directions are above the surface.
template <class R>
mask_t<R> same_upper_side(const Vec3<R>& wo, const Vec3<R>& wi) {
  return (wo.z > R(0)) & (wi.z > R(0));
}

} // namespace nacre

#pragma once
// A rough clear or tinted or milky coat over rough metal, by random walks: lacquered brass, car paint,
// anodised aluminium. Its eval is a noisy, unbiased estimate; in expectation it keeps all laws, and loses
// what the metal's facets lose by scattering once. Source: Guo, Hasan and Zhao 2018.

#include "bsdf/layered_walk.h"
#include "bsdf/models/rough_conductor.h"
#include "core/warp.h"

namespace nacre {

template <class R, int C>
struct CoatedConductor : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color eta, k;
  R base_alpha, coat_eta, coat_alpha;
  Color optical_thickness, albedo;
  R g, walks, compensation;

  static constexpr std::string_view name = "coated_conductor";
  static constexpr std::string_view source = "Guo, Hasan and Zhao 2018, section 5.1";
  static constexpr std::string_view summary = "rough coat over rough metal, by random walks";
  static constexpr Laws laws{.stochastic = true};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&CoatedConductor::eta, "eta", "1", 0.01, 20, 1.0, "real part of the metal's index"},
        Parameter{&CoatedConductor::k, "k", "1", 0, 30, 6.0, "imaginary part of the metal's index"},
        Parameter{&CoatedConductor::base_alpha, "base_alpha", "1", 1e-3, 1, 0.2, "roughness of the metal"},
        Parameter{&CoatedConductor::coat_eta, "coat_eta", "1", 1.05, 2.5, 1.5,
                  "index of the coat / index outside"},
        Parameter{&CoatedConductor::coat_alpha, "coat_alpha", "1", 1e-3, 1, 0.1, "roughness of the coat"},
        Parameter{&CoatedConductor::optical_thickness, "optical_thickness", "1", 0, 10, 0.0,
                  "extinction of the coat along the normal"},
        Parameter{&CoatedConductor::albedo, "albedo", "1", 0, 1, 0.0, "single-scattering albedo of the coat"},
        Parameter{&CoatedConductor::g, "g", "1", -0.9, 0.9, 0.0, "mean cosine of scattering in the coat"},
        Parameter{&CoatedConductor::walks, "walks", "1", 1, 32, 1.0,
                  "random walks averaged by one evaluation", false},
        Parameter{&CoatedConductor::compensation, "compensation", "1", 0, 1, 1.0,
                  "1: light that the coat's facets lose to masking comes back, 0: single scattering", false}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const { return walk().eval(wo, wi, walks); }
  /// Three lobes: the coat's, the metal's widened by the passages, and a cosine for what the medium or
  /// further bounces scatter wide. Seen from outside, a slope of the metal is eta times as great, and a facet
  /// of the coat bends as a slope of (eta - 1) / 2 would mirror, once in and once out.
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const Ggx<R> coat{coat_alpha, coat_alpha};
    const R seen =
        min(sqrt(sqr(coat_eta * base_alpha) + R(0.5f) * sqr((coat_eta - R(1)) * coat_alpha)), R(1));
    const R p = fresnel_dielectric(max(wo.z, R(0)), coat_eta).reflectance;
    const R scattering = average(optical_thickness * albedo);
    const R narrow = R(0.9f) * exp(-min(R(2) * scattering, R(60)));
    const R diffuse = select(same_upper_side(wo, wi), wi.z * constant<R>(inv_pi), R(0));
    return p * facet_reflection_pdf(coat, wo, wi) +
           (R(1) - p) *
               (narrow * facet_reflection_pdf(Ggx<R>{seen, seen}, wo, wi) + (R(1) - narrow) * diffuse);
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const auto s = walk().sample(wo, u_lobe, u);
    const R density = select(s.valid, pdf(wo, s.wi), R(0));
    return {s.wi, s.weight * (density / select(s.valid, s.wi.z, R(1))), density, mask_t<R>(false)};
  }

private:
  LayeredWalk<GgxConductor<R, C>> walk() const {
    const R inv = R(1) / coat_eta; // the metal's index as seen from within the coat
    return {{coat_eta, coat_alpha, compensation},
            {optical_thickness, albedo, g},
            {{}, eta * inv, k * inv, base_alpha, base_alpha, Color(R(1)), R(0)}};
  }
};

} // namespace nacre

#pragma once
// A rough clear or tinted or milky coat over a diffuse base, by random walks: varnished wood, glazed ceramic,
// paint in binder. Unlike `ggx_plastic` it keeps directions through every bounce, knows a medium, and loses
// no energy. Its eval is a noisy, unbiased estimate; in expectation it keeps all laws. Source: Guo, Hasan and
// Zhao 2018.

#include "bsdf/layered_walk.h"
#include "bsdf/models/lambert.h"

namespace nacre {

template <class R, int C>
struct CoatedDiffuse : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color reflectance;
  R eta, alpha;
  Color optical_thickness, albedo;
  R g, walks, compensation;

  static constexpr std::string_view name = "coated_diffuse";
  static constexpr std::string_view source = "Guo, Hasan and Zhao 2018, section 5.1";
  static constexpr std::string_view summary = "rough coat over a diffuse base, by random walks";
  static constexpr Laws laws{.stochastic = true};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&CoatedDiffuse::reflectance, "reflectance", "1", 0, 1, 0.5, "albedo of the base"},
        Parameter{&CoatedDiffuse::eta, "eta", "1", 1.05, 2.5, 1.5, "index of the coat / index outside"},
        Parameter{&CoatedDiffuse::alpha, "alpha", "1", 1e-3, 1, 0.1, "roughness of the coat"},
        Parameter{&CoatedDiffuse::optical_thickness, "optical_thickness", "1", 0, 10, 0.0,
                  "extinction of the coat along the normal"},
        Parameter{&CoatedDiffuse::albedo, "albedo", "1", 0, 1, 0.0, "single-scattering albedo of the coat"},
        Parameter{&CoatedDiffuse::g, "g", "1", -0.9, 0.9, 0.0, "mean cosine of scattering in the coat"},
        Parameter{&CoatedDiffuse::walks, "walks", "1", 1, 32, 1.0, "random walks averaged by one evaluation",
                  false},
        Parameter{&CoatedDiffuse::compensation, "compensation", "1", 0, 1, 1.0,
                  "1: light that the coat's facets lose to masking comes back, 0: single scattering", false}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const { return walk().eval(wo, wi, walks); }
  /// The interface's reflection, and the cosine for whatever went below.
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const Ggx<R> d{alpha, alpha};
    const R p = fresnel_dielectric(max(wo.z, R(0)), eta).reflectance;
    const R diffuse = select(same_upper_side(wo, wi), wi.z * constant<R>(inv_pi), R(0));
    return p * facet_reflection_pdf(d, wo, wi) + (R(1) - p) * diffuse;
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const auto s = walk().sample(wo, u_lobe, u);
    const R density = select(s.valid, pdf(wo, s.wi), R(0));
    return {s.wi, s.weight * (density / select(s.valid, s.wi.z, R(1))), density, mask_t<R>(false)};
  }

private:
  LayeredWalk<Lambert<R, C>> walk() const {
    return {{eta, alpha, compensation}, {optical_thickness, albedo, g}, {{}, reflectance}};
  }
};

} // namespace nacre

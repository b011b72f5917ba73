#pragma once
// A rough clear or tinted coat over a rough base, without noise: each way light takes through the two layers
// is known by its energy, mean direction and variance, adding-doubling sums the ways, and two GGX lobes carry
// what comes out. Fast and smooth; wrong where lobes are no longer lobes (roughness above 0.5, grazing
// angles). Not reciprocal: energies and variances are taken at wo. Never gains energy. Energies are Fresnel's
// at the mean direction; the source averages them over the lobe by a table. Source: Belcour 2018, Efficient
// Rendering of Layered Materials using an Atomic Decomposition with Statistical Operators, ACM TOG 37(4),
// section 5 (operators) and 6 (adding-doubling).

#include "bsdf/microfacet_reflection.h"
#include "optics/fresnel.h"

namespace nacre {

/// The parameter that a metal base has and a dielectric one lacks.
template <class R, int C>
struct MetalAbsorption : ModelBase<R, C> {
  Spectrum<R, C> k;
};

/// @tparam metal  the base is a conductor; otherwise a dielectric that swallows what it lets in
template <class R, int C, bool metal>
struct BelcourLayers : std::conditional_t<metal, MetalAbsorption<R, C>, ModelBase<R, C>> {
  using typename ModelBase<R, C>::Color;
  Color eta;
  R base_alpha, coat_eta, coat_alpha;
  Color absorption;

  static constexpr std::string_view name = metal ? "belcour_coated_conductor" : "belcour_layered";
  static constexpr std::string_view source = "Belcour 2018, sections 5 and 6";
  static constexpr std::string_view summary = metal ? "rough coat over rough metal, by statistics of lobes"
                                                    : "rough coat over an opaque dielectric, by statistics";
  static constexpr Laws laws{.reciprocal = false};
  static constexpr auto parameters() {
    const auto layers = std::tuple{
        Parameter{&BelcourLayers::eta, "eta", "1", metal ? 0.01 : 1.0, metal ? 20 : 4, metal ? 1.0 : 2.0,
                  metal ? "real part of the metal's index" : "index of the base"},
        Parameter{&BelcourLayers::base_alpha, "base_alpha", "1", 1e-3, 1, 0.2, "roughness of the base"},
        Parameter{&BelcourLayers::coat_eta, "coat_eta", "1", 1.05, 2.5, 1.5,
                  "index of the coat / index outside"},
        Parameter{&BelcourLayers::coat_alpha, "coat_alpha", "1", 1e-3, 1, 0.1, "roughness of the coat"},
        Parameter{&BelcourLayers::absorption, "absorption", "1", 0, 10, 0.0,
                  "optical thickness of the coat along the normal, absorbing alone"}};
    if constexpr (metal)
      return std::tuple_cat(layers, std::tuple{Parameter{&MetalAbsorption<R, C>::k, "k", "1", 0, 30, 6.0,
                                                         "imaginary part of the metal's index"}});
    else
      return layers;
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const Lobes l = lobes(wo);
    return l.coat * reflect_from_facets(l.coat_facets, wo, wi, R(0)).value +
           l.base * reflect_from_facets(l.base_facets, wo, wi, R(0)).value;
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const Lobes l = lobes(wo);
    const R p = l.probability_of_coat();
    return p * facet_reflection_pdf(l.coat_facets, wo, wi) +
           (R(1) - p) * facet_reflection_pdf(l.base_facets, wo, wi);
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const Lobes l = lobes(wo);
    const R alpha = select(u_lobe < l.probability_of_coat(), l.coat_facets.alpha_x, l.base_facets.alpha_x);
    const Vec3<R> wi = reflect(wo, Ggx<R>{alpha, alpha}.sample_visible(wo, u));
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

private:
  /// Energy and facets of what the coat mirrors and of all that has met the base.
  struct Lobes {
    Color coat, base;
    Ggx<R> coat_facets, base_facets;
    R probability_of_coat() const {
      const R c = average(coat), b = average(base);
      return c / max(c + b, R(1e-6f));
    }
  };
  /// The variance of a lobe's projection on the plane is no moment of GGX, whose tails are too long; the
  /// paper's stand-in (section 5.1, as its implementation fits it) a / (1 - a), a = alpha^1.1.
  static R variance(const R& alpha) {
    const R a = pow(min(alpha, R(0.9999f)), R(1.1f));
    return a / (R(1) - a);
  }
  static R roughness(const R& variance) {
    return clamp(R(pow(variance / (R(1) + variance), constant<R>(1 / 1.1))), R(1e-3f), R(1));
  }
  Lobes lobes(const Vec3<R>& wo_any) const {
    const R c = select(wo_any.z > R(0), wo_any.z, R(1));
    const auto outer = fresnel_dielectric(c, coat_eta);
    const R F = outer.reflectance, T = R(1) - F, c_in = -outer.cos_t;
    Color base, bounces;
    for (int i = 0; i < C; ++i) {
      R base_k = R(0);
      if constexpr (metal) base_k = this->k[i] / coat_eta;
      const R mirrored = fresnel_conductor(c_in, eta[i] / coat_eta, base_k) *
                         exp(-min(R(R(2) * absorption[i] / c_in), R(60)));
      const R cycle = F * mirrored; // reflected by the base, then by the underside of the coat
      base[i] = T * T * mirrored / max(R(1) - cycle, R(1e-6f));
      bounces[i] = cycle / max(R(1) - cycle, R(1e-6f));
    }
    // Transmission turns a facet's tilt into less than reflection does: seen from within (in) and without.
    const R bend = R(0.5f) * (coat_eta - R(1));
    const R s_coat = variance(coat_alpha), s_base = variance(base_alpha);
    const R s_in = variance(coat_alpha * bend / coat_eta), s_out = variance(coat_alpha * bend);
    // Jacobian of refraction on the way out, which widens what is narrow inside.
    const R widening = coat_eta * c_in / max(c, R(1e-4f)); // the roughness is 1 long before
    const R s = s_out + widening * (s_in + s_base + average(bounces) * (s_base + s_coat));
    return {Color(F), base, {coat_alpha, coat_alpha}, {roughness(s), roughness(s)}};
  }
};

template <class R, int C>
using BelcourCoatedConductor = BelcourLayers<R, C, true>;
template <class R, int C>
using BelcourLayered = BelcourLayers<R, C, false>;

} // namespace nacre

#pragma once
// Rough metals like ggx_conductor whose facets follow a distribution with a shape: the length of its tail is
// a parameter. Reciprocal, positive, lose the energy of multiple bounces, never gain. With gamma = 2
// gtr_conductor and student_t_conductor are ggx_conductor, with p = 1 exponential_power_conductor is
// beckmann_conductor. Sources: Walter et al. 2007, eq. 20, with the distributions of Burley 2012, Ribardiere
// et al. 2017, Holzschuch and Pacanowski 2017; Smith masking: Heitz 2014.

#include "bsdf/microfacet_reflection.h"
#include "optics/fresnel.h"
#include "optics/ndf_exponential_power.h"
#include "optics/ndf_gtr.h"
#include "optics/ndf_student_t.h"

namespace nacre {

/// Family: name, source, summary, the shape's name, bounds, default and meaning, and make(alpha_x, alpha_y,
/// shape).
template <class R, int C, class Family>
struct ShapedConductor : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color eta, k;
  R alpha_x, alpha_y, shape;
  Color specular_reflectance;
  R separable;
  const MaskingTable<R>* prepared = nullptr;

  static constexpr std::string_view name = Family::name, source = Family::source, summary = Family::summary;
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&ShapedConductor::eta, "eta", "1", 0.01, 20, 1.0, "real part of the complex index"},
        Parameter{&ShapedConductor::k, "k", "1", 0, 30, 6.0, "imaginary part of the index, absorption"},
        Parameter{&ShapedConductor::alpha_x, Family::alpha_x, "1", 1e-3, 1, 0.2,
                  "roughness along the tangent"},
        Parameter{&ShapedConductor::alpha_y, Family::alpha_y, "1", 1e-3, 1, 0.2,
                  "roughness along the bitangent"},
        Parameter{&ShapedConductor::shape, Family::shape, "1", Family::lo, Family::hi, Family::initial,
                  Family::meaning},
        Parameter{&ShapedConductor::specular_reflectance, "specular_reflectance", "1", 0, 1, 1.0,
                  "factor on the reflection; 1 is physical", false},
        Parameter{&ShapedConductor::separable, "separable", "1", 0, 1, 0.0,
                  "0: height-correlated masking-shadowing, 1: product of both", false}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto facets = reflect_from_facets(distribution(), wo, wi, separable);
    Color f;
    for (int i = 0; i < C; ++i)
      f[i] = specular_reflectance[i] * fresnel_conductor(facets.cos_m, eta[i], k[i]) * facets.value;
    return f;
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const { return facet_reflection_pdf(distribution(), wo, wi); }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& u) const {
    const Vec3<R> wi = reflect(wo, distribution().sample_visible(wo, u));
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

  /// The microsurface, for the validator and plots.
  auto distribution() const {
    auto d = Family::make(alpha_x, alpha_y, shape);
    d.masking = prepared;
    return d;
  }
  MaskingTable<R> prepare() const { return MaskingTable<R>(distribution().shape); }
};

struct GtrFacets {
  static constexpr std::string_view name = "gtr_conductor",
                                    source = "Burley 2012, appendix B.2; Heitz 2014, eq. 99",
                                    summary = "rough metal, GTR facets: GGX with a free tail",
                                    alpha_x = "alpha_x", alpha_y = "alpha_y", shape = "gamma",
                                    meaning = "exponent of the tail: 1 longest in use, 2 GGX";
  static constexpr double lo = 0, hi = 5, initial = 1.5;
  template <class R>
  static auto make(const R& ax, const R& ay, const R& gamma) {
    return gtr(ax, ay, gamma);
  }
};
struct StudentTFacets {
  static constexpr std::string_view name = "student_t_conductor",
                                    source = "Ribardiere et al. 2017, eq. 11, 13",
                                    summary = "rough metal, Student-t slopes: from long tails to Beckmann",
                                    alpha_x = "alpha_x", alpha_y = "alpha_y", shape = "gamma",
                                    meaning = "2: GGX; less: longer tail; infinite: Beckmann";
  static constexpr double lo = 1.51, hi = 40, initial = 3;
  template <class R>
  static auto make(const R& ax, const R& ay, const R& gamma) {
    return student_t(ax, ay, gamma);
  }
};
struct ExponentialPowerFacets {
  static constexpr std::string_view name = "exponential_power_conductor",
                                    source = "Holzschuch and Pacanowski 2017, eq. 34, 35",
                                    summary = "rough metal, slopes of an exponential power",
                                    alpha_x = "beta_x", alpha_y = "beta_y", shape = "p",
                                    meaning = "kurtosis: 1 Beckmann, less: sharper peak and longer tail";
  static constexpr double lo = 0.2, hi = 5, initial = 0.6;
  template <class R>
  static auto make(const R& bx, const R& by, const R& p) {
    return exponential_power(bx, by, p);
  }
};

template <class R, int C>
using GtrConductor = ShapedConductor<R, C, GtrFacets>;
template <class R, int C>
using StudentTConductor = ShapedConductor<R, C, StudentTFacets>;
template <class R, int C>
using ExponentialPowerConductor = ShapedConductor<R, C, ExponentialPowerFacets>;

} // namespace nacre

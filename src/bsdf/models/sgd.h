#pragma once
// Bagher et al.'s shifted gamma model: facets of a distribution made to fit measured materials with one lobe,
// all parameters of each channel its own, masking and Fresnel as fitted functions. The published fits add a
// Lambertian, which stands apart here. Reciprocal; its parameters are not tied to each other, so nothing else
// is certain. Source: Bagher, Soler and Holzschuch 2012, Accurate Fitting of Measured Reflectances Using a
// Shifted Gamma Micro-facet Distribution, CGF 31(4), eq. 1, 9 to 15.

#include "bsdf/microfacet_reflection.h"
#include "optics/ndf_shifted_gamma.h"

#include <vector>

namespace nacre {

template <class R, int C>
struct Sgd : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color specular, alpha, p, r0, f1, lambda, log_c, k, theta0;
  R published_masking;
  struct Facets {
    R K; ///< eq. 11; the published K are these to 5e-6
    MaskingTable<R> masking;
  };
  const std::vector<Facets>* prepared = nullptr; ///< one a channel

  static constexpr std::string_view name = "sgd", source = "Bagher et al. 2012, eq. 1, 9 to 15",
                                    summary = "shifted gamma facets, each channel its own";
  // Fresnel up to 10 and no masking, so that the albedo grows like 1 / cos theta, lie within the published
  // values.
  static constexpr Laws laws{.energy_gain = 1e5};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&Sgd::specular, "specular", "1", 0, 5, 0.1, "factor on the lobe"},
        Parameter{&Sgd::alpha, "alpha", "1", 1e-5, 1, 0.02, "roughness"},
        Parameter{&Sgd::p, "p", "1", 0, 2, 0.5, "power of the slope before its exponential end"},
        Parameter{&Sgd::r0, "r0", "1", -0.1, 2, 0.5,
                  "Fresnel: reflectance at normal incidence, F0 - F1 of the source"},
        Parameter{&Sgd::f1, "f1", "1", -1, 8, 0.0,
                  "Fresnel: F1 of the source, its rise away from the normal"},
        Parameter{&Sgd::lambda, "lambda", "1", 0, 1.6e7, 3.0, "published masking: amplitude of its fall",
                  false},
        Parameter{&Sgd::log_c, "log_c", "1", -18, 252, -15.5, "published masking: logarithm of the factor c",
                  false},
        Parameter{&Sgd::k, "k", "1", 5, 900, 36.0, "published masking: power of the angle", false},
        Parameter{&Sgd::theta0, "theta0", "rad", -0.7, 1.25, 0.0, "published masking: angle where it begins",
                  false},
        Parameter{&Sgd::published_masking, "published_masking", "1", 0, 1, 0.0,
                  "0: Smith's masking of alpha and p, 1: that of lambda, log_c, k and theta0", false}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto [wm, valid] = UpperHalfVector<R>(wo, wi);
    const Vec3<R> up{R(0), R(0), R(1)}, o = select(valid, wo, up), i = select(valid, wi, up);
    const R cos_d = clamp(R(0.5f) * (dot(o, wm) + dot(i, wm)), 0.0f, 1.0f),
            miss = R(1) - cos_d; // of both: reciprocal to the last digit
    const R schlick = sqr(sqr(miss)) * miss;
    Color f;
    for (int c = 0; c < C; ++c) {
      // eq. 14, F0 - F1 cos + (1 - F0) (1 - cos)^5; where a few fits take it below 0, nothing is reflected
      const R F = max(r0[c] + f1[c] * miss + (R(1) - r0[c] - f1[c]) * schlick, R(0));
      const auto d = facets(c);
      f[c] = constant<R>(inv_pi) * specular[c] * F * d.D(wm) * masking_over_cos(d, o, c) *
             masking_over_cos(d, i, c);
    }
    return select(valid, f, Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    R sum = R(0);
    for (int c = 0; c < C; ++c)
      sum = sum + facet_reflection_pdf(shifted_gamma(alpha[c], p[c], R(1)), wo, wi);
    return sum * constant<R>(1.0 / C);
  }
  /// From the lobe of a channel, each as often.
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    R a = alpha[0], power = p[0];
    for (int c = 1; c < C; ++c) {
      const auto chosen = u_lobe * R(float(C)) >= R(float(c));
      a = select(chosen, alpha[c], a);
      power = select(chosen, p[c], power);
    }
    const Vec3<R> wi = reflect(wo, shifted_gamma(a, power, R(1)).sample_visible(wo, u));
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

  /// The microsurface of the middle channel, for the validator and plots.
  auto distribution() const { return facets(C / 2); }
  R masking(const Vec3<R>& w, const Vec3<R>& wm) const {
    return select((dot(w, wm) > R(0)) & (w.z > R(0)), w.z * masking_over_cos(distribution(), w, C / 2), R(0));
  }
  R masking_shadowing(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto d = distribution();
    return wo.z * wi.z * masking_over_cos(d, wo, C / 2) * masking_over_cos(d, wi, C / 2);
  }

  std::vector<Facets> prepare() const {
    std::vector<Facets> all;
    for (int c = 0; c < C; ++c) {
      const auto d = facets(c);
      all.push_back({d.shape.K, MaskingTable<R>(d.shape)});
    }
    return all;
  }

private:
  auto facets(int c) const {
    const Facets* known = prepared ? &(*prepared)[std::size_t(c)] : nullptr;
    auto d = shifted_gamma(alpha[c], p[c], known ? known->K : shifted_gamma_normalisation(alpha[c], p[c]));
    if (known) d.masking = &known->masking;
    return d;
  }
  template <class Distribution>
  R masking_over_cos(const Distribution& d, const Vec3<R>& w, int c) const {
    R g = R(0);
    if (any(published_masking < R(1))) g = (R(1) - published_masking) / (w.z + d.lambda_cos(w));
    if (any(published_masking > R(0))) g = g + published_masking * published(w, c) / max(w.z, R(1e-20f));
    return g;
  }
  /// eq. 15, G1 = 1 + lambda (1 - exp(c (theta - theta0)^k)). Towards grazing angles it may fall below 0,
  /// where everything is hidden.
  R published(const Vec3<R>& w, int c) const {
    const R theta = atan2(safe_sqrt(w.x * w.x + w.y * w.y), w.z);
    const auto begun = theta > theta0[c];
    const R log_e = log_c[c] + k[c] * log(select(begun, max(theta - theta0[c], R(1e-6f)), R(1e-6f)));
    const R e = exp(clamp(log_e, -80.0f, 4.0f)); // beyond, exp(e) hides all
    return max(R(1) - select(begun, lambda[c] * e * expm1_over(e), R(0)), R(0));
  }
};

} // namespace nacre

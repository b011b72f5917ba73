#pragma once
// Bagher et al.'s shifted gamma model: facets of a distribution made to fit measured materials with one lobe,
// all parameters of each channel its own, masking and Fresnel as fitted functions. The published fits add a
// Lambertian, which stands apart here. Reciprocal; its parameters are not tied to each other, so nothing else
// is certain. Source: Bagher, Soler and Holzschuch 2012, Accurate Fitting of Measured Reflectances Using a
// Shifted Gamma Micro-facet Distribution, CGF 31(4), eq. 1, 9 to 15.

#include "bsdf/microfacet_reflection.h"
#include "optics/ndf_shifted_gamma.h"

namespace nacre {

template <class R, int C>
struct Sgd : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color specular, alpha, p, f0, f1, lambda, log_c, k, theta0;

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
        Parameter{&Sgd::f0, "f0", "1", 0, 9, 0.5, "Fresnel: reflectance at normal incidence plus f1"},
        Parameter{&Sgd::f1, "f1", "1", -1, 8, 0.0, "Fresnel: its fall towards normal incidence"},
        Parameter{&Sgd::lambda, "lambda", "1", 0, 1.6e7, 3.0, "masking: amplitude of its fall"},
        Parameter{&Sgd::log_c, "log_c", "1", -18, 252, -15.5, "masking: logarithm of the factor c"},
        Parameter{&Sgd::k, "k", "1", 5, 900, 36.0, "masking: power of the angle"},
        Parameter{&Sgd::theta0, "theta0", "rad", -0.7, 1.25, 0.0, "masking: angle at which it begins"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto [wm, valid] = UpperHalfVector<R>(wo, wi);
    const Vec3<R> up{R(0), R(0), R(1)}, o = select(valid, wo, up), i = select(valid, wi, up);
    const R miss = clamp(R(1) - dot(o, wm), 0.0f, 1.0f), cos_d = R(1) - miss;
    const R theta_o = angle(o), theta_i = angle(i), schlick = sqr(sqr(miss)) * miss;
    Color f;
    for (int c = 0; c < C; ++c) {
      // eq. 14; below 0, where unlucky parameters lead, is no reflectance
      const R F = max(f0[c] - cos_d * f1[c] + (R(1) - f0[c]) * schlick, R(0));
      f[c] = constant<R>(inv_pi) * specular[c] * F * distribution(c).D(wm) *
             masking_over_cos(theta_o, o.z, c) * masking_over_cos(theta_i, i.z, c);
    }
    return select(valid, f, Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    R sum = R(0);
    for (int c = 0; c < C; ++c)
      sum = sum + facet_reflection_pdf(distribution(c), wo, wi);
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

private:
  auto distribution(int c) const { return shifted_gamma(alpha[c], p[c], R(1)); }
  static R angle(const Vec3<R>& w) { return atan2(safe_sqrt(w.x * w.x + w.y * w.y), w.z); }
  /// eq. 15, G1 = 1 + lambda (1 - exp(c (theta - theta0)^k)), over the cosine. Towards grazing it may fall
  /// below 0, where everything is hidden.
  R masking_over_cos(const R& theta, const R& cosine, int c) const {
    const auto begun = theta > theta0[c];
    const R log_e = log_c[c] + k[c] * log(select(begun, max(theta - theta0[c], R(1e-6f)), R(1e-6f)));
    const R e = exp(clamp(log_e, -80.0f, 4.0f)); // exp(e) - 1 beyond 10^23 times lambda hides all
    const R fall = lambda[c] * e * expm1_over(e);
    return max(R(1) - select(begun, fall, R(0)), R(0)) / max(cosine, R(1e-20f));
  }
};

} // namespace nacre

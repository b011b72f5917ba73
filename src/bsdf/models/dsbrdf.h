#pragma once
// A BRDF as a statistical distribution of half vectors that changes with the difference angle: one lobe
// exp(kappa cos^gamma(theta_h)) - 1, with height kappa and sharpness gamma functions of theta_d. Between a
// peak of any height and a tail of any length it follows measured isotropic materials closely; sums of lobes
// more so. Reciprocal and positive, but a description without physics: nothing bounds its energy but the
// data it was fitted to. The paper estimates both functions freely; here their logarithms are parabolas in
// 1 - cos(theta_d) of three control values each, which stay between the values.
// Source: Nishino and Lombardi 2011, Directional Statistics-Based Reflectance Model for Isotropic
// Bidirectional Reflectance Distribution Functions, JOSA A 28(1).

#include "bsdf/half_sum.h"
#include "bsdf/power_lobe.h"
#include "core/warp.h"

namespace nacre {

template <class R, int C>
struct DsBrdf : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color kappa, kappa_mid, kappa_grazing;
  R gamma, gamma_mid, gamma_grazing;

  static constexpr std::string_view name = "dsbrdf";
  static constexpr std::string_view source = "Nishino and Lombardi 2011";
  static constexpr std::string_view summary = "one lobe of the directional statistics of half vectors";
  static constexpr double highest_kappa = 10;
  /// At the corner of the domain where f is largest everywhere, along the normal: albedo 63041.
  static constexpr Laws laws{.energy_gain = 63050};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&DsBrdf::kappa, "kappa", "1", 1e-4, highest_kappa, 1.0, "log height at theta_d = 0"},
        Parameter{&DsBrdf::kappa_mid, "kappa_mid", "1", 1e-4, highest_kappa, 1.2,
                  "its control value between"},
        Parameter{&DsBrdf::kappa_grazing, "kappa_grazing", "1", 1e-4, highest_kappa, 2.0,
                  "log height at theta_d = 90 degrees"},
        Parameter{&DsBrdf::gamma, "gamma", "1", 0.1, 1e5, 100, "sharpness at theta_d = 0"},
        Parameter{&DsBrdf::gamma_mid, "gamma_mid", "1", 0.1, 1e5, 100, "its control value between"},
        Parameter{&DsBrdf::gamma_grazing, "gamma_grazing", "1", 0.1, 1e5, 100,
                  "sharpness at theta_d = 90 degrees"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const HalfSum<R> half(wo, wi);
    const R cos_d = R(0.5f) * sqrt(half.squared());
    const R power = power_of_cosine(half.one_minus_cos_h(), gamma_at(cos_d));
    Color f;
    for (int i = 0; i < C; ++i)
      f[i] = exp_minus_one(R(kappa_at(cos_d, i) * power));
    return select(half.valid, f, Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const HalfSum<R> half(wo, wi);
    const R lobe =
        facet_lobe(half.cos_o).density(half) / (R(2) * sqrt(half.squared())); // dwi = 4 (wo . h) dwh
    const R p = R(diffuse_share) * wi.z * constant<R>(inv_pi) + R(1 - diffuse_share) * lobe;
    return select(half.valid, p, R(0));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const auto diffuse = u_lobe < R(diffuse_share);
    const R rest = max((u_lobe - R(diffuse_share)) * R(1 / (1 - diffuse_share)), R(0));
    const Vec3<R> mirrored_wi = reflect(wo, facet_lobe(max(wo.z, R(1e-9f))).sample(rest, u));
    const Vec3<R> wi = select(diffuse, square_to_cosine_hemisphere(u), mirrored_wi);
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

private:
  /// Of the samples, for light far from the mirror direction, where theta_d and with it the lobe is another.
  static constexpr float diffuse_share = 0.1f;

  static R exp_minus_one(const R& x) { return exp(x) * one_minus_exp(x); }
  /// Bernstein's parabola of the logarithms.
  static R between(const R& cos_d, const R& a, const R& b, const R& c) {
    const R t = clamp(R(1) - cos_d, 0.0f, 1.0f), s = R(1) - t;
    return exp(s * s * log(a) + R(2) * s * t * log(b) + t * t * log(c));
  }
  R kappa_at(const R& cos_d, int i) const { return between(cos_d, kappa[i], kappa_mid[i], kappa_grazing[i]); }
  R gamma_at(const R& cos_d) const { return between(cos_d, gamma, gamma_mid, gamma_grazing); }

  /// The half vectors of one theta_d: exp(k c^g) - 1 = sum of k^j / j! c^(j g), a mixture of cosine powers.
  struct FacetLobe {
    R kappa, gamma;
    static constexpr int terms = 36; ///< at kappa = 10 the rest is below 1e-10

    /// Calls f(j gamma, its weight in the integral over the hemisphere / (2 pi)).
    template <class F>
    void for_each_power(F f) const {
      R coefficient = R(1);
      for (int j = 1; j <= terms; ++j) {
        coefficient = coefficient * kappa * R(1.0f / float(j));
        const R power = R(float(j)) * gamma;
        f(power, R(coefficient / (power + R(1))));
      }
    }
    R integral() const {
      R sum = R(0);
      for_each_power([&](const R&, const R& weight) { sum = sum + weight; });
      return sum;
    }
    R density(const HalfSum<R>& half) const {
      const R value = exp_minus_one(R(kappa * power_of_cosine(half.one_minus_cos_h(), gamma)));
      return value * constant<R>(0.5 * inv_pi) / integral();
    }
    Vec3<R> sample(const R& u_power, const Vec2<R>& u) const {
      const R target = u_power * integral();
      R below = R(0), chosen = gamma;
      for_each_power([&](const R& power, const R& weight) {
        chosen = select(below <= target, power, chosen);
        below = below + weight;
      });
      return PowerLobe<R>{{R(0), R(0), R(1)}, chosen}.sample(u);
    }
  };
  /// About the mirror direction theta_d is theta_o.
  FacetLobe facet_lobe(const R& cos_o) const {
    R highest = kappa_at(cos_o, 0);
    for (int i = 1; i < C; ++i)
      highest = max(highest, kappa_at(cos_o, i));
    return {highest, gamma_at(cos_o)};
  }
};

} // namespace nacre

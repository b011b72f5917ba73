#pragma once
// One generalised cosine lobe: [C_x o_x i_x + C_y o_y i_y + C_z o_z i_z]^n. The C turn and stretch the
// mirror: -1, -1, 1 is Phong's; |C_z| smaller lifts the highlight off the mirror direction and strengthens it
// towards grazing; all of one sign sends light back; C_x != C_y is anisotropic. Sums of some lobes fit many
// measurements. Scaled such that specular_reflectance is the albedo where the lobe is strongest and about the
// normal: (n + 2) / (2 pi max|C|^n), as in the fits of Ngan et al.; a published lobe without that factor is
// one with specular_reflectance = 2 pi max|C|^n / (n + 2). Reciprocal; conserves energy up to
// specular_reflectance 1, but published fits reach 1.7, with lobes that the horizon cuts.
// Source: Lafortune et al. 1997, Non-Linear Approximation of Reflectance Functions, eq. 4.

#include "bsdf/power_lobe.h"

namespace nacre {

template <class R, int C>
struct Lafortune : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color specular_reflectance, cx, cy, cz, exponent;

  static constexpr std::string_view name = "lafortune";
  static constexpr std::string_view source = "Lafortune et al. 1997, eq. 4; scaled as in Ngan et al. 2005";
  static constexpr std::string_view summary = "one generalised cosine lobe";
  static constexpr Laws laws{.energy_gain = 1}; // specular_reflectance = 2: the albedo itself, then 2
  static constexpr auto parameters() {
    return std::tuple{Parameter{&Lafortune::specular_reflectance, "specular_reflectance", "1", 0, 2, 0.5,
                                "albedo where the lobe is strongest"},
                      Parameter{&Lafortune::cx, "cx", "1", -1.5, 1.5, -1, "coefficient along the tangent"},
                      Parameter{&Lafortune::cy, "cy", "1", -1.5, 1.5, -1, "coefficient across the tangent"},
                      Parameter{&Lafortune::cz, "cz", "1", -1.5, 1.5, 1, "coefficient along the normal"},
                      Parameter{&Lafortune::exponent, "exponent", "1", 1, 2e5, 50, "sharpness n"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto up = same_upper_side(wo, wi);
    Color f;
    for (int i = 0; i < C; ++i) {
      const Turned t = turned(wo, i);
      // 1 - v . wi, exact to the last digit also where it is nearly 0
      const R drop = R(0.5f) * (length_squared(t.v - wi) + t.deficit);
      f[i] = (exponent[i] + R(2)) * constant<R>(0.5 * inv_pi) * power_of_cosine(drop, exponent[i]);
    }
    return select(up, specular_reflectance * f, Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const Color p = probabilities(wo);
    R density = R(0);
    for (int i = 0; i < C; ++i)
      density = density + p[i] * lobe(wo, i).density(wi);
    return select(same_upper_side(wo, wi), density, R(0));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const Color p = probabilities(wo);
    PowerLobe<R> chosen = lobe(wo, 0);
    R below = p[0];
    for (int i = 1; i < C; ++i) {
      const PowerLobe<R> next = lobe(wo, i);
      const auto take = u_lobe >= below;
      chosen = {select(take, next.axis, chosen.axis), select(take, next.exponent, chosen.exponent)};
      below = below + p[i];
    }
    const Vec3<R> wi = chosen.sample(u);
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

private:
  /// v = C wo / max|C|, no longer than 1; the lobe is (v . wi)^n.
  struct Turned {
    Vec3<R> v;
    R deficit; ///< 1 - |v|^2
  };
  Turned turned(const Vec3<R>& wo, int i) const {
    const R largest = max(max(abs(cx[i]), abs(cy[i])), max(abs(cz[i]), R(1e-6f))); // all 0: no lobe
    const R inv = R(1) / largest, x = cx[i] * inv, y = cy[i] * inv, z = cz[i] * inv;
    return {{x * wo.x, y * wo.y, z * wo.z},
            (R(1) - sqr(x)) * sqr(wo.x) + (R(1) - sqr(y)) * sqr(wo.y) + (R(1) - sqr(z)) * sqr(wo.z)};
  }
  PowerLobe<R> lobe(const Vec3<R>& wo, int i) const {
    const Vec3<R> v = turned(wo, i).v, up{R(0), R(0), R(1)};
    const R l2 = length_squared(v);
    const auto defined = l2 > R(1e-20f);
    return {select(defined, v / sqrt(select(defined, l2, R(1))), up), exponent[i]};
  }
  /// Of choosing a channel's lobe: in proportion to its strength |v|^n in this view.
  Color probabilities(const Vec3<R>& wo) const {
    Color p;
    R sum = R(0);
    for (int i = 0; i < C; ++i) {
      const R half_n = R(0.5f) * exponent[i];
      p[i] = specular_reflectance[i] * power_of_cosine(max(turned(wo, i).deficit, R(0)), half_n) + R(1e-6f);
      sum = sum + p[i];
    }
    return p / sum;
  }
};

} // namespace nacre

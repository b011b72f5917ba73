#pragma once
// Sheen of cloth and dust: light scattered many times in a thin layer of fibres that stand on the surface,
// fitted by a linearly transformed cosine. Never gains energy and is sampled in exact proportion. Not
// reciprocal: the fit knows the shape of the lobe for each viewer alone. The layer alone: what it lets
// through, 1 - R, is for the material below. Source: Zeltner, Burley and Chiang 2022, Practical
// Multiple-Scattering Sheen Using Linearly Transformed Cosines.

#include "bsdf/model.h"
#include "bsdf/zeltner_sheen_table.h"
#include "core/pack.h"
#include "core/warp.h"

namespace nacre {

template <class R, int C>
struct ZeltnerSheen : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color color;
  R roughness;

  static constexpr std::string_view name = "zeltner_sheen";
  static constexpr std::string_view source = "Zeltner, Burley and Chiang 2022";
  static constexpr std::string_view summary = "sheen of fibres by multiple scattering";
  static constexpr Laws laws{.reciprocal = false};
  static constexpr auto parameters() {
    return std::tuple{Parameter{&ZeltnerSheen::color, "color", "1", 0, 1, 1.0, "factor on the reflection"},
                      Parameter{&ZeltnerSheen::roughness, "roughness", "1", 0.1, 1, 0.5,
                                "how far fibres lean: square root of the SGGX fibres' cross section"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto up = same_upper_side(wo, wi);
    const Lobe lobe(wo.z, roughness);
    const Vec3<R> h = lobe.original(towards(wo, select(up, wi, Vec3<R>{R(0), R(0), R(1)}), R(-1)));
    // the cosine of the transformed direction is wi.z / length: the division by wi.z is done already
    return select(up, color * (lobe.albedo * lobe.density(h)), Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto up = same_upper_side(wo, wi);
    const Lobe lobe(wo.z, roughness);
    const Vec3<R> h = lobe.original(towards(wo, select(up, wi, Vec3<R>{R(0), R(0), R(1)}), R(-1)));
    return select(up, wi.z * lobe.density(h), R(0));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& u) const {
    const Lobe lobe(wo.z, roughness);
    const Vec3<R> h = square_to_cosine_hemisphere(u);
    const Vec3<R> w = normalize(Vec3<R>{h.x - lobe.b * h.z, h.y, lobe.a * h.z}); // a M h
    const Vec3<R> wi = towards(wo, w, R(1));
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }
  /// Share of the light from `wo` that the layer reflects, before the colour.
  R albedo(const Vec3<R>& wo) const { return Lobe(wo.z, roughness).albedo; }

private:
  /// The inverse matrix (a 0 b; 0 a 0; 0 0 1) in the frame where wo has azimuth 0, interpolated linearly.
  struct Lobe {
    R a, b, albedo;

    Lobe(const R& cos_o, const R& roughness) {
      namespace table = zeltner_sheen_table;
      using I = value_t<R>;
      const R column = clamp(cos_o, R(0), R(1)) * R(float(table::n_cos - 1));
      const R row = roughness * R(31) - R(float(table::first_row));
      const I c = min(floor(value(column)), I(float(table::n_cos - 2)));
      const I r = max(min(floor(value(row)), I(float(table::n_rows - 2))), I(0));
      const R s = column - R(c), t = row - R(r);
      const I first = r * I(float(table::n_cos)) + c;
      const auto at = [&](const float* plane) {
        const auto along = [&](const I& i) {
          return R(gather(plane, i)) * (R(1) - s) + R(gather(plane, I(i + I(1)))) * s;
        };
        return R(along(first) * (R(1) - t) + along(I(first + I(float(table::n_cos)))) * t);
      };
      a = at(table::a.data()), b = at(table::b.data()), albedo = at(table::albedo.data());
    }
    Vec3<R> original(const Vec3<R>& w) const { return {a * w.x + b * w.z, a * w.y, w.z}; }
    /// Density of the lobe over wi.z, for the untransformed direction h.
    R density(const Vec3<R>& h) const {
      // Where the layer is seen flat against the light its fibres end: 1e-12 keeps a direction in a lobe
      // that is narrower than float from dividing by 0.
      return constant<R>(inv_pi) * sqr(a / max(length_squared(h), R(1e-12f)));
    }
  };
  /// `w` turned about the normal by sign times wo's azimuth.
  static Vec3<R> towards(const Vec3<R>& wo, const Vec3<R>& w, const R& sign) {
    const R s2 = sin2_theta(wo);
    const auto tilted = s2 > R(1e-20f);
    const R inv = R(1) / sqrt(select(tilted, s2, R(1)));
    const R x = select(tilted, wo.x * inv, R(1)), y = sign * select(tilted, wo.y * inv, R(0));
    return {x * w.x - y * w.y, y * w.x + x * w.y, w.z};
  }
};

} // namespace nacre

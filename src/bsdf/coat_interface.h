#pragma once
// The rough surface of a clear coat as light meets it from both sides: reflection outside, reflection inside,
// passage. The passage is kept in its symmetric form, without the eta^2 that radiance gains on entering and
// loses on leaving: a path that ends above the coat does both as often.
//
// Facets scatter once; what they lose to masking comes back in diffuse lobes that keep energy and
// reciprocity, f = l(wo) l(wi) / (pi mean l), l the loss in a direction, shared between reflection and
// passage. Source: Walter et al. 2007, eq. 20, 21; Kulla and Conty 2017, Revisiting Physically Based Shading
// at Imageworks, for the lobes.

#include "bsdf/microfacet_reflection.h"
#include "core/warp.h"
#include "optics/fresnel.h"
#include "optics/ggx_albedo.h"

namespace nacre {

/// A parameter's value without its derivatives: what sampling decisions may depend on. An estimate f / p with
/// f differentiated at a sample that stands still, over the density p as a mere number, has the derivative of
/// the expectation as its expectation.
template <class R>
R detached(const R& x) {
  return R(value(x));
}
template <class R, int C>
Spectrum<R, C> detached(const Spectrum<R, C>& x) {
  return x.map([](const R& v) { return detached(v); });
}

/// GGX facets of a dielectric. Directions are in the frame of their side: z points into the medium that they
/// are in, x and y are the same for both.
template <class R>
class CoatInterface {
public:
  R eta;          ///< index of the coat / index outside, at least 1.05: a passage's half vector needs a bend
  R alpha;        ///< roughness, at least 1e-3
  R compensation; ///< share of the facets' loss that comes back, in [0, 1]

  CoatInterface(const R& coat_eta, const R& coat_alpha, const R& share)
      : eta(coat_eta), alpha(coat_alpha), compensation(share) {
    const GgxAlbedo& table = GgxAlbedo::table();
    for (const bool inside : {false, true}) {
      const R index = inside ? R(R(1) / eta) : eta;
      mean_loss_[inside] = max(R(1) - table.dielectric_reflection_average(alpha, index) -
                                   table.dielectric_transmission_average(alpha, index),
                               R(1e-6f));
    }
    // Reciprocity wants passed_[0] mean_loss_[0] = passed_[1] mean_loss_[1] eta^2. In the shares that smooth
    // glass lets pass, as far as that allows.
    const R in = R(1) - fresnel_dielectric_average_inside(eta), common = min(mean_loss_[0], mean_loss_[1]);
    passed_[0] = in * eta * eta * common / mean_loss_[0];
    passed_[1] = in * common / mean_loss_[1];
  }

  Ggx<R> facets() const { return {alpha, alpha}; }
  CoatInterface at_rest() const {
    if constexpr (std::is_same_v<R, value_t<R>>)
      return *this;
    else
      return {detached(eta), detached(alpha), detached(compensation)};
  }

  /// A direction on one side, in that side's frame, with the share of its light that facets scatter to
  /// nowhere: looked up once.
  struct Ray {
    Vec3<R> w;
    R loss;
  };
  Ray ray(const Vec3<R>& w, bool inside) const { return {w, loss(w.z, inside)}; }

  /// BRDF of one side.
  R reflect(const Ray& o, const Ray& i, bool inside) const {
    const auto f = reflect_from_facets(facets(), o.w, i.w, R(0));
    const R lost =
        compensation * (R(1) - passed_[inside]) * o.loss * i.loss / mean_loss_[inside] * constant<R>(inv_pi);
    return fresnel_dielectric(inside ? R(-f.cos_m) : f.cos_m, eta).reflectance * f.value +
           select(same_upper_side(o.w, i.w), lost, R(0));
  }
  /// Directions for `reflect` from inside, and their density.
  Vec3<R> sample_reflection_inside(const Ray& o, const R& u_lobe, const Vec2<R>& u) const {
    const Vec3<R> mirrored = nacre::reflect(o.w, facets().sample_visible(o.w, u));
    return select(u_lobe < diffuse_reflection_share(o), square_to_cosine_hemisphere(u), mirrored);
  }
  R reflection_inside_pdf(const Ray& o, const Vec3<R>& wi) const {
    const R q = diffuse_reflection_share(o);
    return (R(1) - q) * facet_reflection_pdf(facets(), o.w, wi) +
           q * select(same_upper_side(o.w, wi), wi.z * constant<R>(inv_pi), R(0));
  }

  /// value: eq. 21 without eta^2 and the lobe, symmetric; density: of `below` by sample_pass.
  struct Passage {
    R value, density;
  };
  Passage pass(const Ray& above, const Ray& below) const {
    const auto usable = same_upper_side(above.w, below.w);
    const Vec3<R> up{R(0), R(0), R(1)};
    const Vec3<R> a = select(usable, above.w, up), b = select(usable, below.w, up), down{b.x, b.y, -b.z};
    const Vec3<R> h = a + down * eta; // eq. 16; no shorter than eta - 1
    const R l2 = length_squared(h);
    const Vec3<R> wm = h * (R(-1) / sqrt(l2));
    const R c_a = dot(a, wm), c_b = -dot(down, wm);
    const auto facing = (wm.z > R(0)) & (c_a > R(0)) & (c_b > R(0));
    const Ggx<R> d = facets();
    const R visible = select(facing, d.D(wm) * c_a / (a.z + d.lambda_cos(a)), R(0));
    const R jacobian = c_b / l2; // without eta^2, eq. 17
    const R F = fresnel_dielectric(c_a, eta).reflectance;
    const R lost = compensation * passed_[0] * above.loss * below.loss / (mean_loss_[1] * eta * eta) *
                   constant<R>(inv_pi);
    const R q = diffuse_pass_share(above);
    const R density = (R(1) - q) * visible * jacobian * eta * eta + q * b.z * constant<R>(inv_pi);
    return {select(usable, (R(1) - F) * visible * jacobian / (b.z + d.lambda_cos(b)) + lost, R(0)),
            select(usable, density, R(0))};
  }
  /// In the frame of the inside; not above its horizon when the facet is too steep.
  Vec3<R> sample_pass(const Ray& above, const R& u_lobe, const Vec2<R>& u) const {
    const Vec3<R> t = refract(above.w, facets().sample_visible(above.w, u), R(1) / eta);
    return select(u_lobe < diffuse_pass_share(above), square_to_cosine_hemisphere(u),
                  Vec3<R>{t.x, t.y, -t.z});
  }

  /// Reflection (z > 0) or passage (z < 0) of light on one side, in the frame of that side, by the energy of
  /// each. A facet that is masked after all hands its light to the lobe, with other numbers.
  struct Scattered {
    Vec3<R> w;
    R weight; ///< 1 from facets, near 1 from the lobe, 0 where light is lost
  };
  struct Numbers {
    R seen, lobe, lost_lobe;
    Vec2<R> facet, lost_direction;
  };
  Scattered scatter(const Vec3<R>& wo, bool inside, const Numbers& u) const {
    const Ggx<R> d = facets();
    const R index = inside ? R(R(1) / eta) : eta;
    const Vec3<R> wm = d.sample_visible(wo, u.facet);
    const auto mirrored = u.lobe < fresnel_dielectric(dot(wo, wm), index).reflectance;
    const Vec3<R> w = select(mirrored, nacre::reflect(wo, wm), refract(wo, wm, R(1) / index));
    const auto right_side = (mirrored & (w.z > R(0))) | ((!mirrored) & (w.z < R(0)));
    const Vec3<R> i = select(right_side, Vec3<R>{w.x, w.y, abs(w.z)}, Vec3<R>{R(0), R(0), R(1)});
    // G2 / G1(wo) in reflection, G1(wi) in passage
    const R seen = select(
        right_side,
        select(mirrored, R(4) * visibility(d, wo, i, R(0)) * i.z * (wo.z + d.lambda_cos(wo)), smith_g1(d, i)),
        R(0));
    const auto by_facet = u.seen < seen;
    const Vec3<R> diffuse = square_to_cosine_hemisphere(u.lost_direction);
    const auto passes = u.lost_lobe < passed_[inside];
    const R lobe = compensation * select(passes, loss(diffuse.z, !inside) / mean_loss_[!inside],
                                         loss(diffuse.z, inside) / mean_loss_[inside]);
    return {select(by_facet, w, select(passes, -diffuse, diffuse)), select(by_facet, R(1), lobe)};
  }

private:
  R loss(const R& cos, bool inside) const {
    const R index = inside ? R(R(1) / eta) : eta, c = max(cos, R(0));
    const GgxAlbedo& table = GgxAlbedo::table();
    return clamp(R(R(1) - table.dielectric_reflection(c, alpha, index) -
                   table.dielectric_transmission(c, alpha, index)),
                 R(0), R(0.99f));
  }
  /// How often sampling takes the lobe rather than the facets; any share in (0, 1) is right, and this one is
  /// near the lobe's share of the energy.
  R diffuse_pass_share(const Ray& above) const {
    const R lost = compensation * passed_[0] * above.loss;
    const R T = R(1) - fresnel_dielectric(above.w.z, eta).reflectance;
    return lost / max(lost + T * (R(1) - above.loss), R(1e-6f));
  }
  R diffuse_reflection_share(const Ray& o) const {
    const R lost = compensation * (R(1) - passed_[1]) * o.loss;
    const R F = fresnel_dielectric(-o.w.z, eta).reflectance;
    return lost / max(lost + F * (R(1) - o.loss), R(1e-6f));
  }
  /// Snell: w refracted in the facet wm it faces; grazing where it would be reflected totally.
  /// @param ratio  index on w's side / index on the other
  static Vec3<R> refract(const Vec3<R>& w, const Vec3<R>& wm, const R& ratio) {
    const R c = dot(w, wm);
    const R cos_t = safe_sqrt(R(1) - ratio * ratio * max(R(1) - c * c, R(0)));
    return normalize(wm * (ratio * c - cos_t) - w * ratio);
  }

  R mean_loss_[2]; ///< 2 int loss(c) c dc, outside and inside
  R passed_[2];    ///< share of the lobes that goes through, seen from outside and inside
};

} // namespace nacre

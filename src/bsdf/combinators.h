#pragma once
// New scattering functions from given ones: scaled, two-sided, masked, with a perturbed normal, one over the
// other. Each holds models by value, works for every number type and keeps the laws that its parts keep.

#include "bsdf/model.h"
#include "core/random_stream.h"

#include <array>

namespace nacre {

/// What a combinator asks of its parts: a model, or another combinator.
template <class M>
concept ScatteringFunction = requires(const M m, Vec3<typename M::Number> w, typename M::Number u,
                                      Vec2<typename M::Number> u2) {
  { m.eval(w, w) } -> std::same_as<typename M::Color>;
  { m.pdf(w, w) } -> std::same_as<typename M::Number>;
  { m.sample(w, u, u2) } -> std::same_as<BsdfSample<typename M::Number, M::channel_count>>;
  { M::laws } -> std::convertible_to<Laws>;
};

/// One choice of two by a uniform number that remains uniform for the next choice.
template <class R>
struct Choice {
  mask_t<R> first;
  R u;
  /// @param p  probability of the first, in [0, 1]
  Choice(const R& u_old, const R& p) : first(u_old < p) {
    const R low = select(first, R(0), p), width = select(first, p, R(1) - p);
    u = clamp(R((u_old - low) / select(width > R(0), width, R(1))), R(0), R(0.99999994f));
  }
};

/// f times a factor a channel in [0, 1].
template <ScatteringFunction M>
struct Scaled {
  using Number = typename M::Number;
  using Color = typename M::Color;
  static constexpr int channel_count = M::channel_count;
  static constexpr Laws laws = M::laws;
  M model;
  Color factor;

  Color eval(const Vec3<Number>& wo, const Vec3<Number>& wi) const { return model.eval(wo, wi) * factor; }
  Number pdf(const Vec3<Number>& wo, const Vec3<Number>& wi) const { return model.pdf(wo, wi); }
  BsdfSample<Number, channel_count> sample(const Vec3<Number>& wo, const Number& u_lobe,
                                           const Vec2<Number>& u) const {
    auto s = model.sample(wo, u_lobe, u);
    s.f *= factor;
    return s;
  }
};

/// A reflecting model on both sides of a sheet.
template <ScatteringFunction M>
struct TwoSided {
  static_assert(!M::laws.transmits);
  using Number = typename M::Number;
  using Color = typename M::Color;
  static constexpr int channel_count = M::channel_count;
  static constexpr Laws laws = M::laws;
  M model;

  Color eval(const Vec3<Number>& wo, const Vec3<Number>& wi) const {
    return model.eval(from_front(wo, wo), from_front(wo, wi));
  }
  Number pdf(const Vec3<Number>& wo, const Vec3<Number>& wi) const {
    return model.pdf(from_front(wo, wo), from_front(wo, wi));
  }
  BsdfSample<Number, channel_count> sample(const Vec3<Number>& wo, const Number& u_lobe,
                                           const Vec2<Number>& u) const {
    auto s = model.sample(from_front(wo, wo), u_lobe, u);
    s.wi = from_front(wo, s.wi);
    return s;
  }

private:
  static Vec3<Number> from_front(const Vec3<Number>& wo, const Vec3<Number>& w) {
    return {w.x, w.y, select(wo.z < Number(0), -w.z, w.z)};
  }
};

/// A model with holes: `opacity` is the share of the area that it covers, and the rest lets light straight
/// through, as a delta lobe.
template <ScatteringFunction M>
struct Masked {
  using Number = typename M::Number;
  using Color = typename M::Color;
  static constexpr int channel_count = M::channel_count;
  static constexpr Laws laws = [] {
    Laws l = M::laws;
    l.thin = l.thin || !l.transmits;
    l.transmits = true;
    return l;
  }();
  M model;
  Number opacity; ///< in [0, 1]

  Color eval(const Vec3<Number>& wo, const Vec3<Number>& wi) const { return model.eval(wo, wi) * opacity; }
  Number pdf(const Vec3<Number>& wo, const Vec3<Number>& wi) const { return model.pdf(wo, wi) * opacity; }
  BsdfSample<Number, channel_count> sample(const Vec3<Number>& wo, const Number& u_lobe,
                                           const Vec2<Number>& u) const {
    using R = Number;
    const Choice<R> covered(u_lobe, opacity);
    const auto s = model.sample(wo, covered.u, u);
    const R cos = abs(wo.z), hole = select(cos > R(0), R(1) - opacity, R(0));
    return {select(covered.first, s.wi, -wo),
            select(covered.first, s.f * opacity, Color(hole / select(cos > R(0), cos, R(1)))),
            select(covered.first, s.pdf * opacity, hole),
            mask_t<R>((covered.first & s.is_delta) | !covered.first)};
  }
};

/// The normal of a height field from its slopes along tangent and bitangent: a bump map is a normal map.
template <class R>
Vec3<R> bump_normal(const R& dh_dx, const R& dh_dy) {
  return normalize(Vec3<R>{-dh_dx, -dh_dy, R(1)});
}

/// A perturbed normal as a piece of surface: one face along the normal, one upright mirror, over a unit of
/// ground. What leaves the face and does not get out meets the mirror, and what leaves the mirror and does
/// not get out meets the face. Source: Schuessler et al. 2017, section 4.
template <class R>
struct NormalWedge {
  Frame<R> frame; ///< of the model's face
  Vec3<R> mirror; ///< normal of the upright face
  R face_area, mirror_area;

  explicit NormalWedge(const Vec3<R>& n_any) {
    const Vec3<R> n = normalize(Vec3<R>{n_any.x, n_any.y, max(n_any.z, R(0.02f))});
    const R sin2 = n.x * n.x + n.y * n.y;
    const auto tilted = sin2 > R(1e-10f);
    const R sin = sqrt(select(tilted, sin2, R(1)));
    const Vec3<R> x{R(1), R(0), R(0)};
    mirror = select(tilted, Vec3<R>{-n.x / sin, -n.y / sin, R(0)}, x);
    face_area = R(1) / n.z;
    mirror_area = select(tilted, sin / n.z, R(0));
    frame = Frame<R>::with_tangent(n, x);
  }
  R seen_face(const Vec3<R>& w) const { return face_area * max(dot(w, frame.n), R(0)); }
  R seen_mirror(const Vec3<R>& w) const { return mirror_area * max(dot(w, mirror), R(0)); }
  /// Of what w sees, w.z > 0: eq. 9.
  R share_of_face(const Vec3<R>& w) const {
    const R face = seen_face(w);
    return face / max(face + seen_mirror(w), R(1e-30f));
  }
  /// Share of a face's points that see out along w: eq. 10. The same on both faces; 0 below the ground.
  R visibility(const Vec3<R>& w) const {
    const R seen = seen_face(w) + seen_mirror(w);
    return min(R(1), R(max(w.z, R(0)) / max(seen, R(1e-30f))));
  }
  /// Visibility for light that leaves the mirror along w.
  R from_mirror(const Vec3<R>& w) const { return select(dot(w, mirror) > R(0), visibility(w), R(0)); }
  Vec3<R> mirrored(const Vec3<R>& w) const { return w - mirror * (R(2) * dot(w, mirror)); }
};

/// A reflecting model whose normal is perturbed, without black rims and without gain: the surface is taken
/// for a sheet of wedges, one face along the perturbed normal with the model on it, the other an upright
/// mirror that keeps the mean normal where it was. Light meets the model once, the mirror before, after or
/// both; what would meet the model twice is lost. Reciprocal if the model is.
/// Source: Schuessler et al. 2017, Microfacet-Based Normal Mapping for Robust Monte Carlo Path Tracing, ACM
/// TOG 36(6), section 4 (the wedge) and 4.3 (specular tangent face); mirror before and after is added here.
template <ScatteringFunction M>
struct NormalMapped {
  static_assert(!M::laws.transmits);
  using Number = typename M::Number;
  using Color = typename M::Color;
  static constexpr int channel_count = M::channel_count;
  static constexpr Laws laws = M::laws;
  M model;
  Vec3<Number> normal; ///< unit, in the frame of the surface; z at least 0.02, else raised

  Color eval(const Vec3<Number>& wo, const Vec3<Number>& wi) const {
    const auto up = same_upper_side(wo, wi);
    const Wedge w(normal);
    const Color f = over_ways<Color>(w, wo, wi, up, [&](const Vec3<Number>& o, const Vec3<Number>& i) {
      return model.eval(o, i) * max(i.z, Number(0));
    });
    return f * (Number(1) / select(up, wi.z, Number(1)));
  }
  Number pdf(const Vec3<Number>& wo, const Vec3<Number>& wi) const {
    const Wedge w(normal);
    return over_ways<Number>(w, wo, wi, same_upper_side(wo, wi),
                             [&](const Vec3<Number>& o, const Vec3<Number>& i) { return model.pdf(o, i); });
  }
  BsdfSample<Number, channel_count> sample(const Vec3<Number>& wo_any, const Number& u_lobe,
                                           const Vec2<Number>& u) const {
    using R = Number;
    const Wedge w(normal);
    const Vec3<R> up{R(0), R(0), R(1)}, wo = select(wo_any.z > R(0), wo_any, up);
    const R direct = w.share_of_face(wo);
    const Choice<R> face(u_lobe, direct);
    auto s = model.sample(w.frame.to_local(select(face.first, wo, w.mirrored(wo))), face.u, u);
    const R cos_face = max(s.wi.z, R(0));
    const Vec3<R> d = w.frame.to_world(s.wi), d_mirrored = w.mirrored(d);
    // Out at once, or by way of the mirror. Nothing of u is left, so a number of its own.
    const R escape = w.visibility(d), detour = w.from_mirror(d_mirrored) * (R(1) - escape);
    const R choice = RandomStream<R>(u_lobe, u).next();
    const auto at_once = choice < escape;
    const auto valid = (wo_any.z > R(0)) & (s.pdf > R(0)) & (choice < escape + detour);
    const Vec3<R> wi = select(valid, select(at_once, d, d_mirrored), up);
    const R way = select(face.first, direct, R(1) - direct) * select(at_once, escape, detour);
    const Color delta = s.f * (way * cos_face / wi.z);
    return {wi, select(valid, select(s.is_delta, delta, eval(wo, wi)), Color()),
            select(valid, select(s.is_delta, s.pdf * way, pdf(wo, wi)), R(0)), s.is_delta};
  }

private:
  using Wedge = NormalWedge<Number>;

  /// Sum over the four ways from wo to wi of value(o, i), directions in the frame of the face, times the
  /// way's probability.
  template <class Value, class F>
  static Value over_ways(const Wedge& w, const Vec3<Number>& wo_any, const Vec3<Number>& wi_any,
                         const mask_t<Number>& up, F value_of) {
    using R = Number;
    const Vec3<R> z{R(0), R(0), R(1)}, wo = select(up, wo_any, z), wi = select(up, wi_any, z);
    const R direct = w.share_of_face(wo);
    const Vec3<R> i_mirrored = w.mirrored(wi);
    const Vec3<R> o[2] = {w.frame.to_local(wo), w.frame.to_local(w.mirrored(wo))};
    const Vec3<R> i[2] = {w.frame.to_local(wi), w.frame.to_local(i_mirrored)};
    const R from[2] = {direct, R(1) - direct};
    const R to[2] = {select(dot(wi, w.frame.n) > R(0), w.visibility(wi), R(0)),
                     (R(1) - w.visibility(i_mirrored)) * w.from_mirror(wi)};
    Value sum = Value(R(0));
    for (int a = 0; a < 2; ++a)
      for (int b = 0; b < 2; ++b)
        sum = sum + value_of(o[a], i[b]) * R(from[a] * to[b]);
    return select(up, sum, Value(R(0)));
  }
};

/// The share of light that an isotropic model sends back up, over the cosine of its direction: piecewise
/// linear through means over the model's own samples.
template <class M>
class SampledAlbedo {
public:
  using R = typename M::Number;
  using Color = typename M::Color;
  static constexpr int n = 17, samples = 233;

  explicit SampledAlbedo(const M& model) {
    for (int k = 0; k < n; ++k) {
      const double cos = std::max(double(k) / (n - 1), 1e-3);
      const Vec3<R> wo = vec3<R>(Vec3d{std::sqrt(1 - cos * cos), 0, cos});
      for (int i = 0; i < samples;
           ++i) { // Fibonacci's lattice, 144 to 233; a Kronecker sequence for the lobe
        const auto at = [i](double step) {
          return constant<R>(0.9999999 * (i * step - std::floor(i * step)));
        };
        const auto s =
            model.sample(wo, at(0.6180339887498949), {constant<R>((i + 0.5) / samples), at(144.0 / 233)});
        const auto up = (s.wi.z > R(0)) & (s.pdf > R(0));
        node_[std::size_t(k)] +=
            select(up, s.f * (s.wi.z / select(up, s.pdf, R(1)) * constant<R>(1.0 / samples)), Color());
      }
    }
  }
  Color operator()(const R& cos_theta) const {
    const R x = clamp(cos_theta, R(0), R(1)) * R(float(n - 1));
    Color sum;
    for (int k = 0; k < n; ++k)
      sum += node_[std::size_t(k)] * max(R(1) - abs(x - R(float(k))), R(0));
    return sum;
  }

private:
  std::array<Color, n> node_;
};

/// One reflecting model over another: the top, and the base dimmed by what the top keeps from it, as seen
/// from whichever of the two directions the top keeps more. Reciprocal if both are, and its albedo is at most
/// top + (1 - top) base. Light that bounces between the two is left out; `LayeredWalk` knows it.
/// Source: the albedo scaling of glTF 2.0's extensions, KHR_materials_sheen.
/// @tparam TopAlbedo  from cos theta to the top's directional albedo a channel
template <ScatteringFunction Top, ScatteringFunction Base, class TopAlbedo = SampledAlbedo<Top>>
struct Layered {
  static_assert(!Base::laws.transmits);
  using Number = typename Top::Number;
  using Color = typename Top::Color;
  static constexpr int channel_count = Top::channel_count;
  static constexpr Laws laws{.reciprocal = Top::laws.reciprocal && Base::laws.reciprocal,
                             .energy_gain = Top::laws.energy_gain + Base::laws.energy_gain,
                             .stochastic = Top::laws.stochastic || Base::laws.stochastic};
  Top top;
  Base base;
  TopAlbedo top_albedo;

  Color eval(const Vec3<Number>& wo, const Vec3<Number>& wi) const {
    return select(same_upper_side(wo, wi), top.eval(wo, wi) + base.eval(wo, wi) * dimming(wo, wi), Color());
  }
  Number pdf(const Vec3<Number>& wo, const Vec3<Number>& wi) const {
    const Number p = probability_of_top(wo);
    return select(same_upper_side(wo, wi), p * top.pdf(wo, wi) + (Number(1) - p) * base.pdf(wo, wi),
                  Number(0));
  }
  BsdfSample<Number, channel_count> sample(const Vec3<Number>& wo, const Number& u_lobe,
                                           const Vec2<Number>& u) const {
    using R = Number;
    const R p = probability_of_top(wo);
    const Choice<R> on_top(u_lobe, p);
    const auto t = top.sample(wo, on_top.u, u), b = base.sample(wo, on_top.u, u);
    const Vec3<R> wi = select(on_top.first, t.wi, b.wi);
    const mask_t<R> delta = (on_top.first & t.is_delta) | ((!on_top.first) & b.is_delta);
    const Color f = select(on_top.first, t.f, b.f * dimming(wo, wi));
    const R density = select(on_top.first, p * t.pdf, (R(1) - p) * b.pdf);
    const auto valid = same_upper_side(wo, wi) & (density > R(0));
    return {wi, select(valid, select(delta, f, eval(wo, wi)), Color()),
            select(valid, select(delta, density, pdf(wo, wi)), R(0)), delta};
  }

private:
  Color dimming(const Vec3<Number>& wo, const Vec3<Number>& wi) const {
    return zip(top_albedo(wo.z), top_albedo(wi.z), [](const Number& o, const Number& i) {
      return Number(Number(1) - min(max(o, i), Number(1)));
    });
  }
  /// Neither is left out: the base may be brighter than white light on it suggests.
  Number probability_of_top(const Vec3<Number>& wo) const {
    return clamp(average(top_albedo(wo.z)), Number(0.1f), Number(0.9f));
  }
};

} // namespace nacre

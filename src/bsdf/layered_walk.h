#pragma once
// Light in a coat over an opaque base, estimated by random walks: through the rough interface, scattered and
// absorbed in the medium, off the base, back from the underside of the interface, and out. Lateral distance
// does not matter to a BSDF, so a walk knows its depth and direction alone. Every vertex is joined to a
// direction refracted from wi, and every arrival at the interface is let through to wi; the two estimates of
// one path are weighed by the balance heuristic.
// Source: Guo, Hasan and Zhao 2018, Position-Free Monte Carlo Simulation for Arbitrary Layered BSDFs, ACM
// TOG 37(6), section 5.1 (unidirectional); Pharr, Jakob and Humphreys 2023, PBR 4th ed., section 14.3.

#include "bsdf/coat_interface.h"
#include "bsdf/coat_medium.h"
#include "core/random_stream.h"

namespace nacre {

/// A model with every parameter detached.
template <class M>
M detached_model(const M& model) {
  M still = model;
  if constexpr (!std::is_same_v<typename M::Number, value_t<typename M::Number>>)
    for_each_parameter<M>([&](const auto& p) { still.*p.member = detached(model.*p.member); });
  return still;
}

/// @tparam Base  any reflecting model without delta lobes; its medium above is the coat
template <class Base>
struct LayeredWalk {
  using R = typename Base::Number;
  static constexpr int C = Base::channel_count;
  using Color = Spectrum<R, C>;
  /// What ends a walk that neither absorption nor roulette ends; at albedo 1, optical thickness 10, eta 2.5
  /// less than 1e-3 of the light is still inside.
  static constexpr int max_events = 1024;
  static constexpr int max_walks = 64;

  CoatInterface<R> interface;
  CoatMedium<R, C> medium;
  Base base;

  /// Estimate of f(wo, wi), the mean of `walks` (rounded up) independent walks plus the interface's own
  /// reflection.
  Color eval(const Vec3<R>& wo, const Vec3<R>& wi, const R& walks) const {
    const auto up = same_upper_side(wo, wi);
    const Vec3<R> normal{R(0), R(0), R(1)}, o = select(up, wo, normal), i = select(up, wi, normal);
    RandomStream<R> seeds(wo, wi);
    Color sum;
    R count = R(0);
    for (int k = 0; k < max_walks; ++k) {
      const mask_t<R> active = up & (max(walks, R(1)) > R(float(k)));
      if (!any(active)) break;
      // A stream a walk: its numbers must not depend on how long the walks of other lanes were.
      const R key = seeds.next();
      sum += walk(o, i, active, RandomStream<R>(key, seeds.next_2d()));
      count = count + select(active, R(1), R(0));
    }
    return select(up, Color(interface.reflect_outside(o, i)) + sum / max(count, R(1)), Color());
  }

  struct Sample {
    Vec3<R> wi;
    Color weight; ///< f |cos| / density of the walk
    mask_t<R> valid;
  };
  /// Follows light from wo until it leaves the coat.
  Sample sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const LayeredWalk still{{detached(interface.eta), detached(interface.alpha)},
                            {detached(medium.optical_thickness), detached(medium.albedo), detached(medium.g)},
                            detached_model(base)};
    return still.follow(wo, u_lobe, u);
  }

private:
  /// Light on its way through the coat.
  struct Traveller {
    Vec3<R> w; ///< direction of travel
    R depth;   ///< 0 at the interface, 1 at the base
    Color weight;
    R density; ///< with which w was sampled
    mask_t<R> alive;
    R channel;                                  ///< chooses the one whose scattering is followed
    Color share = Color(R(1));                  ///< see CoatMedium::fly
    mask_t<R> in_medium{}, at_base{}, at_top{}; ///< where the last flight ended

    /// Sets direction, weight and density where `mask`.
    void turn(const mask_t<R>& mask, const Vec3<R>& direction, const Color& factor, const R& p) {
      w = select(mask, direction, w);
      weight = select(mask, weight * factor, weight);
      density = select(mask, p, density);
      alive = alive & ((!mask) | (p > R(0)));
    }
    /// Faint light ends or gains weight.
    void play_roulette(const R& u) {
      const R survival = min(R(1), R(R(4) * detached(max_component(weight))));
      alive = alive & (u < survival);
      weight = weight * (R(1) / select(alive, survival, R(1)));
    }
  };
  /// The numbers of one event, the same count in every branch, so that lanes and scalars draw alike.
  struct Numbers {
    R flight, lobe;
    Vec2<R> direction;
    R roulette;
    explicit Numbers(RandomStream<R>& s)
        : flight(s.next()), lobe(s.next()), direction(s.next_2d()), roulette(s.next()) {}
  };

  void fly(Traveller& t, const Numbers& u) const {
    const auto down = t.w.z < R(0);
    const R cos = max(abs(t.w.z), R(1e-6f));
    t.in_medium = mask_t<R>(false);
    if (!medium.is_clear()) {
      const auto flight =
          medium.fly(select(down, R(1) - t.depth, t.depth) / cos, t.channel, u.flight, t.alive, t.share);
      t.weight = select(t.alive, t.weight * flight.weight, t.weight);
      t.in_medium = t.alive & flight.scattered;
      const R step = flight.length * cos;
      t.depth = clamp(R(t.depth + select(down, step, -step)), R(0), R(1));
    }
    t.at_base = t.alive & down & !t.in_medium;
    t.at_top = t.alive & !(down | t.in_medium);
    t.depth = select(t.at_base, R(1), select(t.at_top, R(0), t.depth));
  }
  void scatter(Traveller& t, const Numbers& u) const {
    const Vec3<R> w = medium.sample_phase(t.w, u.direction);
    const R phase = henyey_greenstein(dot(t.w, w), medium.g), density = detached(phase);
    t.turn(t.in_medium, w, Color(phase / density), density);
  }
  void bounce(Traveller& t, const Numbers& u, const Base& still) const {
    const Vec3<R> o = -t.w, safe = select(t.at_base, o, Vec3<R>{R(0), R(0), R(1)});
    const auto s = still.sample(safe, u.lobe, u.direction);
    const R density = select(s.wi.z > R(0), detached(s.pdf), R(0));
    t.turn(t.at_base, s.wi, base.eval(safe, s.wi) * (s.wi.z / select(density > R(0), density, R(1))),
           density);
  }
  void reflect_inside(Traveller& t, const Vec3<R>& o, const Vec3<R>& wm) const {
    const Vec3<R> i = reflect(o, wm);
    const R density = select(i.z > R(0), detached(facet_reflection_pdf(interface.facets(), o, i)), R(0));
    const R f = interface.reflect_inside(o, i);
    t.turn(t.at_top, {i.x, i.y, -i.z}, Color(f * i.z / select(density > R(0), density, R(1))), density);
  }
  /// The direction of arrival at the interface's underside, mirrored to lie above.
  static Vec3<R> arrival(const Traveller& t) {
    const Vec3<R> o{-t.w.x, -t.w.y, t.w.z};
    return select(t.at_top, o, Vec3<R>{R(0), R(0), R(1)});
  }
  static R balance(const R& mine, const R& other) { return mine / max(mine + other, R(1e-30f)); }

  /// Light that reaches wo from wi by one walk from wo.
  Color walk(const Vec3<R>& wo, const Vec3<R>& wi, const mask_t<R>& active, RandomStream<R> random) const {
    const CoatInterface<R> still{detached(interface.eta), detached(interface.alpha)};
    const Base still_base = detached_model(base);
    const R eta2 = interface.eta * interface.eta;
    // Both ends refracted into the coat: `in` begins the walk, `out` is where its vertices are joined to.
    struct End {
      Vec3<R> w;
      R weight, density, cos;
    };
    const auto enter = [&](const Vec3<R>& above) {
      const Vec3<R> below = still.sample_pass(above, random.next_2d());
      const auto p = interface.pass(above, below);
      const R density = detached(p.density), cos = max(-below.z, R(1e-6f));
      return End{below, p.value * cos / select(density > R(0), density, R(1)), density, cos};
    };
    const End in = enter(wo), out = enter(wi);
    Traveller t{
        in.w,         R(0), Color(in.weight * eta2), in.density, mask_t<R>(active & (in.density > R(0))),
        random.next()};
    const Vec3<R> w_out = -out.w;
    const auto joinable = out.density > R(0);
    Color sum;
    for (int event = 0; event < max_events; ++event) {
      if (!any(t.alive)) break;
      const Numbers u(random);
      fly(t, u);
      if (any(t.in_medium)) {
        const R phase = henyey_greenstein(dot(t.w, w_out), medium.g);
        const Color join = t.weight * medium.transmittance(t.depth / out.cos) *
                           (phase * out.weight / out.cos * balance(out.density, detached(phase)));
        sum += select(t.in_medium & joinable, join, Color());
        scatter(t, u);
      }
      if (any(t.at_base)) {
        const auto lit = t.at_base & joinable;
        const Vec3<R> normal{R(0), R(0), R(1)}, o = select(lit, -t.w, normal), i = select(lit, w_out, normal);
        const R weight = out.weight * balance(out.density, detached(still_base.pdf(o, i)));
        const Color join = t.weight * base.eval(o, i) * medium.transmittance(R(1) / out.cos) * weight;
        sum += select(lit, join, Color());
        bounce(t, u, still_base);
      }
      if (any(t.at_top)) {
        const auto p = interface.pass(wi, select(t.at_top, -t.w, Vec3<R>{R(0), R(0), R(-1)}));
        const R density = detached(p.density);
        sum += select(t.at_top, t.weight * (p.value * balance(t.density, density)), Color());
        const Vec3<R> o = arrival(t);
        reflect_inside(t, o, still.facets().sample_visible(o, u.direction));
      }
      t.play_roulette(u.roulette);
    }
    return sum;
  }

  Sample follow(const Vec3<R>& wo_any, const R& u_lobe, const Vec2<R>& u) const {
    const Ggx<R> d = interface.facets();
    const auto g1 = [&](const Vec3<R>& w) { return smith_g1(d, w); };
    const auto up = wo_any.z > R(0);
    const Vec3<R> wo = select(up, wo_any, Vec3<R>{R(0), R(0), R(1)});
    const Vec3<R> wm = d.sample_visible(wo, u);
    const auto mirrored = u_lobe < fresnel_dielectric(dot(wo, wm), interface.eta).reflectance;
    Sample s{reflect(wo, wm), Color(), mask_t<R>(up & mirrored)};
    s.valid = s.valid & (s.wi.z > R(0));
    const Vec3<R> i = select(s.valid, s.wi, Vec3<R>{R(0), R(0), R(1)});
    // G2 / G1(wo)
    s.weight = select(s.valid, Color(R(R(4) * visibility(d, wo, i, R(0)) * i.z * (wo.z + d.lambda_cos(wo)))),
                      Color());

    const Vec3<R> below = CoatInterface<R>::refract_in(wo, wm, R(1) / interface.eta);
    const mask_t<R> entered = up & (!mirrored) & (below.z < R(0));
    const Vec3<R> down = select(entered, below, Vec3<R>{R(0), R(0), R(-1)});
    RandomStream<R> random(u_lobe, u);
    Traveller t{down, R(0), Color(g1({down.x, down.y, -down.z})), R(1), entered, random.next()};
    for (int event = 0; event < max_events; ++event) {
      if (!any(t.alive)) break;
      const Numbers n(random);
      fly(t, n);
      if (any(t.in_medium)) scatter(t, n);
      if (any(t.at_base)) bounce(t, n, base);
      if (any(t.at_top)) {
        const Vec3<R> o = arrival(t), m = d.sample_visible(o, n.direction);
        const R F = fresnel_dielectric(-dot(o, m), interface.eta).reflectance;
        const auto leaves = t.at_top & !(n.lobe < F);
        const Vec3<R> beyond = CoatInterface<R>::refract_in(o, m, interface.eta);
        const Vec3<R> wi{beyond.x, beyond.y, -beyond.z};
        const auto out = leaves & (wi.z > R(0));
        const Vec3<R> safe = select(out, wi, Vec3<R>{R(0), R(0), R(1)});
        s.wi = select(out, wi, s.wi);
        s.weight = select(out, t.weight * g1(safe), s.weight);
        s.valid = s.valid | out;
        t.alive = t.alive & !leaves;
        t.at_top = t.at_top & !leaves;
        reflect_inside(t, o, m);
        // Reflection was chosen with probability F.
        t.weight = select(t.at_top, t.weight * (R(1) / select(t.at_top, max(F, R(1e-6f)), R(1))), t.weight);
      }
      t.play_roulette(n.roulette);
    }
    return s;
  }
};

} // namespace nacre

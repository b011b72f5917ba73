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
  using Ray = typename CoatInterface<R>::Ray;
  /// What ends a walk that neither absorption nor roulette ends; at albedo 1, optical thickness 10, eta 2.5
  /// less than 1e-3 of the light is still inside.
  static constexpr int max_events = 1024;
  static constexpr int max_walks = 32;

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
    return select(up,
                  Color(interface.reflect(interface.ray(o, false), interface.ray(i, false), false)) +
                      sum / max(count, R(1)),
                  Color());
  }

  struct Sample {
    Vec3<R> wi;
    Color weight; ///< f |cos| / density of the walk
    mask_t<R> valid;
  };
  /// Follows light from wo until it leaves the coat.
  Sample sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const LayeredWalk still{interface.at_rest(),
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
  void reflect_inside(Traveller& t, const Ray& o, const Numbers& u, const CoatInterface<R>& still) const {
    const Ray o_still{o.w, detached(o.loss)};
    const Vec3<R> i = still.sample_reflection_inside(o_still, u.lobe, u.direction);
    const R density = select(i.z > R(0), still.reflection_inside_pdf(o_still, i), R(0));
    const R f = interface.reflect(o, interface.ray(i, true), true);
    t.turn(t.at_top, flipped(i), Color(f * i.z / select(density > R(0), density, R(1))), density);
  }
  /// Between the frames of the two sides of the interface.
  static Vec3<R> flipped(const Vec3<R>& w) { return {w.x, w.y, -w.z}; }
  /// Where the light comes from that arrives at the interface's underside, in the frame of the inside.
  static Vec3<R> arrival(const Traveller& t) {
    return select(t.at_top, flipped(-t.w), Vec3<R>{R(0), R(0), R(1)});
  }
  static R balance(const R& mine, const R& other) { return mine / max(mine + other, R(1e-30f)); }

  /// Light that reaches wo from wi by one walk from wo.
  Color walk(const Vec3<R>& wo, const Vec3<R>& wi, const mask_t<R>& active, RandomStream<R> random) const {
    const CoatInterface<R> still = interface.at_rest();
    const Base still_base = detached_model(base);
    const R eta2 = interface.eta * interface.eta;
    // Both ends refracted into the coat: `in` begins the walk, `out` is where its vertices are joined to.
    struct End {
      Vec3<R> w;
      R weight, density, cos;
    };
    const Ray o = interface.ray(wo, false), i = interface.ray(wi, false);
    const auto enter = [&](const Ray& above) {
      const R u_lobe = random.next();
      const Vec3<R> below = still.sample_pass({above.w, detached(above.loss)}, u_lobe, random.next_2d());
      const auto p = interface.pass(above, interface.ray(below, true));
      const R density = detached(p.density), cos = max(below.z, R(1e-6f));
      return End{flipped(below), p.value * cos / select(density > R(0), density, R(1)), density, cos};
    };
    const End in = enter(o), out = enter(i);
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
        const Vec3<R> normal{R(0), R(0), R(1)}, from = select(lit, -t.w, normal),
                                                to = select(lit, w_out, normal);
        const R weight = out.weight * balance(out.density, detached(still_base.pdf(from, to)));
        const Color join = t.weight * base.eval(from, to) * medium.transmittance(R(1) / out.cos) * weight;
        sum += select(lit, join, Color());
        bounce(t, u, still_base);
      }
      if (any(t.at_top)) {
        const Ray below = interface.ray(arrival(t), true);
        const auto p = interface.pass(i, below);
        const R density = detached(p.density);
        sum += select(t.at_top, t.weight * (p.value * balance(t.density, density)), Color());
        reflect_inside(t, below, u, still);
      }
      t.play_roulette(u.roulette);
    }
    return sum;
  }

  static typename CoatInterface<R>::Numbers at_interface(RandomStream<R>& random, const R& u_lobe,
                                                         const Vec2<R>& u) {
    const R seen = random.next(), lost_lobe = random.next();
    return {seen, u_lobe, lost_lobe, u, random.next_2d()};
  }
  Sample follow(const Vec3<R>& wo_any, const R& u_lobe, const Vec2<R>& u) const {
    const auto up = wo_any.z > R(0);
    const Vec3<R> wo = select(up, wo_any, Vec3<R>{R(0), R(0), R(1)});
    RandomStream<R> random(u_lobe, u);
    const auto first = interface.scatter(wo, false, at_interface(random, u_lobe, u));
    const auto lit = up & (first.weight > R(0));
    Sample s{first.w, Color(first.weight), mask_t<R>(lit & (first.w.z > R(0)))};
    Traveller t{first.w, R(0), Color(first.weight), R(1), mask_t<R>(lit & (first.w.z < R(0))), random.next()};
    for (int event = 0; event < max_events; ++event) {
      if (!any(t.alive)) break;
      const Numbers n(random);
      const auto interface_numbers = at_interface(random, n.lobe, n.direction);
      fly(t, n);
      if (any(t.in_medium)) scatter(t, n);
      if (any(t.at_base)) bounce(t, n, base);
      if (any(t.at_top)) {
        const auto e = interface.scatter(arrival(t), true, interface_numbers);
        const auto out = t.at_top & (e.w.z < R(0)) & (e.weight > R(0));
        s.wi = select(out, flipped(e.w), s.wi);
        s.weight = select(out, t.weight * e.weight, s.weight);
        s.valid = s.valid | out;
        t.turn(t.at_top, flipped(e.w), Color(e.weight), e.weight);
        t.alive = t.alive & !out;
      }
      t.play_roulette(n.roulette);
    }
    return s;
  }
};

} // namespace nacre

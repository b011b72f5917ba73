#pragma once
// Ground glass with all bounces among its facets, reflected and refracted, above and below the surface. No
// light is lost. The first bounce is evaluated exactly, the others by random walks on Smith's microsurface
// from both ends, combined by multiple importance sampling. Reciprocal, with the eta^2 of transmission, in
// the mean. Source: Heitz, Hanika, d'Eon, Dachsbacher 2016, Multiple-Scattering Microfacet BSDFs with the
// Smith Model.

#include "bsdf/microfacet_reflection.h"
#include "core/random_stream.h"
#include "optics/fresnel.h"
#include "optics/smith_walk.h"

namespace nacre {

template <class R, int C, template <class> class Distribution>
struct WalkDielectric : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  R eta, alpha_x, alpha_y, walks;

  static constexpr bool is_ggx = std::is_same_v<Distribution<R>, Ggx<R>>;
  static constexpr std::string_view name = is_ggx ? "walk_ggx_dielectric" : "walk_beckmann_dielectric";
  static constexpr std::string_view source = "Heitz et al. 2016";
  static constexpr std::string_view summary = is_ggx ? "ground glass, all bounces by random walk, GGX facets"
                                                     : "ground glass, all bounces by random walk, Beckmann";
  static constexpr Laws laws{.transmits = true, .stochastic = true};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&WalkDielectric::eta, "eta", "1", 0.25, 4, 1.5, "index inside / index outside"},
        Parameter{&WalkDielectric::alpha_x, "alpha_x", "1", 1e-3, 1, 0.5, "roughness along the tangent"},
        Parameter{&WalkDielectric::alpha_y, "alpha_y", "1", 1e-3, 1, 0.5, "roughness along the bitangent"},
        Parameter{&WalkDielectric::walks, "walks", "1", 1, 256, 4, "pairs of walks averaged by an evaluation",
                  false}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto valid = (wo.z != R(0)) & (wi.z != R(0)) & !no_interface();
    const End o = end(wo, valid), i = end(wi, valid);
    // Masks are compared by != and ==: with AVX-512, xsimd 8 computes their ^ as an |.
    const R crossing =
        select(o.outside != i.outside, R(1) / sqr(o.eta_ti), R(1)); // radiance grows with eta^2
    RandomStream<R> random(wo, wi);
    const R n = R(floor(value(walks) + value_t<R>(0.5f)));
    R more(0);
    for (int w = 0; w < 256 && any(R(float(w)) < n); ++w)
      more += select(R(float(w)) < n, walk(o, i, valid, random) * crossing + walk(i, o, valid, random), R(0));
    return Color(select(valid, first_bounce(o, i) + more / n, R(0)));
  }

  /// Near to the density that the walk samples: a first bounce, and diffuse light for what comes later, about
  /// 0.3 alpha of all, to either side as Fresnel's equations say for 60 degrees, but never 0.
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto valid = (wo.z != R(0)) & (wi.z != R(0)) & !no_interface();
    const End o = end(wo, valid), i = end(wi, valid);
    const auto same = o.outside == i.outside;
    const R later = constant<R>(0.3) * sqrt(alpha_x * alpha_y);
    const R reflected =
        constant<R>(0.05) + constant<R>(0.9) * fresnel_dielectric(R(0.5f), o.eta_ti).reflectance;
    const R diffuse = select(same, reflected, R(1) - reflected) * i.w.z * constant<R>(inv_pi);
    const R single = scattered(o.w, select(same, i.w, -i.w), o.eta_ti, same).density;
    return select(valid, (R(1) - later) * single + later * diffuse, R(0));
  }

  /// The walk from wo until it leaves.
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const Distribution<R> d = distribution();
    RandomStream<R> random(u_lobe, u);
    const auto straight = no_interface();
    const auto valid = (wo.z != R(0)) & !straight;
    const End start = end(wo, valid);
    Ray ray{-start.w, next_facet(d, Vec3<R>(-start.w), R(0), random.next()), start.eta_ti, start.outside};
    auto inside = valid;
    for (int bounce = 0; bounce < smith_walk_bounces && any(inside); ++bounce) {
      Ray next = bounce == 0 ? scatter(ray, u, u_lobe) : scatter(ray, random.next_2d(), random.next());
      next.depth = next_facet(d, next.r, next.depth, random.next());
      ray = choose(inside, next, ray);
      inside = inside & (ray.depth > R(0));
    }
    const auto left = valid & !inside & (ray.r.z > R(0));
    const Vec3<R> up{R(0), R(0), R(1)}, wi = select(ray.outside, ray.r, -ray.r);
    const auto crossed = start.outside != ray.outside;
    const R density = pdf(select(left, wo, up), select(left, wi, up));
    const R weight = select(crossed, R(1) / sqr(start.eta_ti), R(1));
    const R f = weight * density / max(abs(wi.z), R(1e-9f));
    const auto crosses = wo.z != R(0);
    const R through = R(1) / select(crosses, abs(wo.z), R(1));
    return {select(straight, -wo, select(left, wi, up)),
            Color(select(straight, select(crosses, through, R(0)), select(left, f, R(0)))),
            select(straight, select(crosses, R(1), R(0)), select(left, density, R(0))), straight};
  }

  /// Single scattering: reflection with correlated heights, transmission with the heights that are lit from
  /// one side and seen from the other.
  R single_scattering(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto valid = (wo.z != R(0)) & (wi.z != R(0)) & !no_interface();
    return select(valid, first_bounce(end(wo, valid), end(wi, valid)), R(0));
  }

private:
  Distribution<R> distribution() const { return {alpha_x, alpha_y}; }
  /// Equal indices: there is no surface, light goes straight on as through a delta lobe.
  mask_t<R> no_interface() const { return abs(eta - R(1)) < R(1e-5f); }

  /// A direction in the frame of the medium it lies in, where the surface's normal points into that medium:
  /// the world itself outside, the world with all vectors negated inside.
  struct End {
    Vec3<R> w;
    R eta_ti; ///< index on the other side / index on this side
    mask_t<R> outside;
  };
  End end(const Vec3<R>& w, const mask_t<R>& valid) const {
    const auto outside = !(w.z < R(0));
    const Vec3<R> up{R(0), R(0), R(1)};
    return {select(valid, select(outside, w, -w), up), select(outside, eta, R(1) / eta), outside};
  }
  /// A ray among the facets, in the frame of its medium.
  struct Ray {
    Vec3<R> r;
    R depth, eta_ti;
    mask_t<R> outside;
  };
  static Ray choose(const mask_t<R>& mask, const Ray& a, const Ray& b) {
    return {select(mask, a.r, b.r), select(mask, a.depth, b.depth), select(mask, a.eta_ti, b.eta_ti),
            mask_t<R>((mask & a.outside) | ((!mask) & b.outside))};
  }

  /// The light that comes along -w and is scattered to t, by the facet that can do so, in the medium of w.
  struct Scattered {
    R D, F, density, cos_w, cos_t; ///< density: per sr of t, given that w meets a facet
    R jacobian;                    ///< dwm / dt; Walter et al. 2007, eq. 14 and 17
    mask_t<R> possible;
  };
  Scattered scattered(const Vec3<R>& w, const Vec3<R>& t, const R& eta_ti, const mask_t<R>& same) const {
    const Distribution<R> d = distribution();
    Vec3<R> h = select(same, w + t, w + t * eta_ti);
    h = h * select(dot(w, h) < R(0), R(-1), R(1));
    const R length2 = length_squared(h);
    const auto defined = (length2 > R(1e-12f)) & (h.z > R(0));
    const Vec3<R> wm = select(defined, h, Vec3<R>{R(0), R(0), R(1)}) / sqrt(select(defined, length2, R(1)));
    const R cos_w = dot(w, wm), cos_t = dot(t, wm), sum = cos_w + eta_ti * cos_t;
    const R safe = select(same | (abs(sum) < R(1e-9f)), R(1), sum);
    const mask_t<R> possible = defined & (cos_w > R(0)) & (same != (cos_t < R(0)));
    const R D = d.D(wm), F = fresnel_dielectric(R(max(cos_w, R(1e-6f))), eta_ti).reflectance;
    const R jacobian = select(same, R(0.25f) / max(cos_w, R(1e-6f)), abs(cos_t) * sqr(eta_ti / safe));
    const R chance = select(same, F, R(1) - F) * cos_w * jacobian * D / max(seen_area(d, w), R(1e-10f));
    return {D, F, select(possible, chance, R(0)), cos_w, cos_t, jacobian, possible};
  }
  R first_bounce(const End& o, const End& i) const {
    const auto same = o.outside == i.outside;
    const Distribution<R> d = distribution();
    const Scattered s = scattered(o.w, select(same, i.w, -i.w), o.eta_ti, same);
    const R reflection = s.F * s.D * visibility(d, o.w, i.w, R(0));
    const R co = max(o.w.z, R(1e-9f)), ci = max(i.w.z, R(1e-9f));
    const R seen = beta(R(R(1) + d.lambda_cos(o.w) / co), R(R(1) + d.lambda_cos(i.w) / ci)) / (co * ci);
    const R transmission = (R(1) - s.F) * s.D * s.cos_w * s.jacobian * seen / sqr(o.eta_ti);
    return select(s.possible, select(same, reflection, transmission), R(0));
  }

  /// The ray after a facet at its depth, and in `density` that of its direction.
  Ray scatter(const Ray& ray, const Vec2<R>& u, const R& u_lobe, R* density = nullptr) const {
    const Distribution<R> d = distribution();
    const Vec3<R> w = -ray.r, wm = d.sample_visible(w, u);
    const R c = max(dot(w, wm), R(1e-6f));
    const auto fresnel = fresnel_dielectric(c, ray.eta_ti);
    const auto reflected = u_lobe < fresnel.reflectance;
    const R inv_eta = R(1) / ray.eta_ti;
    const Vec3<R> t = wm * (c * inv_eta + fresnel.cos_t) - w * inv_eta;
    if (density) {
      const R jacobian = select(
          reflected, R(0.25f),
          c * abs(fresnel.cos_t) * sqr(ray.eta_ti / select(reflected, R(1), c + ray.eta_ti * fresnel.cos_t)));
      *density = select(reflected, fresnel.reflectance, R(1) - fresnel.reflectance) * jacobian *
                 seen_density(d, w, wm);
    }
    return {normalize(select(reflected, reflect(w, wm), -t)),
            select(reflected, ray.depth, depth_from_other_side(ray.depth)),
            select(reflected, ray.eta_ti, inv_eta), mask_t<R>(reflected == ray.outside)};
  }

  /// One walk from `from`; at its second and every later facet the light that goes on to `to`, per cosine
  /// there, weighted against the walk from the other end by the balance heuristic over what the two choose at
  /// their first facets.
  R walk(const End& from, const End& to, const mask_t<R>& valid, RandomStream<R>& random) const {
    const Distribution<R> d = distribution();
    const R path_out = free_path(d, to.w), inv_cos_out = R(1) / max(to.w.z, R(1e-9f));
    const R depth = next_facet(d, Vec3<R>(-from.w), R(0), random.next());
    const Vec2<R> u = random.next_2d();
    R first(0), weight(1), sum(0);
    Ray ray = scatter({-from.w, depth, from.eta_ti, from.outside}, u, random.next(), &first);
    ray.depth = next_facet_surely(d, ray.r, ray.depth, random.next(), weight);
    auto inside = valid;
    for (int bounce = 2; bounce <= smith_walk_bounces; ++bounce) {
      const auto same = ray.outside == to.outside;
      const R on = scattered(-ray.r, select(same, to.w, -to.w), ray.eta_ti, same).density;
      const R back = scattered(to.w, select(same, -ray.r, ray.r), to.eta_ti, same).density;
      const R total = first + back;
      const R share = first / select(total > R(1e-20f), total, R(1));
      const R out =
          escape_probability(R(select(same, ray.depth, depth_from_other_side(ray.depth))), path_out);
      sum += select(inside, weight * on * share * out * inv_cos_out, R(0));

      const Vec2<R> v = random.next_2d();
      Ray next = scatter(ray, v, random.next());
      next.depth = next_facet(d, next.r, next.depth, random.next());
      inside = inside & (next.depth > R(0));
      if (!any(inside)) break;
      ray = choose(inside, next, ray);
    }
    return sum;
  }
};

template <class R, int C>
using WalkGgxDielectric = WalkDielectric<R, C, Ggx>;
template <class R, int C>
using WalkBeckmannDielectric = WalkDielectric<R, C, Beckmann>;

} // namespace nacre

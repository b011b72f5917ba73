#pragma once
// A rough metal with all bounces among its facets: nothing of what single scattering loses is lost, and
// colour deepens with roughness as it should. The first bounce is evaluated exactly, the others by random
// walks on Smith's microsurface, from both ends, combined by multiple importance sampling. Reciprocal and
// energy conserving in the mean of its estimates.
// Source: Heitz, Hanika, d'Eon, Dachsbacher 2016, Multiple-Scattering Microfacet BSDFs with the Smith Model.

#include "bsdf/microfacet_reflection.h"
#include "core/random_stream.h"
#include "optics/fresnel.h"
#include "optics/smith_walk.h"

namespace nacre {

template <class R, int C, template <class> class Distribution>
struct WalkConductor : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color eta, k;
  R alpha_x, alpha_y, walks;

  static constexpr bool is_ggx = std::is_same_v<Distribution<R>, Ggx<R>>;
  static constexpr std::string_view name = is_ggx ? "walk_ggx_conductor" : "walk_beckmann_conductor";
  static constexpr std::string_view source = "Heitz et al. 2016";
  static constexpr std::string_view summary = is_ggx ? "rough metal, all bounces by random walk, GGX facets"
                                                     : "rough metal, all bounces by random walk, Beckmann";
  static constexpr Laws laws{.stochastic = true};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&WalkConductor::eta, "eta", "1", 0.01, 20, 1.0, "real part of the complex index"},
        Parameter{&WalkConductor::k, "k", "1", 0, 30, 6.0, "imaginary part of the index, absorption"},
        Parameter{&WalkConductor::alpha_x, "alpha_x", "1", 1e-3, 1, 0.5, "roughness along the tangent"},
        Parameter{&WalkConductor::alpha_y, "alpha_y", "1", 1e-3, 1, 0.5, "roughness along the bitangent"},
        Parameter{&WalkConductor::walks, "walks", "1", 1, 256, 4, "pairs of walks averaged by an evaluation",
                  false}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto valid = same_upper_side(wo, wi);
    const Vec3<R> up{R(0), R(0), R(1)};
    const Vec3<R> o = select(valid, wo, up), i = select(valid, wi, up);
    RandomStream<R> random(wo, wi);
    const R n = R(floor(value(walks) + value_t<R>(0.5f)));
    Color more;
    for (int w = 0; w < 256 && any(R(float(w)) < n); ++w)
      more += select(R(float(w)) < n, walk(o, i, valid, random) + walk(i, o, valid, random), Color());
    return first_bounce(wo, wi) + select(valid, more / n, Color());
  }

  /// Near to the density that the walk samples: a first bounce, and diffuse light for what comes later, about
  /// 0.6 alpha of all.
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const R later = constant<R>(0.6) * sqrt(alpha_x * alpha_y);
    const R diffuse = select(same_upper_side(wo, wi), wi.z * constant<R>(inv_pi), R(0));
    return (R(1) - later) * facet_reflection_pdf(distribution(), wo, wi) + later * diffuse;
  }

  /// The walk from wo until it leaves.
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const Distribution<R> d = distribution();
    RandomStream<R> random(u_lobe, u);
    const auto valid = wo.z > R(0);
    const Vec3<R> start = select(valid, wo, Vec3<R>{R(0), R(0), R(1)});
    Vec3<R> r = -start;
    R depth = next_facet(d, r, R(0), u_lobe);
    Color weight(R(1));
    auto inside = valid;
    for (int bounce = 0; bounce < smith_walk_bounces && any(inside); ++bounce) {
      const Vec3<R> wm = d.sample_visible(-r, bounce == 0 ? u : random.next_2d());
      weight = select(inside, weight * fresnel(-dot(r, wm)), weight);
      const Vec3<R> next = normalize(reflect(-r, wm));
      const R next_depth = next_facet(d, next, depth, random.next());
      r = select(inside, next, r);
      depth = select(inside, next_depth, depth);
      inside = inside & (depth > R(0));
    }
    const auto left = valid & !inside & (r.z > R(0));
    const Vec3<R> wi = select(left, r, Vec3<R>{R(0), R(0), R(1)});
    const R density = pdf(start, wi);
    return {wi, select(left, weight * (density / max(wi.z, R(1e-9f))), Color()), select(left, density, R(0)),
            mask_t<R>(false)};
  }

  /// Single scattering: what rough_conductor knows.
  Color first_bounce(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto facets = reflect_from_facets(distribution(), wo, wi, R(0));
    return fresnel(facets.cos_m) * facets.value;
  }

  /// The microsurface, for the validator and plots.
  Distribution<R> distribution() const { return {alpha_x, alpha_y}; }

private:
  Color fresnel(const R& cos_m) const {
    return zip(eta, k, [&](const R& n, const R& kappa) { return R(fresnel_conductor(cos_m, n, kappa)); });
  }

  /// One walk from `from`; at its second and every later facet the light that goes on to `to`, as a BRDF
  /// value, weighted against the walk from the other end by the balance heuristic over the facets at the two
  /// ends, which are all that the two walks choose differently.
  Color walk(const Vec3<R>& from, const Vec3<R>& to, const mask_t<R>& valid, RandomStream<R>& random) const {
    const Distribution<R> d = distribution();
    const R path_out = free_path(d, to), inv_cos_out = R(1) / max(to.z, R(1e-9f));
    Vec3<R> wm = d.sample_visible(from, random.next_2d());
    const R first = seen_density(d, from, wm);
    Vec3<R> r = normalize(reflect(from, wm));
    Color weight = fresnel(dot(from, wm)), sum;
    // A second facet is always found and weighted, the others by chance.
    R second = R(1);
    R depth = next_facet_surely(d, r, next_facet(d, -from, R(0), random.next()), random.next(), second);
    weight *= second;
    auto inside = valid;
    for (int bounce = 2; bounce <= smith_walk_bounces; ++bounce) {
      const Vec3<R> h = to - r;
      const R length2 = length_squared(h);
      const auto facing = inside & (h.z > R(0)) & (length2 > R(1e-12f));
      const Vec3<R> wh = select(facing, h, Vec3<R>{R(0), R(0), R(1)}) / sqrt(select(facing, length2, R(1)));
      const R a = first, b = seen_density(d, to, wh), total = a + b;
      const R share = a / select(total > R(1e-20f), total, R(1));
      const R value =
          R(0.25f) * seen_density(d, -r, wh) * escape_probability(depth, path_out) * share * inv_cos_out;
      sum += select(facing, weight * fresnel(dot(to, wh)) * value, Color());

      wm = d.sample_visible(-r, random.next_2d());
      weight = weight * fresnel(-dot(r, wm));
      const Vec3<R> next = normalize(reflect(-r, wm));
      const R next_depth = next_facet(d, next, depth, random.next());
      inside = inside & (next_depth > R(0));
      if (!any(inside)) break;
      r = select(inside, next, r);
      depth = select(inside, next_depth, depth);
    }
    return sum;
  }
};

template <class R, int C>
using WalkGgxConductor = WalkConductor<R, C, Ggx>;
template <class R, int C>
using WalkBeckmannConductor = WalkConductor<R, C, Beckmann>;

} // namespace nacre

#pragma once
// A surface of Lambertian facets with all bounces among them: chalk, plaster, clay. Flatter and brighter
// towards grazing angles than Lambert, as Oren-Nayar is, and its colour deepens with roughness. Evaluated by
// random walks on Smith's microsurface from both ends. Reciprocal in the mean, white facets lose no light.
// Source: Heitz, Hanika, d'Eon, Dachsbacher 2016, Multiple-Scattering Microfacet BSDFs with the Smith Model;
// single scattering: Heitz and Dupuy 2015, Implementing a Simple Anisotropic Rough Diffuse Material with
// Stochastic Evaluation.

#include "bsdf/model.h"
#include "core/random_stream.h"
#include "core/warp.h"
#include "optics/microfacet.h"
#include "optics/smith_walk.h"

namespace nacre {

template <class R, int C, template <class> class Distribution>
struct WalkDiffuse : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color albedo;
  R alpha_x, alpha_y, walks;

  static constexpr bool is_ggx = std::is_same_v<Distribution<R>, Ggx<R>>;
  static constexpr std::string_view name = is_ggx ? "walk_ggx_diffuse" : "walk_beckmann_diffuse";
  static constexpr std::string_view source = "Heitz et al. 2016; Heitz and Dupuy 2015";
  static constexpr std::string_view summary =
      is_ggx ? "Lambertian facets, all bounces by random walk, GGX facets"
             : "Lambertian facets, all bounces by random walk, Beckmann";
  static constexpr Laws laws{.stochastic = true};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&WalkDiffuse::albedo, "albedo", "1", 0, 1, 0.5, "albedo of a facet"},
        Parameter{&WalkDiffuse::alpha_x, "alpha_x", "1", 1e-3, 1, 0.5, "roughness along the tangent"},
        Parameter{&WalkDiffuse::alpha_y, "alpha_y", "1", 1e-3, 1, 0.5, "roughness along the bitangent"},
        Parameter{&WalkDiffuse::walks, "walks", "1", 1, 256, 4, "pairs of walks averaged by an evaluation",
                  false}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto valid = same_upper_side(wo, wi);
    const Vec3<R> up{R(0), R(0), R(1)};
    const Vec3<R> o = select(valid, wo, up), i = select(valid, wi, up);
    RandomStream<R> random(wo, wi);
    const R n = R(floor(value(walks) + value_t<R>(0.5f)));
    Color f;
    for (int w = 0; w < 256 && any(R(float(w)) < n); ++w)
      f += select(R(float(w)) < n, walk(o, i, valid, random) + walk(i, o, valid, random), Color());
    return select(valid, f * (R(0.5f) / n), Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    return select(same_upper_side(wo, wi), wi.z * constant<R>(inv_pi), R(0));
  }
  /// The walk from wo until it leaves.
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const Distribution<R> d = distribution();
    RandomStream<R> random(u_lobe, u);
    const auto valid = wo.z > R(0);
    Vec3<R> r = -select(valid, wo, Vec3<R>{R(0), R(0), R(1)});
    R depth = next_facet(d, r, R(0), u_lobe);
    Color weight(R(1));
    auto inside = valid;
    for (int bounce = 0; bounce < smith_walk_bounces && any(inside); ++bounce) {
      const Vec3<R> next =
          leaving(d.sample_visible(-r, random.next_2d()), bounce == 0 ? u : random.next_2d());
      weight = select(inside, weight * albedo, weight);
      const R next_depth = next_facet(d, next, depth, random.next());
      r = select(inside, next, r);
      depth = select(inside, next_depth, depth);
      inside = inside & (depth > R(0));
    }
    const auto left = valid & !inside & (r.z > R(0));
    const Vec3<R> wi = select(left, r, Vec3<R>{R(0), R(0), R(1)});
    return {wi, select(left, weight * constant<R>(inv_pi), Color()),
            select(left, wi.z * constant<R>(inv_pi), R(0)), mask_t<R>(false)};
  }

private:
  Distribution<R> distribution() const { return {alpha_x, alpha_y}; }
  static Vec3<R> leaving(const Vec3<R>& wm, const Vec2<R>& u) {
    return normalize(Frame<R>::around(wm).to_world(square_to_cosine_hemisphere(u)));
  }

  /// One walk from `from`; at every facet the light that goes on to `to`, as a BRDF value.
  Color walk(const Vec3<R>& from, const Vec3<R>& to, const mask_t<R>& valid, RandomStream<R>& random) const {
    const Distribution<R> d = distribution();
    const R path_out = free_path(d, to), inv_cos_out = R(1) / max(to.z, R(1e-9f));
    const R first_path = free_path(d, Vec3<R>(-from));
    Vec3<R> wm = d.sample_visible(from, random.next_2d());
    Color weight = albedo;
    // The first facet's depth is integrated over: G2 / G1.
    const R first_seen = path_out / (path_out + first_path);
    Color sum = weight * (max(dot(to, wm), R(0)) * first_seen * inv_cos_out);
    Vec3<R> r = leaving(wm, random.next_2d());
    R second = R(1);
    R depth =
        next_facet_surely(d, r, next_facet(d, Vec3<R>(-from), R(0), random.next()), random.next(), second);
    weight *= second;
    auto inside = valid;
    for (int bounce = 2; bounce <= smith_walk_bounces; ++bounce) {
      wm = d.sample_visible(-r, random.next_2d());
      weight = weight * albedo;
      const R value = max(dot(to, wm), R(0)) * escape_probability(depth, path_out) * inv_cos_out;
      sum += select(inside, weight * value, Color());
      const Vec3<R> next = leaving(wm, random.next_2d());
      const R next_depth = next_facet(d, next, depth, random.next());
      inside = inside & (next_depth > R(0));
      if (!any(inside)) break;
      r = select(inside, next, r);
      depth = select(inside, next_depth, depth);
    }
    return sum * constant<R>(inv_pi);
  }
};

template <class R, int C>
using WalkGgxDiffuse = WalkDiffuse<R, C, Ggx>;
template <class R, int C>
using WalkBeckmannDiffuse = WalkDiffuse<R, C, Beckmann>;

} // namespace nacre

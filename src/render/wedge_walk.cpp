#include "render/wedge_walk.h"

namespace nacre {
namespace {

/// The steepest wedge, normal.z = 0.02, closes 98 % of its face: then some hundred reflections are no rarity.
constexpr int most_reflections = 1000;

/// Ends a walk at random as its weight falls; true if it goes on.
bool survives(SampledSpectrum& weight, RandomStream<float>& random) {
  const float q = std::min(1.0f, max_component(weight));
  if (!(random.next() < q)) return false;
  weight = weight / q;
  return true;
}

} // namespace

SampledSpectrum WedgeWalk::leaving(const Vec3f& o, const Vec3f& wi) const {
  const Vec3f mirrored = wedge_.mirrored(wi);
  const Vec3f at_once = wedge_.frame.to_local(wi), by_mirror = wedge_.frame.to_local(mirrored);
  SampledSpectrum sum;
  if (at_once.z > 0) sum += bsdf_.eval(o, at_once) * (at_once.z * wedge_.visibility(wi));
  const float detour = (1 - wedge_.visibility(mirrored)) * wedge_.from_mirror(wi);
  if (by_mirror.z > 0 && detour > 0) sum += bsdf_.eval(o, by_mirror) * (by_mirror.z * detour);
  return sum;
}

SampledSpectrum WedgeWalk::eval(const Vec3f& wo, const Vec3f& wi) const {
  if (!(wo.z > 0 && wi.z > 0)) return {};
  const float on_face = wedge_.share_of_face(wo);
  const Vec3f face = wedge_.frame.to_local(wo), by_mirror = wedge_.frame.to_local(wedge_.mirrored(wo));
  SampledSpectrum sum;
  if (on_face > 0) sum += leaving(face, wi) * on_face;
  if (on_face < 1) sum += leaving(by_mirror, wi) * (1 - on_face);

  RandomStream<float> random(wo, wi);
  Vec3f o = random.next() < on_face ? face : by_mirror;
  SampledSpectrum weight(1);
  for (int i = 0; i < most_reflections; ++i) {
    const float u_lobe = random.next();
    const auto s = bsdf_.sample(o, u_lobe, random.next_2d());
    if (!(s.pdf > 0 && s.wi.z > 0)) break;
    const Vec3f d = wedge_.frame.to_world(s.wi), mirrored = wedge_.mirrored(d);
    const float stays = (1 - wedge_.visibility(d)) * (1 - wedge_.from_mirror(mirrored));
    weight *= s.f * (s.wi.z / s.pdf * stays);
    if (!survives(weight, random)) break;
    o = wedge_.frame.to_local(-mirrored);
    sum += weight * leaving(o, wi);
  }
  return sum;
}

float WedgeWalk::pdf(const Vec3f& wo, const Vec3f& wi) const {
  if (!(wo.z > 0 && wi.z > 0)) return 0;
  const float on_face = wedge_.share_of_face(wo);
  const Vec3f face = wedge_.frame.to_local(wo), by_mirror = wedge_.frame.to_local(wedge_.mirrored(wo));
  const Vec3f mirrored = wedge_.mirrored(wi);
  const auto leaving_pdf = [&](const Vec3f& o) {
    const Vec3f at_once = wedge_.frame.to_local(wi), detour = wedge_.frame.to_local(mirrored);
    float p = 0;
    if (at_once.z > 0) p += bsdf_.pdf(o, at_once) * wedge_.visibility(wi);
    if (detour.z > 0) p += bsdf_.pdf(o, detour) * (1 - wedge_.visibility(mirrored)) * wedge_.from_mirror(wi);
    return p;
  };
  float p = (1 - wedge_.frame.n.z) * wi.z * float(inv_pi); // of a white diffuse face, what stays inside
  if (on_face > 0) p += on_face * leaving_pdf(face);
  if (on_face < 1) p += (1 - on_face) * leaving_pdf(by_mirror);
  return p;
}

WedgeWalk::Sample WedgeWalk::sample(const Vec3f& wo, float u_lobe, Vec2f u) const {
  Sample result;
  if (!(wo.z > 0)) return result;
  RandomStream<float> random(u_lobe, u);
  Vec3f o = wedge_.frame.to_local(random.next() < wedge_.share_of_face(wo) ? wo : wedge_.mirrored(wo));
  SampledSpectrum weight(1);
  for (int i = 0; i < most_reflections; ++i) {
    const auto s = bsdf_.sample(o, u_lobe, u);
    if (!(s.pdf > 0 && s.wi.z > 0)) return result;
    weight *= s.f * (s.wi.z / s.pdf);
    const Vec3f d = wedge_.frame.to_world(s.wi), mirrored = wedge_.mirrored(d);
    const bool at_once = random.next() < wedge_.visibility(d);
    if (at_once || random.next() < wedge_.from_mirror(mirrored)) {
      const Vec3f wi = at_once ? d : mirrored;
      if (!(wi.z > 0)) return result;
      return {wi, weight, s.is_delta ? 1 : pdf(wo, wi), s.is_delta};
    }
    if (!survives(weight, random)) return result;
    o = wedge_.frame.to_local(-mirrored);
    u_lobe = random.next();
    u = random.next_2d();
  }
  return result;
}

} // namespace nacre

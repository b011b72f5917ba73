#include "render/path.h"

#include "core/error.h"

namespace nacre {
namespace {

/// Connections end this share of their length short of the light, so as not to be blocked by it.
constexpr float shadow_gap = 1e-4f;

/// Weight of a sample drawn with density `mine` where another technique has density `other`: the power
/// heuristic, Veach 1997, eq. 9.14.
float power_heuristic(float mine, float other) {
  if (!(mine > 0)) return 0;
  const float ratio = other / mine; // the squares of small or large densities leave the range of float
  return 1 / (1 + ratio * ratio);
}

bool is_black(const SampledSpectrum& s) { return !(max_component(s) > 0); }

} // namespace

PathTracer::PathTracer(const World& world, const IntegratorSettings& settings)
    : world_(world), settings_(settings) {
  if (settings_.name == "direct")
    settings_.max_depth = 2;
  else if (settings_.name != "path") {
    const std::vector<std::string> known{"path", "direct"};
    throw Error("unknown integrator '" + settings_.name + "'" + suggestion(settings_.name, known));
  }
}

template <class Sampler>
PathTracer::Estimate PathTracer::radiance(Ray ray, const Wavelengths& wavelengths, Sampler& sampler) const {
  Estimate estimate;
  SampledSpectrum& L = estimate.radiance;
  SampledSpectrum throughput(1);
  float eta2 = 1;     // radiance is scaled by 1 / eta^2 inside glass, which Russian roulette must not see
  float bsdf_pdf = 0; // of the direction of `ray`; 0 if light could not have been connected to
  Vec3f previous = ray.origin;

  for (int depth = 1;; ++depth) { // edges of the path, the one to this hit included
    const bool seen_directly = depth == 1;
    const bool shows_emission = !(seen_directly && settings_.hide_emitters);
    const auto weight = [&](float light_pdf) {
      if (!(bsdf_pdf > 0) || settings_.light_finding == LightFinding::bsdf) return 1.0f;
      return settings_.light_finding == LightFinding::lights ? 0 : power_heuristic(bsdf_pdf, light_pdf);
    };
    Hit hit;
    ++estimate.rays;
    if (!world_.accel.intersect(ray, hit)) {
      if (shows_emission) {
        const SampledSpectrum Le = world_.lights.background(ray.direction, wavelengths);
        if (!is_black(Le))
          L += throughput * Le * weight(bsdf_pdf > 0 ? world_.lights.background_pdf(ray.direction) : 0);
      }
      return estimate;
    }
    const Surface surface = world_.surfaces.at(ray, hit);
    const Vec3f wo = -ray.direction;
    if (shows_emission) {
      const SampledSpectrum Le = world_.lights.emitted(surface, wo, wavelengths);
      if (!is_black(Le))
        L += throughput * Le * weight(bsdf_pdf > 0 ? world_.lights.pdf(previous, surface) : 0);
    }
    if (settings_.max_depth >= 0 && depth >= settings_.max_depth) return estimate;

    if (depth > settings_.russian_roulette_depth) {
      const float survival = std::min(max_component(throughput) * eta2, 0.95f);
      if (!(sampler.next_1d() < survival)) return estimate;
      throughput = throughput / survival;
    }

    const SurfaceBsdf bsdf = world_.materials.resolve(surface, wo, wavelengths);
    const float u_light = sampler.next_1d();
    const Vec2f u_connection = sampler.next_2d();
    if (!world_.lights.empty()) {
      const LightSample light = world_.lights.sample(surface.p, u_light, u_connection, wavelengths);
      if (light.pdf > 0 && !is_black(light.radiance)) {
        const SampledSpectrum f = bsdf.eval(light.direction);
        if (!is_black(f)) {
          Ray shadow = surface.spawn(light.direction);
          if (light.distance < infinity) {
            // The ray starts a little off the point, so it is aimed at the light anew.
            const Vec3f target = surface.p + light.direction * light.distance;
            shadow.direction = target - shadow.origin;
            shadow.t_max = 1 - shadow_gap;
          }
          ++estimate.rays;
          if (!world_.accel.occluded(shadow)) {
            float w = 1;
            if (!light.is_delta && settings_.light_finding == LightFinding::both)
              w = power_heuristic(light.pdf, bsdf.pdf(light.direction));
            if (!light.is_delta && settings_.light_finding == LightFinding::bsdf) w = 0;
            L += throughput * f * light.radiance * (w / light.pdf);
          }
        }
      }
    }

    const float u_lobe = sampler.next_1d();
    const auto next = bsdf.sample(u_lobe, sampler.next_2d());
    if (!(next.pdf > 0)) return estimate;
    throughput *= next.weight;
    if (is_black(throughput)) return estimate;
    eta2 *= next.eta2;
    bsdf_pdf = next.is_delta ? 0 : next.pdf;
    previous = surface.p;
    ray = surface.spawn(next.wi);
  }
}

template PathTracer::Estimate PathTracer::radiance(Ray, const Wavelengths&, SobolSampler&) const;
template PathTracer::Estimate PathTracer::radiance(Ray, const Wavelengths&, IndependentSampler&) const;

} // namespace nacre

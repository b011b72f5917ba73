#pragma once
// Path tracing: Kajiya 1986, The Rendering Equation; next-event estimation and BSDF sampling joined by
// multiple importance sampling with the power heuristic (Veach 1997, section 9.2); four wavelengths a path
// (Wilkie et al. 2014). Unbiased but for the paths it cannot find: light from a point, a spot or a direction
// that reaches the viewer over delta reflections or refractions alone after leaving the light (caustics of
// mirrors and clear glass under such lights). Caustics of area lights are found by chance, with noise.
// Opacity below 1 is a delta bounce, and blocks connections to lights, as in Mitsuba's path integrator.

#include "core/sobol.h"
#include "render/world.h"

namespace nacre {

class PathTracer {
public:
  /// The integrators "path" and "direct", which is "path" with at most 2 edges.
  /// @throws Error if the settings name another
  PathTracer(const World& world, const IntegratorSettings& settings);

  struct Estimate {
    SampledSpectrum radiance;
    std::uint32_t rays = 0; ///< traced for it, shadow rays included
  };
  /// Radiance that arrives along `ray` (of unit direction) against its direction. All chance comes from
  /// `sampler`, a SobolSampler or an IndependentSampler.
  template <class Sampler>
  Estimate radiance(Ray ray, const Wavelengths& wavelengths, Sampler& sampler) const;

private:
  const World& world_;
  IntegratorSettings settings_;
};

extern template PathTracer::Estimate PathTracer::radiance(Ray, const Wavelengths&, SobolSampler&) const;
extern template PathTracer::Estimate PathTracer::radiance(Ray, const Wavelengths&, IndependentSampler&) const;

} // namespace nacre

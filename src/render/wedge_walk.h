#pragma once
// A material under a normal map that keeps all light: what meets the map's face, leaves it, and does not get
// out is sent back by the upright mirror and meets the face again, as often as it takes. After Schuessler et
// al. 2017, Microfacet-Based Normal Mapping for Robust Monte Carlo Path Tracing, ACM TOG 36(6), sections 4
// and 5.

#include "bsdf/combinators.h"
#include "measured/bsdf.h"
#include "spectra/wavelengths.h"

namespace nacre {

/// A view of a wedge and of the reflection on its face, in the frame of the surface. Directions below it give
/// 0.
class WedgeWalk {
public:
  struct Sample {
    Vec3f wi{0, 0, 1};
    SampledSpectrum weight; ///< f |cos| / pdf, of this one walk
    float pdf = 0;          ///< as pdf(); 0: nothing left. Of a delta direction meaningless but positive
    bool is_delta = false;  ///< the last reflection was one
  };

  WedgeWalk(const NormalWedge<float>& wedge, const Bsdf<float, 4>& bsdf) : wedge_(wedge), bsdf_(bsdf) {}

  /// f |cos theta_i|, an unbiased estimate: the first reflection exact, the later ones from one walk, whose
  /// random numbers are drawn from the two directions.
  SampledSpectrum eval(const Vec3f& wo, const Vec3f& wi) const;
  /// 1/sr; near to the density of `sample`: exact for one reflection, a cosine for the light of later ones.
  float pdf(const Vec3f& wo, const Vec3f& wi) const;
  Sample sample(const Vec3f& wo, float u_lobe, Vec2f u) const;

private:
  /// What gets out along wi after a reflection on the face towards o, which is in the frame of the face.
  SampledSpectrum leaving(const Vec3f& o, const Vec3f& wi) const;

  const NormalWedge<float>& wedge_;
  const Bsdf<float, 4>& bsdf_;
};

} // namespace nacre

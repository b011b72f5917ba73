#pragma once
// An image of radiance around the scene: looked up by direction and sampled in proportion to it.

#include "core/distribution.h"
#include "scene/scene.h"

namespace nacre {

/// Latitude-longitude map in Mitsuba 3's conventions: in light space +y is up, -z lies at u = 0 and +x at u =
/// 1/4; texel i is centred at u = (i + 1/2) / width, rows 0 and height - 1 lie at the poles. Bilinear.
class EnvironmentMap {
public:
  /// @throws Error if the image is smaller than 2 x 2, lacks R, G, B, holds a value that is not finite, or
  /// the transform is more than a rotation, a mirror and a uniform scale
  explicit EnvironmentMap(const EnvironmentLight& light);

  /// Radiance that arrives from the unit world direction `d`. Colours are scale x sigmoid x D65, both factors
  /// interpolated on their own as Mitsuba does.
  SampledSpectrum radiance(const Vec3f& d, const Wavelengths& wavelengths) const;
  struct Sample {
    Vec3f direction; ///< world, unit
    float pdf;       ///< 1/sr; 0 at the poles
  };
  Sample sample(Vec2f u) const;
  float pdf(const Vec3f& d) const;
  /// Integral of the luminance over all directions, estimated on the texels.
  double luminance_integral() const { return integral_; }

private:
  struct Texel {
    SigmoidPolynomial polynomial;
    float scale;
  };
  struct Texels {
    int width = 0, height = 0;
    std::vector<Texel> data; ///< width + 1 columns: the first again at the end
    std::vector<float> importance;
    double integral = 0;
  };
  static Texels prepare(const EnvironmentLight& light);
  EnvironmentMap(Texels&& texels, const EnvironmentLight& light);

  /// Position among the texels: u from the centre of texel 0, v from the upper pole, and sin(theta).
  struct Place {
    Vec2f uv;
    float sin_theta;
  };
  Place place(const Vec3f& d) const;

  int width_, height_;
  std::vector<Texel> texels_;
  double integral_;
  Distribution2D cells_; ///< importance of the cells between four texel centres
  Frame<float> axes_;    ///< images of the x, y and z axes of light space
};

} // namespace nacre

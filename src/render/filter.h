#pragma once
// Pixel filters by importance sampling: a sample belongs to one pixel and is drawn in proportion to |f|, so
// that pixels share nothing and their variance is known. Ernst et al. 2006, Filter Importance Sampling.

#include "core/distribution.h"
#include "scene/scene.h"

#include <vector>

namespace nacre {

/// A separable filter f(x) f(y), normalised to integral 1.
class PixelFilter {
public:
  /// Radius 0 is the kind's own: box 0.5, tent 1, gaussian 4 stddev, mitchell and catmull_rom 2, lanczos 3.
  /// @throws Error if the radius or the standard deviation is negative or not finite
  PixelFilter(FilterKind kind, float radius, float stddev);
  explicit PixelFilter(const Film& film) : PixelFilter(film.filter, film.filter_radius, film.filter_stddev) {}

  struct Sample {
    Vec2f offset; ///< from the pixel's centre, in pixels
    float weight; ///< f / density: 1 for a filter without negative lobes, up to the tabulation's error
  };
  /// The pixel's value is the mean of weight times radiance.
  Sample sample(Vec2f u) const;
  /// f(x) in one dimension, normalised; 0 outside the radius.
  float eval(float x) const { return float(raw(x) / integral_); }
  float radius() const { return radius_; }

private:
  double raw(double x) const;
  FilterKind kind_;
  float radius_, stddev_;
  double integral_ = 1;
  Distribution1D density_; ///< of |f| over [-radius, radius]
};

} // namespace nacre

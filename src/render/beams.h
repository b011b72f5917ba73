#pragma once
// Lights that shine from one point, differently into different directions.

#include "render/camera.h"
#include "scene/scene.h"

namespace nacre {

/// A spot light, ready to be asked.
class SpotBeam {
public:
  /// @throws Error if the beam is wider than the cutoff, the cutoff is not positive, or a picture is
  /// projected into 90 degrees or more
  explicit SpotBeam(const SpotLight& light);
  const Vec3d& origin() const { return origin_; }
  /// Towards the world point `p`, W/(sr nm); 0 outside the cutoff.
  SampledSpectrum intensity(const Vec3d& p, const Wavelengths& wavelengths) const;
  double power() const; ///< an estimate, in the unit of luminance times m^2 sr

private:
  SpotLight light_;
  Transform to_local_;
  Vec3d origin_;
};

/// A projector, ready to be asked.
class ProjectorBeam {
public:
  /// @throws Error if the lens has no perspective or there is no picture
  explicit ProjectorBeam(const ProjectorLight& light);
  const Vec3d& origin() const { return origin_; }
  /// Towards the world point `p`, W/(sr nm); 0 beside the picture.
  SampledSpectrum intensity(const Vec3d& p, const Wavelengths& wavelengths) const;
  double power() const; ///< as that of a spot; exact but for pictures moved by their own transform

private:
  ProjectorLight light_;
  CameraRays lens_;
  Vec3d origin_, axis_; ///< axis_ of unit length
  double screen_area_;  ///< of the picture at distance 1
};

} // namespace nacre

#pragma once
// All that emits, as one set to sample from.

#include "render/beams.h"
#include "render/environment.h"
#include "render/light_choice.h"
#include "render/surface.h"

#include <variant>
#include <vector>

namespace nacre {

/// Light that arrives at a point by a sampled connection.
struct LightSample {
  Vec3f direction;          ///< unit, towards the light
  float distance = 0;       ///< infinite for light from infinity
  SampledSpectrum radiance; ///< for a delta light the irradiance perpendicular to `direction`
  float pdf = 0;            ///< 1/sr, selection of the light included; of a delta light that selection alone
  bool is_delta = false;    ///< a point or a direction that no other technique can find
};

/// The lights of a scene. One is chosen at each point that is lit, see LightChoice, by estimates of power in
/// luminance.
class LightSet {
public:
  /// Keeps references to both. @param scene_radius  of a sphere about the scene, for the power of light from
  /// infinity  @throws Error if a light's numbers make no sense
  LightSet(const Scene& scene, const SurfaceTable& surfaces, float scene_radius);

  bool empty() const { return lights_.empty(); }
  /// A connection from the point `p`. pdf is 0 where there is none.
  LightSample sample(const Vec3f& p, float u_light, Vec2f u, const Wavelengths& wavelengths) const;

  /// Radiance that `surface` emits into the direction `wo`.
  SampledSpectrum emitted(const Surface& surface, const Vec3f& wo, const Wavelengths& wavelengths) const;
  /// Density, per solid angle at `p`, with which `sample` finds the point `surface`.
  float pdf(const Vec3f& p, const Surface& surface) const;

  /// Radiance from beyond the scene that arrives from direction `d`, and its density in `sample`.
  SampledSpectrum background(const Vec3f& d, const Wavelengths& wavelengths) const;
  float background_pdf(const Vec3f& d) const;

private:
  /// An emitting shape.
  struct Area {
    std::uint32_t shape;
    const Shape* description;
    std::optional<Distribution1D> triangles; ///< of a mesh, by area
  };
  using Kind = std::variant<Area, PointLight, SpotBeam, ProjectorBeam, DirectionalLight, ConstantLight,
                            EnvironmentMap>;

  LightSample connect(const Area& light, const Vec3f& p, Vec2f u, const Wavelengths& w) const;
  LightSample connect(const PointLight& light, const Vec3f& p, Vec2f u, const Wavelengths& w) const;
  LightSample connect(const SpotBeam& light, const Vec3f& p, Vec2f u, const Wavelengths& w) const;
  LightSample connect(const ProjectorBeam& light, const Vec3f& p, Vec2f u, const Wavelengths& w) const;
  LightSample connect(const DirectionalLight& light, const Vec3f& p, Vec2f u, const Wavelengths& w) const;
  LightSample connect(const ConstantLight& light, const Vec3f& p, Vec2f u, const Wavelengths& w) const;
  LightSample connect(const EnvironmentMap& light, const Vec3f& p, Vec2f u, const Wavelengths& w) const;
  static LightSummary summary(const Kind& light, double scene_radius);
  static double power(const Kind& light, double scene_radius);
  static double area(const Area& light);
  /// 1/m^2 with which a point of an area light is drawn when it is drawn by area.
  static float area_density(const Area& light, const Surface& point);
  float solid_angle_density(const Area& light, const Vec3f& p, const Surface& point) const;

  const SurfaceTable& surfaces_;
  std::vector<Kind> lights_;
  LightChoice choice_;
  std::vector<int> light_of_shape_; ///< index into lights_, or -1
  std::vector<int> infinite_;       ///< those that `background` sees
};

} // namespace nacre

#include "render/beams.h"

#include "core/error.h"

#include <fmt/format.h>

namespace nacre {

SpotBeam::SpotBeam(const SpotLight& light)
    : light_(light), to_local_(light.to_world.inverse()), origin_(light.to_world.point({0, 0, 0})) {
  if (!(light.beam_width_rad <= light.cutoff_rad && light.cutoff_rad > 0))
    throw Error(fmt::format("a spot light's beam width {} rad exceeds its cutoff angle {} rad",
                            light.beam_width_rad, light.cutoff_rad));
  if (light.picture != nullptr && !(light.cutoff_rad < 0.5 * pi))
    throw Error(fmt::format("a spot light's picture needs a cutoff angle below pi / 2, found {} rad",
                            light.cutoff_rad));
}

SampledSpectrum SpotBeam::intensity(const Vec3d& p, const Wavelengths& w) const {
  const Vec3d d = to_local_.point(p);
  const double r = length(d);
  if (!(r > 0)) return {};
  const double angle = std::acos(std::clamp(d.z / r, -1.0, 1.0));
  if (angle >= light_.cutoff_rad) return {};
  const double ramp = double(light_.cutoff_rad) - light_.beam_width_rad;
  const double falloff = angle <= light_.beam_width_rad ? 1 : (light_.cutoff_rad - angle) / ramp;
  const SampledSpectrum intensity = light_.intensity.eval(w) * float(falloff);
  if (light_.picture == nullptr) return intensity;
  const double k = 0.5 / (d.z * std::tan(double(light_.cutoff_rad)));
  return intensity * light_.picture->eval({float(0.5 + k * d.x), float(0.5 + k * d.y)}, w);
}

double SpotBeam::power() const {
  const double half_way = 0.5 * (double(light_.cutoff_rad) + light_.beam_width_rad);
  const double picture = light_.picture == nullptr ? 1 : light_.picture->mean_luminance();
  return 2 * pi * (1 - std::cos(half_way)) * light_.intensity.luminance() * picture;
}

namespace {

Film film_of(const ProjectorLight& light) {
  if (light.lens.projection != Camera::Projection::perspective)
    throw Error("a projector needs the lens of a perspective");
  if (light.picture == nullptr) throw Error("a projector needs a picture");
  Film film;
  const auto [width, height] = light.picture->resolution();
  film.width = width, film.height = height;
  return film;
}

} // namespace

ProjectorBeam::ProjectorBeam(const ProjectorLight& light)
    : light_(light), lens_(light.lens, film_of(light)), origin_(light.lens.to_world.point({0, 0, 0})),
      axis_(normalize(light.lens.to_world.vector({0, 0, 1}))) {
  // One over the film position of a point that lies 1 aside of the axis, counted from the middle.
  const Vec3d aside = lens_.project(light.lens.to_world.point({1, 1, 1}));
  screen_area_ = 1 / std::abs((aside.x - 0.5) * (aside.y - 0.5));
}

SampledSpectrum ProjectorBeam::intensity(const Vec3d& p, const Wavelengths& w) const {
  const Vec3d at = lens_.project(p);
  if (!(at.z > 0 && at.x >= 0 && at.x <= 1 && at.y >= 0 && at.y <= 1)) return {};
  // The screen's irradiance at distance 1 is pi times the radiance it shows, and intensity times cos^3.
  const Vec3d d = p - origin_;
  const double cosine = dot(d, axis_) / length(d);
  return light_.picture->eval({float(at.x), float(at.y)}, w) *
         float(pi * light_.scale / (cosine * cosine * cosine));
}

double ProjectorBeam::power() const {
  return pi * screen_area_ * light_.scale * light_.picture->mean_luminance();
}

} // namespace nacre

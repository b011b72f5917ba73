#include "bsdf/model_functions.h"
#include "fit/fit.h"

#include <cmath>

namespace nacre {
namespace {

/// f of the model with its defaults in a channel, along the mirror direction a little off and far from it.
struct Brightness {
  double near = 0, far = 0;
};
Brightness brightness(int model) {
  const MaterialSpec material{{}, {default_lobe(model)}};
  const Bsdf<double, 3> bsdf = make_bsdf<double>(material);
  const double t = pi / 3;
  const Vec3d wo = spherical_direction(t, 0.0);
  return {bsdf.eval(wo, spherical_direction(t + 0.02, pi))[1],
          bsdf.eval(wo, spherical_direction(t, pi / 2))[1]};
}

} // namespace

bool can_be_fitted(const ModelInfo& model) { return !model.laws.stochastic; }

std::vector<std::string> fittable_materials() {
  std::vector<std::string> materials;
  for (std::size_t m = 0; m < model_infos().size(); ++m) {
    const ModelInfo& model = model_infos()[m];
    if (!can_be_fitted(model)) continue;
    const Brightness b = brightness(int(m));
    if (!(b.near > 0)) continue; // a mirror
    // Facets at their defaults keep less than a hundredth of their peak so far away, and less than a grey
    // body reflects.
    const bool diffuse = b.far > 0.03 * b.near || b.far > 0.2 * inv_pi;
    materials.push_back(diffuse ? model.name : model.name + "+lambert");
  }
  return materials;
}

FitOptions ranking_options(const std::string& material, FitOptions options) {
  options.model = material;
  options.every_node = false;
  options.kept_angles = std::min(options.kept_angles, 15);
  return options;
}

} // namespace nacre

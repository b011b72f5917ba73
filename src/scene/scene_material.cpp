#include "scene/scene_material.h"

#include "spectra/rgb.h"

namespace nacre {
namespace {

SpectrumSource linear_reflectance(const std::array<double, 3>& rgb) {
  if (rgb[0] == rgb[1] && rgb[1] == rgb[2]) return SpectrumSource::constant(static_cast<float>(rgb[0]));
  constexpr int first = 360, last = 830, step = 5; // the table behind the basis has this step
  std::vector<float> values;
  for (int nm = first; nm <= last; nm += 4 * step) {
    Wavelengths w;
    for (int i = 0; i < 4; ++i)
      w.lambda_nm[static_cast<std::size_t>(i)] = static_cast<float>(std::min(nm + i * step, last));
    const auto basis = rgb_basis(w);
    for (int i = 0; i < 4 && nm + i * step <= last; ++i)
      values.push_back(clamp(static_cast<float>(rgb[0]) * basis[0][i] +
                                 static_cast<float>(rgb[1]) * basis[1][i] +
                                 static_cast<float>(rgb[2]) * basis[2][i],
                             0.0f, 1.0f));
  }
  return SpectrumSource::regular(first, last, values);
}

ParameterSource source_of(const ParameterInfo& parameter, const std::array<double, 3>& v) {
  const bool is_grey = v[0] == v[1] && v[1] == v[2];
  // A spectrum is never negative: a parameter that may be is one number for all wavelengths.
  if (!parameter.per_channel || (is_grey && parameter.lo < 0)) return static_cast<float>(v[0]);
  if (parameter.hi <= 1) return linear_reflectance(v);
  if (is_grey) return SpectrumSource::constant(static_cast<float>(v[0]));
  return SpectrumSource::rgb_unbounded(static_cast<float>(v[0]), static_cast<float>(v[1]),
                                       static_cast<float>(v[2]));
}

} // namespace

Material scene_material(const MaterialSpec& spec) {
  Material m;
  m.id = spec.name;
  for (const LobeSpec& lobe : spec.lobes) {
    if (lobe.measured) {
      m.lobes.push_back({std::string(measured_lobe), {}, lobe.measured, static_cast<float>(lobe.weight)});
      continue;
    }
    const ModelInfo& model = model_info(lobe);
    Lobe out{model.name, {}, nullptr, static_cast<float>(lobe.weight)};
    for (std::size_t i = 0; i < model.parameters.size(); ++i)
      out.parameters.push_back(source_of(model.parameters[i], lobe.values[i]));
    m.lobes.push_back(std::move(out));
  }
  return m;
}

} // namespace nacre

#include "report/material_images.h"

#include "core/error.h"
#include "core/parallel.h"
#include "core/warp.h"
#include "measured/rusinkiewicz.h"
#include "report/curves.h"
#include "report/material_plots.h"

#include <fmt/format.h>
#include <limits>

namespace nacre {
namespace {

constexpr double radians = pi / 180;

Pack ramp() {
  std::array<float, pack_width> lanes;
  for (std::size_t l = 0; l < pack_width; ++l)
    lanes[l] = float(l);
  return load(lanes.data());
}

/// f(x, y) in packs of pixels along each row, into the image; what lies beyond the row's end is dropped.
template <class F>
void fill(Image& image, F f) {
  const Pack lanes = ramp();
  parallel_for(std::size_t(image.height), [&](std::size_t y) {
    for (int x = 0; x < image.width; x += int(pack_width)) {
      const Spectrum<Pack, 3> color = f(Pack(float(x)) + lanes, float(y));
      std::array<float, pack_width> lane_values;
      for (int c = 0; c < 3; ++c) {
        store(lane_values.data(), color[c]);
        for (std::size_t l = 0; l < pack_width && x + int(l) < image.width; ++l)
          image.at(x + int(l), int(y))[c] = lane_values[l];
      }
    }
  });
}

bool is_measured(const MaterialSpec& material) {
  return std::all_of(material.lobes.begin(), material.lobes.end(),
                     [](const LobeSpec& lobe) { return bool(lobe.measured); });
}

/// NaN in lanes that are 0 and lie in a hole: a hole evaluates to 0, and little else does.
Spectrum<Pack, 3> with_holes(const MaterialSpec& material, Spectrum<Pack, 3> f, const Vec3<Pack>& wo,
                             const Vec3<Pack>& wi, const mask_t<Pack>& above) {
  if (!any(above & (f[0] == Pack(0.0f)) & (f[1] == Pack(0.0f)) & (f[2] == Pack(0.0f)))) return f;
  std::array<std::array<float, pack_width>, 9> lanes;
  for (std::size_t c = 0; c < 3; ++c)
    store(lanes[c].data(), f[int(c)]);
  const Pack parts[] = {wo.x, wo.y, wo.z, wi.x, wi.y, wi.z};
  for (std::size_t k = 0; k < 6; ++k)
    store(lanes[3 + k].data(), parts[k]);
  for (std::size_t l = 0; l < pack_width; ++l) {
    if (lanes[0][l] != 0 || lanes[1][l] != 0 || lanes[2][l] != 0) continue;
    const auto at = [&](std::size_t k) { return double(lanes[k][l]); };
    if (at(5) > 0 && at(8) > 0 && is_hole(material, {at(3), at(4), at(5)}, {at(6), at(7), at(8)}))
      lanes[0][l] = lanes[1][l] = lanes[2][l] = std::numeric_limits<float>::quiet_NaN();
  }
  for (std::size_t c = 0; c < 3; ++c)
    f[int(c)] = load(lanes[c].data());
  return f;
}

/// f(lobe, index) of each number called `parameter`, _x and _y included, of the lobes that have it.
template <class Spec, class F>
void each_parameter(Spec& material, std::string_view parameter, F f) {
  bool found = false;
  for (auto& lobe : material.lobes) {
    if (lobe.is_table()) continue;
    const ModelInfo& model = model_info(lobe);
    for (const char* suffix : {"", "_x", "_y"}) {
      const std::string name = std::string(parameter) + suffix;
      if (!model.has(name)) continue;
      f(lobe, model.parameter_index(name), model);
      if constexpr (!std::is_const_v<Spec>)
        if (lobe.user) lobe = user_lobe(lobe.user, lobe.values, lobe.weight);
      found = true;
    }
  }
  if (found) return;
  std::vector<std::string> names;
  for (const auto& lobe : material.lobes)
    if (!lobe.is_table())
      for (const ParameterInfo& p : model_info(lobe).parameters)
        names.push_back(p.name);
  throw Error(fmt::format("{}: no lobe has a parameter '{}'{}", material.name, parameter,
                          names.empty() ? "" : suggestion(parameter, names)));
}

} // namespace

Image lit_sphere(const MaterialSpec& material, int size, const SphereLight& light) {
  const auto bsdf = make_bsdf<Pack>(material);
  Image image(size, size, {"R", "G", "B"});
  const Vec3<Pack> to_light =
      vec3<Pack>(spherical_direction(light.theta_deg * radians, light.phi_deg * radians));
  const Vec3<Pack> to_viewer{Pack(0.0f), Pack(0.0f), Pack(1.0f)};
  const bool holes = light.holes && is_measured(material);
  const float scale = 2.04f / float(size); // the sphere fills all but a thin margin
  fill(image, [&](const Pack& px, float py) {
    const Pack x = (px + Pack(0.5f - 0.5f * float(size))) * Pack(scale);
    const Pack y((0.5f * float(size) - py - 0.5f) * scale);
    const Pack r2 = x * x + y * y;
    Vec3<Pack> n{x, y, safe_sqrt(Pack(1.0f) - r2)};
    // cos(theta / 2) = sqrt((1 + cos theta) / 2) and sin(theta / 2) / sin theta = 1 / (2 cos(theta / 2)).
    if (light.double_theta) {
      const Pack c = sqrt((Pack(1.0f) + n.z) * Pack(0.5f)), s = Pack(0.5f) / c;
      n = {x * s, y * s, c};
    }
    const auto frame = Frame<Pack>::with_tangent(n, {n.z, Pack(0.0f), -x}); // east
    const Vec3<Pack> wo = frame.to_local(to_viewer), wi = frame.to_local(to_light);
    const auto lit = (r2 < Pack(1.0f)) & (wi.z > Pack(0.0f)) & (wo.z > Pack(0.0f));
    if (!any(lit)) return Spectrum<Pack, 3>();
    const Pack factor = constant<Pack>(pi) * (light.cosine ? wi.z : Pack(1.0f));
    Spectrum<Pack, 3> f = bsdf.eval(wo, wi);
    if (holes) f = with_holes(material, f, wo, wi, lit);
    return select(lit, f * factor, Spectrum<Pack, 3>());
  });
  return image;
}

std::string roughness_parameter(const MaterialSpec& material) {
  for (const LobeSpec& lobe : material.lobes) {
    if (lobe.is_table()) continue;
    const ModelInfo& model = model_info(lobe);
    for (const char* name : {"alpha", "roughness", "m", "sigma", "beta"})
      if (model.has(name) || model.has(std::string(name) + "_x")) return name;
  }
  throw Error(material.name +
              ": no lobe has a roughness (alpha, roughness, m, sigma, beta); --parameter names what "
              "to vary, from --range");
}

std::array<double, 2> parameter_domain(const MaterialSpec& material, std::string_view parameter) {
  std::array<double, 2> domain{-std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::infinity()};
  each_parameter(material, parameter, [&](const LobeSpec&, std::size_t i, const ModelInfo& model) {
    domain[0] = std::max(domain[0], model.parameters[i].lo);
    domain[1] = std::min(domain[1], model.parameters[i].hi);
  });
  return domain;
}

MaterialSpec with_parameter(const MaterialSpec& material, std::string_view parameter, double value) {
  MaterialSpec changed = material;
  each_parameter(changed, parameter, [&](LobeSpec& lobe, std::size_t i, const ModelInfo& model) {
    const ParameterInfo& p = model.parameters[i];
    if (!(value >= p.lo && value <= p.hi))
      throw Error(fmt::format("{}: {} = {:g} lies outside its domain [{:g}, {:g}]", model.name, p.name, value,
                              p.lo, p.hi));
    lobe.values[i].fill(value);
  });
  changed.name = to_text(changed);
  return changed;
}

Image furnace_sphere(const MaterialSpec& material, int size) {
  Image image(size, size, {"R", "G", "B"});
  std::fill(image.data.begin(), image.data.end(), 1.0f);
  constexpr int n = 64; // angles; evenly in the sine, which is the radius in the picture
  std::vector<std::array<double, 3>> albedo(n + 1);
  parallel_for(albedo.size(), [&](std::size_t i) {
    albedo[i] = sampled_albedo(material, std::asin(std::min(double(i) / n, 0.9999)), 2048);
  });
  const double radius = 0.45 * size;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double r = std::hypot(x + 0.5 - 0.5 * size, y + 0.5 - 0.5 * size) / radius;
      if (r >= 1) continue;
      const std::size_t i = std::size_t(r * n);
      const double t = r * n - double(i);
      for (std::size_t c = 0; c < 3; ++c)
        image.at(x, y)[c] = float((1 - t) * albedo[i][c] + t * albedo[i + 1][c]);
    }
  return image;
}

Image white_furnace(const MaterialSpec& material, std::string_view parameter, std::span<const double> values,
                    int size) {
  Image strip(size * int(values.size()), size, {"R", "G", "B"});
  for (std::size_t v = 0; v < values.size(); ++v) {
    const Image sphere = furnace_sphere(with_parameter(material, parameter, values[v]), size);
    for (int y = 0; y < size; ++y)
      std::copy_n(sphere.at(0, y), 3 * size, strip.at(int(v) * size, y));
  }
  return strip;
}

Image image_slice(const MaterialSpec& material, int size, const SliceAxes& axes) {
  const auto bsdf = make_bsdf<Pack>(material);
  const bool holes = axes.holes && is_measured(material);
  Image image(size, size, {"R", "G", "B"});
  fill(image, [&](const Pack& px, float py) {
    const Pack u = (px + Pack(0.5f)) / Pack(float(size));
    const float theta_d = float(pi / 2) * (1 - (py + 0.5f) / float(size));
    const Pack theta_h = constant<Pack>(axes.double_theta ? pi / 4 : pi / 2) * (axes.square_root ? u * u : u);
    const auto pair =
        directions(HalfDifference<Pack>{theta_h, Pack(theta_d), constant<Pack>(axes.phi_d_deg * radians)});
    const Spectrum<Pack, 3> f = bsdf.eval(pair.wo, pair.wi);
    const auto above = (pair.wo.z > Pack(0.0f)) & (pair.wi.z > Pack(0.0f));
    return holes ? with_holes(material, f, pair.wo, pair.wi, above) : f;
  });
  return image;
}

} // namespace nacre

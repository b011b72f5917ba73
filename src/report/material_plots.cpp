#include "report/material_plots.h"

#include "core/cancellation.h"
#include "core/parallel.h"
#include "core/sobol.h"

#include <fmt/format.h>
#include <functional>

namespace nacre {
namespace {

constexpr double radians = pi / 180;

/// One curve a colour channel for a material alone or for a pair of dots and line; else luminance, one colour
/// a material.
bool by_channel(std::span<const PlottedMaterial> materials) {
  return materials.size() == 1 || (materials.size() == 2 && materials[0].dots != materials[1].dots);
}

/// "dots: measured, lines: fit", where colour says something else than the material.
std::string who(std::span<const PlottedMaterial> materials) {
  std::string text;
  for (const PlottedMaterial& m : materials) {
    if (!text.empty()) text += ", ";
    text += materials.size() == 1 ? m.label : fmt::format("{}: {}", m.dots ? "dots" : "lines", m.label);
  }
  return text;
}

using Curve =
    std::function<std::vector<std::array<double, 3>>(const PlottedMaterial&, const std::vector<double>& x)>;

/// Curves of RGB over an angle: three channels of one material (or pair), or the luminance of several.
void add_colour_curves(Plot& plot, std::span<const PlottedMaterial> materials,
                       const std::vector<double>& dot_x, const std::vector<double>& line_x,
                       const Curve& curve) {
  // Vermilion, green and blue of the colour-blind palette stand for red, green and blue.
  constexpr std::array<int, 3> channel_colours{1, 2, 0};
  constexpr std::array<const char*, 3> channels{"red", "green", "blue"};
  const bool channelwise = by_channel(materials);
  int index = 0;
  for (const PlottedMaterial& m : materials) {
    const std::vector<double>& x = m.dots ? dot_x : line_x;
    const auto rgb = curve(m, x);
    for (std::size_t c = 0; c < (channelwise ? 3 : 1); ++c) {
      Series s{channelwise ? channels[c] : m.label, x, {}, m.dots, channelwise ? channel_colours[c] : index};
      if (channelwise && &m != &materials.back()) s.label.clear(); // the last one's lines go into the legend
      for (const auto& v : rgb)
        s.y.push_back(channelwise ? v[c] : luminance(v));
      plot.series.push_back(std::move(s));
    }
    ++index;
  }
  if (channelwise) plot.subtitle = who(materials);
}

/// Index inside / outside of a material that transmits. Radiance is diluted by its square on the way out, and
/// f with it; power is not.
double relative_index(const MaterialSpec& material) {
  for (const LobeSpec& lobe : material.lobes) {
    if (lobe.measured) continue;
    const ModelInfo& model = model_info(lobe);
    for (std::size_t i = 0; i < model.parameters.size(); ++i)
      if (model.laws.transmits && model.parameters[i].name == "eta") return lobe.values[i][0];
  }
  return 1;
}

/// The first Sobol' points of three dimensions; the next are made when asked for.
class SobolPoints {
public:
  SobolPoints() {
    for (std::size_t i = 0; i < kept_.size(); ++i)
      kept_[i] = make(static_cast<int>(i));
  }
  std::array<float, 3> at(int i) const {
    return i < static_cast<int>(kept_.size()) ? kept_[static_cast<std::size_t>(i)] : make(i);
  }

private:
  static std::array<float, 3> make(int i) {
    SobolSampler sampler(0, 0, static_cast<std::uint32_t>(i));
    const float lobe = sampler.next_1d();
    const Vec2f u = sampler.next_2d();
    return {lobe, u.x, u.y};
  }
  std::array<std::array<float, 3>, 4096> kept_;
};

const SobolPoints& sobol_points() {
  static const SobolPoints points;
  return points;
}

} // namespace

void Directions::add(const Vec3d& wo, const Vec3d& wi) {
  wo_x.push_back(static_cast<float>(wo.x)), wo_y.push_back(static_cast<float>(wo.y));
  wo_z.push_back(static_cast<float>(wo.z)), wi_x.push_back(static_cast<float>(wi.x));
  wi_y.push_back(static_cast<float>(wi.y)), wi_z.push_back(static_cast<float>(wi.z));
}

std::vector<std::array<double, 3>> evaluate(const MaterialSpec& material, const Directions& d) {
  const auto bsdf = make_bsdf<Pack>(material);
  std::vector<std::array<double, 3>> f(d.size());
  for (std::size_t begin = 0; begin < d.size(); begin += pack_width) {
    check_cancelled();
    const std::size_t count = std::min(pack_width, d.size() - begin);
    const auto at = [&](const std::vector<float>& v) {
      std::array<float, pack_width> lanes;
      for (std::size_t l = 0; l < pack_width; ++l)
        lanes[l] = v[begin + std::min(l, count - 1)];
      return load(lanes.data());
    };
    const Vec3<Pack> wo{at(d.wo_x), at(d.wo_y), at(d.wo_z)}, wi{at(d.wi_x), at(d.wi_y), at(d.wi_z)};
    const auto value = bsdf.eval(wo, wi);
    for (int c = 0; c < 3; ++c) {
      std::array<float, pack_width> lanes;
      store(lanes.data(), value[c]);
      for (std::size_t l = 0; l < count; ++l)
        f[begin + l][static_cast<std::size_t>(c)] = lanes[l];
    }
  }
  return f;
}

std::array<double, 3> sampled_albedo(const MaterialSpec& material, double theta_rad, int samples,
                                     double phi_rad) {
  const auto bsdf = make_bsdf<Pack>(material);
  const SobolPoints& points = sobol_points();
  const Vec3d w = spherical_direction(theta_rad, phi_rad);
  const Vec3<Pack> wo = vec3<Pack>(w);
  const float compression = static_cast<float>(sqr(relative_index(material)));
  std::array<double, 3> sum{};
  for (int begin = 0; begin < samples; begin += static_cast<int>(pack_width)) {
    check_cancelled();
    std::array<float, pack_width> a, b, c;
    for (std::size_t l = 0; l < pack_width; ++l) {
      const auto p = points.at(begin + static_cast<int>(l));
      a[l] = p[0], b[l] = p[1], c[l] = p[2];
    }
    const auto s = bsdf.sample(wo, load(a.data()), {load(b.data()), load(c.data())});
    const auto chosen = s.pdf > Pack(0);
    const Pack factor = select(chosen, abs(s.wi.z) / select(chosen, s.pdf, Pack(1)), Pack(0)) *
                        select(s.wi.z < Pack(0), Pack(compression), Pack(1));
    for (int channel = 0; channel < 3; ++channel) {
      store(a.data(), select(chosen, s.f[channel] * factor, Pack(0)));
      for (std::size_t l = 0; l < pack_width && begin + static_cast<int>(l) < samples; ++l)
        sum[static_cast<std::size_t>(channel)] += a[l];
    }
  }
  for (double& v : sum)
    v /= samples;
  return sum;
}

double luminance(const std::array<double, 3>& rgb) {
  return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

std::vector<double> steps(double lo, double hi, int n) {
  std::vector<double> x;
  for (int i = 0; i <= n; ++i)
    x.push_back(lo + (hi - lo) * i / n);
  return x;
}

void add_luminance_curves(Plot& plot, std::span<const PlottedMaterial> materials,
                          std::span<const double> angles_deg, std::string_view angle_name,
                          const std::function<CurvePoints(double, bool)>& points) {
  const bool colour_is_angle = by_channel(materials);
  if (colour_is_angle) plot.subtitle = who(materials);
  int colour = 0;
  for (const PlottedMaterial& m : materials) {
    if (colour_is_angle) colour = 0;
    for (const double angle_deg : angles_deg) {
      CurvePoints curve = points(angle_deg, m.dots);
      const std::string angle = fmt::format("{} = {:g}°", angle_name, angle_deg);
      Series s{colour_is_angle ? angle : fmt::format("{}, {}", m.label, angle),
               std::move(curve.x),
               {},
               m.dots,
               colour++};
      if (colour_is_angle && &m != &materials.back())
        s.label.clear(); // the last one's lines go into the legend
      for (const auto& f : evaluate(*m.material, curve.at))
        s.y.push_back(luminance(f));
      plot.series.push_back(std::move(s));
    }
  }
}

Plot incidence_plane_plot(std::span<const PlottedMaterial> materials, std::span<const double> theta_i_deg,
                          bool logarithmic) {
  Plot plot;
  plot.title = "Plane of incidence";
  plot.x = {"θo / degrees, positive on the mirror’s side", Scale::linear, -90, 90, true};
  plot.y = {"f / (1/sr), luminance", logarithmic ? Scale::logarithmic : Scale::linear, std::nullopt,
            std::nullopt, false};
  add_luminance_curves(plot, materials, theta_i_deg, "θi", [](double theta_i, bool dots) {
    // Lines are dense everywhere and denser about the mirror direction, where peaks are narrow.
    CurvePoints curve{dots ? steps(-86, 86, 86) : steps(-89, 89, 712), {}};
    for (const double offset : dots ? steps(-2, 2, 8) : steps(-3, 3, 240))
      if (std::abs(theta_i + offset) <= 89) curve.x.push_back(theta_i + offset);
    std::sort(curve.x.begin(), curve.x.end());
    const Vec3d wi = spherical_direction(theta_i * radians, pi);
    for (const double theta_o : curve.x)
      curve.at.add(spherical_direction(theta_o * radians, 0.0), wi);
    return curve;
  });
  return plot;
}

Plot theta_h_plot(std::span<const PlottedMaterial> materials, double theta_d_deg, bool logarithmic) {
  Plot plot;
  plot.title = fmt::format("Half vector, at θd = {:g}°", theta_d_deg);
  plot.x = {"θh / degrees, spaced as its square root", Scale::square_root, 0, 90, true};
  plot.y = {by_channel(materials) ? "f / (1/sr)" : "f / (1/sr), luminance",
            logarithmic ? Scale::logarithmic : Scale::linear, std::nullopt, std::nullopt, false};
  std::vector<double> dots, line;
  for (int i = 0; i < 90; ++i) // the nodes of a MERL table
    dots.push_back(90 * sqr(i / 90.0));
  for (int i = 0; i < 400; ++i)
    line.push_back(90 * sqr(i / 400.0));
  add_colour_curves(plot, materials, dots, line, [&](const PlottedMaterial& m, const std::vector<double>& x) {
    Directions d;
    for (const double theta_h : x) {
      const auto pair = directions(HalfDifference<double>{theta_h * radians, theta_d_deg * radians, pi / 2});
      d.add(pair.wo, pair.wi);
    }
    return evaluate(*m.material, d);
  });
  return plot;
}

Plot half_vector_plot(std::span<const PlottedMaterial> materials, std::span<const double> theta_i_deg,
                      bool logarithmic) {
  Plot plot;
  plot.title = "Half vector turned towards the light";
  plot.x = {"θh / degrees, spaced as its square root", Scale::square_root, 0, 90, true};
  plot.y = {"f / (1/sr), luminance", logarithmic ? Scale::logarithmic : Scale::linear, std::nullopt,
            std::nullopt, false};
  add_luminance_curves(plot, materials, theta_i_deg, "θi", [](double theta_i, bool dots) {
    CurvePoints curve;
    const Vec3d wi = spherical_direction(theta_i * radians, pi);
    const int n = dots ? 90 : 400; // dots at the nodes of a MERL table
    for (int i = 0; i < n; ++i) {
      const double theta_h = 90 * sqr(double(i) / n), theta_o = theta_i - 2 * theta_h;
      if (theta_o < -88) break;
      curve.x.push_back(theta_h);
      curve.at.add(spherical_direction(theta_o * radians, 0.0), wi);
    }
    return curve;
  });
  return plot;
}

Plot theta_d_plot(std::span<const PlottedMaterial> materials, bool logarithmic) {
  Plot plot;
  plot.title = "Mirror direction, θh = 0";
  plot.x = {"θd = θi = θo / degrees", Scale::linear, 0, 90, true};
  plot.y = {by_channel(materials) ? "f / (1/sr)" : "f / (1/sr), luminance",
            logarithmic ? Scale::logarithmic : Scale::linear, std::nullopt, std::nullopt, false};
  add_colour_curves(plot, materials, steps(0, 88, 44), steps(0, 89, 178),
                    [&](const PlottedMaterial& m, const std::vector<double>& x) {
                      Directions d;
                      for (const double theta : x)
                        d.add(spherical_direction(theta * radians, 0.0),
                              spherical_direction(theta * radians, pi));
                      return evaluate(*m.material, d);
                    });
  return plot;
}

Plot albedo_plot(std::span<const PlottedMaterial> materials) {
  Plot plot;
  plot.title = "Directional albedo";
  plot.x = {"θ / degrees", Scale::linear, 0, 90, true};
  plot.y = {by_channel(materials) ? "albedo" : "albedo, luminance", Scale::linear, 0, std::nullopt, false};
  add_colour_curves(plot, materials, steps(0, 88, 22), steps(0, 89, 89),
                    [&](const PlottedMaterial& m, const std::vector<double>& x) {
                      std::vector<std::array<double, 3>> albedo(x.size());
                      parallel_for(x.size(), [&](std::size_t i) {
                        albedo[i] = sampled_albedo(*m.material, x[i] * radians);
                      });
                      return albedo;
                    });
  plot.y.hi = 1.05; // where white would be is always seen
  for (const Series& s : plot.series)
    for (const double v : s.y)
      plot.y.hi = std::max(*plot.y.hi, 1.05 * v);
  return plot;
}

} // namespace nacre

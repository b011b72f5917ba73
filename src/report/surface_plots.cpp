#include "report/surface_plots.h"

#include "core/error.h"
#include "core/parallel.h"
#include "core/warp.h"
#include "optics/fresnel_amplitudes.h"
#include "report/material_images.h"
#include "spectra/ior.h"

#include <fmt/format.h>

namespace nacre {
namespace {

constexpr double radians = pi / 180;

std::vector<double> steps(double lo, double hi, int n) {
  std::vector<double> x;
  for (int i = 0; i <= n; ++i)
    x.push_back(lo + (hi - lo) * i / n);
  return x;
}

/// One curve f(facets, values, angle) for each lobe made of facets.
template <class F>
void add_facet_curves(Plot& plot, std::span<const PlottedMaterial> materials, F f) {
  int colour = 0;
  for (const PlottedMaterial& m : materials) {
    bool found = false;
    for (const LobeSpec& lobe : m.material->lobes) {
      if (lobe.table) continue;
      const FacetFunctions& facets = model_facets(lobe.model);
      if (!facets.D) continue;
      found = true;
      const std::vector<double> values = parameter_vector(lobe);
      Series s{m.label, steps(0, 89.5, 358), {}, false, colour++};
      for (const double theta : s.x)
        s.y.push_back(f(facets, values.data(), theta * radians));
      plot.series.push_back(std::move(s));
    }
    if (!found) throw Error(m.material->name + ": no lobe is made of facets that it could show");
  }
}

/// What a substance reflects at a wavelength: unpolarised, perpendicular, parallel.
struct Substance {
  const ConductorIor* metal;
  const DielectricIor* glass;

  explicit Substance(const std::string& name)
      : metal(find_metal(name)), glass(metal ? nullptr : find_glass(name)) {
    if (metal || glass) return;
    std::vector<std::string> names = metal_names();
    names.insert(names.end(), glass_names().begin(), glass_names().end());
    throw Error(fmt::format("no metal or glass '{}'{}", name, suggestion(name, names)));
  }
  std::array<double, 3> reflectance(double cos_i, double lambda) const {
    const double eta = metal ? metal->eta.eval(float(lambda)) : glass->eval(lambda);
    const double k = metal ? metal->k.eval(float(lambda)) : 0;
    const auto r = fresnel_amplitudes(cos_i, eta, k).reflectance();
    return {r.unpolarized(), r.s, r.p};
  }
};

} // namespace

Plot facet_normal_plot(std::span<const PlottedMaterial> materials, bool logarithmic) {
  Plot plot;
  plot.title = "Distribution of normals";
  plot.x = {"θm / degrees", Scale::linear, 0, 90, true};
  plot.y = {"D / (1/sr)", logarithmic ? Scale::logarithmic : Scale::linear, std::nullopt, std::nullopt,
            false};
  add_facet_curves(plot, materials, [](const FacetFunctions& facets, const double* values, double theta) {
    return facets.D(values, spherical_direction(theta, 0.0));
  });
  return plot;
}

Plot masking_plot(std::span<const PlottedMaterial> materials) {
  Plot plot;
  plot.title = "Masking: share of the facets seen";
  plot.x = {"θ / degrees", Scale::linear, 0, 90, true};
  plot.y = {"G1, for the facet in the direction’s plane at half its angle", Scale::linear, 0, 1.02, false};
  add_facet_curves(plot, materials, [](const FacetFunctions& facets, const double* values, double theta) {
    return facets.G1(values, spherical_direction(theta, 0.0), spherical_direction(0.5 * theta, 0.0));
  });
  return plot;
}

Plot fresnel_plot(std::span<const std::string> substances, double wavelength_nm) {
  Plot plot;
  plot.title = "Fresnel reflectance";
  plot.subtitle = fmt::format("at {:g} nm", wavelength_nm);
  plot.x = {"θi / degrees", Scale::linear, 0, 90, true};
  plot.y = {"reflectance", Scale::linear, 0, 1.02, false};
  int colour = 0;
  for (const std::string& name : substances) {
    const Substance substance(name);
    for (std::size_t part = 0; part < (substances.size() == 1 ? 3 : 1); ++part) {
      constexpr std::array<const char*, 3> parts{"", ", perpendicular", ", parallel"};
      Series s{name + parts[part], steps(0, 90, 360), {}, false, colour++};
      for (const double theta : s.x)
        s.y.push_back(substance.reflectance(std::max(std::cos(theta * radians), 0.0), wavelength_nm)[part]);
      plot.series.push_back(std::move(s));
    }
  }
  return plot;
}

Plot fresnel_wavelength_plot(std::span<const std::string> substances) {
  Plot plot;
  plot.title = "Fresnel reflectance at normal incidence";
  plot.x = {"wavelength / nm", Scale::linear, 380, 780, false};
  plot.y = {"reflectance", Scale::linear, 0, 1.02, false};
  int colour = 0;
  for (const std::string& name : substances) {
    const Substance substance(name);
    Series s{name, steps(380, 780, 200), {}, false, colour++};
    for (const double lambda : s.x)
      s.y.push_back(substance.reflectance(1, lambda)[0]);
    plot.series.push_back(std::move(s));
  }
  return plot;
}

namespace {

/// Luminance curves over x, one a material and angle.
template <class Pair>
void add_luminance_curves(Plot& plot, std::span<const PlottedMaterial> materials,
                          std::span<const double> angles, std::string_view angle_name,
                          const std::vector<double>& x, Pair pair) {
  int colour = 0;
  for (const PlottedMaterial& m : materials)
    for (const double angle : angles) {
      Directions d;
      for (const double at : x) {
        const auto [wo, wi] = pair(at * radians, angle * radians);
        d.add(wo, wi);
      }
      const std::string label = fmt::format("{} = {:g}°", angle_name, angle);
      Series s{materials.size() == 1 ? label : m.label + ", " + label, x, {}, m.dots, colour++};
      for (const auto& f : evaluate(*m.material, d))
        s.y.push_back(luminance(f));
      plot.series.push_back(std::move(s));
    }
  if (materials.size() == 1) plot.subtitle = materials[0].label;
}

} // namespace

Plot azimuth_plot(std::span<const PlottedMaterial> materials, std::span<const double> theta_deg,
                  bool logarithmic) {
  Plot plot;
  plot.title = "Around the normal";
  plot.x = {"φ between viewer and light / degrees", Scale::linear, -180, 180, true};
  plot.y = {"f / (1/sr), luminance", logarithmic ? Scale::logarithmic : Scale::linear, std::nullopt,
            std::nullopt, false};
  add_luminance_curves(plot, materials, theta_deg, "θ", steps(-180, 180, 720), [](double phi, double theta) {
    return std::pair(spherical_direction(theta, 0.0), spherical_direction(theta, phi));
  });
  return plot;
}

Plot theta_i_plot(std::span<const PlottedMaterial> materials, std::span<const double> theta_o_deg,
                  bool logarithmic) {
  Plot plot;
  plot.title = "Plane of incidence, fixed viewer";
  plot.x = {"θi / degrees, positive on the mirror’s side", Scale::linear, -90, 90, true};
  plot.y = {"f / (1/sr), luminance", logarithmic ? Scale::logarithmic : Scale::linear, std::nullopt,
            std::nullopt, false};
  add_luminance_curves(
      plot, materials, theta_o_deg, "θo", steps(-89.5, 89.5, 1432), [](double theta_i, double theta_o) {
        return std::pair(spherical_direction(theta_o, pi), spherical_direction(theta_i, 0.0));
      });
  return plot;
}

Plot albedo_over_parameter_plot(std::span<const PlottedMaterial> materials, std::string_view parameter,
                                double lo, double hi, std::span<const double> theta_deg) {
  Plot plot;
  plot.title = fmt::format("Directional albedo over {}", parameter);
  plot.x = {std::string(parameter), Scale::linear, lo, hi, false};
  plot.y = {"albedo, luminance", Scale::linear, 0, std::nullopt, false};
  const std::vector<double> x = steps(lo, hi, 40);
  int colour = 0;
  for (const PlottedMaterial& m : materials)
    for (const double theta : theta_deg) {
      const std::string label = fmt::format("θ = {:g}°", theta);
      Series s{materials.size() == 1 ? label : m.label + ", " + label, x, std::vector<double>(x.size()),
               false, colour++};
      parallel_for(x.size(), [&](std::size_t i) {
        s.y[i] = luminance(sampled_albedo(with_parameter(*m.material, parameter, x[i]), theta * radians));
      });
      plot.series.push_back(std::move(s));
    }
  if (materials.size() == 1) plot.subtitle = materials[0].label;
  return plot;
}

std::string polar_svg(std::span<const PlottedMaterial> materials, std::span<const double> theta_i_deg,
                      double compression) {
  constexpr double width = 640, radius = 270, cx = 320, cy = 300;
  struct Lobe {
    std::string label;
    double theta_i;
    std::vector<double> r;
  };
  const std::vector<double> theta_o = steps(-89.9, 89.9, 1798);
  std::vector<Lobe> lobes;
  double longest = 0;
  for (const PlottedMaterial& m : materials)
    for (const double theta_i : theta_i_deg) {
      Directions d;
      for (const double theta : theta_o)
        d.add(spherical_direction(theta * radians, 0.0), spherical_direction(theta_i * radians, pi));
      Lobe lobe{fmt::format("{}{}θi = {:g}°", materials.size() == 1 ? "" : m.label,
                            materials.size() == 1 ? "" : ", ", theta_i),
                theta_i,
                {}};
      const auto f = evaluate(*m.material, d);
      for (std::size_t i = 0; i < f.size(); ++i) {
        lobe.r.push_back(
            std::pow(std::max(luminance(f[i]) * std::cos(theta_o[i] * radians), 0.0), compression));
        longest = std::max(longest, lobe.r.back());
      }
      lobes.push_back(std::move(lobe));
    }
  const double height = cy + 40 + 18 * double(lobes.size());
  std::string svg = fmt::format(
      "<?xml version='1.0' encoding='UTF-8'?>\n<svg xmlns='http://www.w3.org/2000/svg' width='{0}' "
      "height='{1}' viewBox='0 0 {0} {1}' font-family='sans-serif' font-size='12'>\n"
      "<rect width='{0}' height='{1}' fill='#ffffff'/>\n",
      width, height);
  const auto point = [&](double theta_deg, double r) {
    return fmt::format("{:.2f},{:.2f}", cx + r * std::sin(theta_deg * radians),
                       cy - r * std::cos(theta_deg * radians));
  };
  for (int ring = 1; ring <= 4; ++ring)
    svg += fmt::format("<path d='M {} A {:.1f} {:.1f} 0 0 1 {}' fill='none' stroke='#dddddd'/>\n",
                       point(-90, radius * ring / 4), radius * ring / 4, radius * ring / 4,
                       point(90, radius * ring / 4));
  for (int angle = -90; angle <= 90; angle += 15) {
    svg += fmt::format("<path d='M {},{} L {}' stroke='#dddddd'/>\n", cx, cy, point(angle, radius));
    const double x = cx + (radius + 16) * std::sin(angle * radians),
                 y = cy - (radius + 16) * std::cos(angle * radians);
    svg += fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='middle' fill='#444444'>{}°</text>\n", x,
                       y + 4, angle);
  }
  int colour = 0;
  for (const Lobe& lobe : lobes) {
    std::string path = fmt::format("M {},{}", cx, cy);
    for (std::size_t i = 0; i < lobe.r.size(); ++i)
      path += " L " + point(theta_o[i], longest > 0 ? radius * lobe.r[i] / longest : 0);
    const std::string stroke = plot_colour(colour);
    svg += fmt::format("<path d='{} Z' fill='{}' fill-opacity='0.08' stroke='{}' stroke-width='1.8'/>\n",
                       path, stroke, stroke);
    svg += fmt::format("<path d='M {} L {},{}' stroke='{}' stroke-dasharray='5 4'/>\n",
                       point(-lobe.theta_i, radius), cx, cy, stroke);
    const double y = cy + 34 + 18 * colour;
    svg += fmt::format("<rect x='60' y='{:.1f}' width='18' height='4' fill='{}'/><text x='86' y='{:.1f}' "
                       "fill='#222222'>{}</text>\n",
                       y - 6, stroke, y, escape_xml(lobe.label));
    ++colour;
  }
  const std::string root = compression == 1 ? "" : fmt::format(" to the power {:g}", compression);
  svg += fmt::format("<text x='{}' y='{:.1f}' text-anchor='end' fill='#444444'>f cos θo{}; dashed: the "
                     "light</text>\n</svg>\n",
                     width - 20, height - 10, root);
  return svg;
}

} // namespace nacre

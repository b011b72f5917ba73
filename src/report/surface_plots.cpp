#include "report/surface_plots.h"

#include "core/error.h"
#include "core/parallel.h"
#include "core/warp.h"
#include "optics/fresnel_amplitudes.h"
#include "report/material_images.h"
#include "spectra/ior.h"

#include <algorithm>
#include <fmt/format.h>

namespace nacre {
namespace {

constexpr double radians = pi / 180;

/// One curve f(facets, values, angle) for each lobe made of facets.
template <class F>
void add_facet_curves(Plot& plot, std::span<const PlottedMaterial> materials, F f) {
  int colour = 0;
  for (const PlottedMaterial& m : materials) {
    std::vector<const LobeSpec*> rough;
    for (const LobeSpec& lobe : m.material->lobes)
      if (!lobe.measured && model_facets(lobe.model).D) rough.push_back(&lobe);
    if (rough.empty())
      throw Error(m.material->name + ": D and G1 are of facets, and no lobe says that it is made of them; "
                                     "ggx_conductor, beckmann_plastic and others do");
    for (const LobeSpec* lobe : rough) {
      const std::vector<double> values = parameter_vector(*lobe);
      const std::string& model = model_info(*lobe).name;
      const std::string label = rough.size() == 1      ? m.label
                                : materials.size() > 1 ? m.label + ", " + model
                                                       : model;
      Series s{label, steps(0, 89.5, 358), {}, false, colour++};
      for (const double theta : s.x)
        s.y.push_back(f(model_facets(lobe->model), values.data(), theta * radians));
      plot.series.push_back(std::move(s));
    }
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
  plot.subtitle = "for a facet that leans half as far, in the same plane";
  plot.y = {"G1", Scale::linear, 0, 1.02, false};
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
      constexpr std::array<const char*, 3> parts{", unpolarised", ", perpendicular", ", parallel"};
      Series s{substances.size() == 1 ? name + parts[part] : name, steps(0, 90, 360), {}, false, colour++};
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

/// @param pair  wo and wi at an abscissa, degrees
template <class Pair>
CurvePoints curve_over(std::vector<double> x_deg, Pair pair) {
  CurvePoints curve{std::move(x_deg), {}};
  for (const double x : curve.x) {
    const auto [wo, wi] = pair(x * radians);
    curve.at.add(wo, wi);
  }
  return curve;
}

} // namespace

Plot azimuth_plot(std::span<const PlottedMaterial> materials, std::span<const double> theta_deg,
                  bool logarithmic) {
  Plot plot;
  plot.title = "Around the normal";
  plot.x = {"φ between viewer and light / degrees", Scale::linear, -180, 180, true};
  plot.y = {"f / (1/sr), luminance", logarithmic ? Scale::logarithmic : Scale::linear, std::nullopt,
            std::nullopt, false};
  add_luminance_curves(plot, materials, theta_deg, "θ", [](double angle_deg, bool dots) {
    const double theta = angle_deg * radians;
    return curve_over(steps(-180, 180, dots ? 90 : 720), [&](double phi) {
      return std::pair(spherical_direction(theta, 0.0), spherical_direction(theta, phi));
    });
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
  add_luminance_curves(plot, materials, theta_o_deg, "θo", [](double angle_deg, bool dots) {
    const Vec3d wo = spherical_direction(angle_deg * radians, pi);
    return curve_over(dots ? steps(-86, 86, 86) : steps(-89.5, 89.5, 1432),
                      [&](double theta_i) { return std::pair(wo, spherical_direction(theta_i, 0.0)); });
  });
  return plot;
}

Plot albedo_over_parameter_plot(std::span<const PlottedMaterial> materials, std::string_view parameter,
                                double lo, double hi, std::span<const double> theta_deg) {
  Plot plot;
  plot.title = fmt::format("Directional albedo over {}", parameter);
  plot.x = {std::string(parameter), Scale::linear, lo, hi, false};
  plot.y = {"albedo, luminance", Scale::linear, 0, 1.05, false};
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
      plot.y.hi = std::max(*plot.y.hi, 1.05 * *std::max_element(s.y.begin(), s.y.end()));
      plot.series.push_back(std::move(s));
    }
  if (materials.size() == 1) plot.subtitle = materials[0].label;
  return plot;
}

namespace {

/// @param opening  what stands before the size in the first tag
std::string polar_plot(std::span<const PlottedMaterial> materials, std::span<const double> theta_i_deg,
                       double compression, std::string_view opening) {
  const bool alone = materials.size() == 1;
  const bool through = std::any_of(materials.begin(), materials.end(), [](const PlottedMaterial& m) {
    return std::any_of(m.material->lobes.begin(), m.material->lobes.end(), [](const LobeSpec& lobe) {
      return !lobe.measured && model_info(lobe).laws.transmits;
    });
  });
  const double reach = through ? 180 : 90; // of theta_o
  const std::vector<double> theta_o = steps(-reach, reach, through ? 3600 : 1800);
  struct Lobe {
    std::string label;
    std::vector<double> r;
  };
  std::vector<Lobe> lobes;
  double longest = 0;
  for (const PlottedMaterial& m : materials)
    for (const double theta_i : theta_i_deg) {
      Directions d;
      for (const double theta : theta_o)
        d.add(spherical_direction(theta * radians, 0.0), spherical_direction(theta_i * radians, pi));
      Lobe lobe{fmt::format("{}θi = {:g}°", alone ? "" : m.label + ", ", theta_i), {}};
      const auto f = evaluate(*m.material, d);
      for (std::size_t i = 0; i < f.size(); ++i) {
        const double leaving = luminance(f[i]) * std::abs(std::cos(theta_o[i] * radians));
        lobe.r.push_back(std::pow(std::max(leaving, 0.0), compression));
        longest = std::max(longest, lobe.r.back());
      }
      lobes.push_back(std::move(lobe));
    }

  constexpr double width = 600, radius = 250, cx = 300, row = 18;
  const double cy = radius + (alone ? 86 : 68), below = cy + (through ? radius + 36 : 16);
  const double height = below + row * double(lobes.size() + 1) + 8;
  std::string svg =
      fmt::format("{2} width='{0}' height='{1}' viewBox='0 0 {0} {1}' font-family='sans-serif'>\n"
                  "<rect width='{0}' height='{1}' fill='#ffffff'/>\n",
                  width, height, opening);
  const auto text = [&](double x, double y, std::string_view attributes, std::string_view words) {
    svg += fmt::format("<text x='{:.1f}' y='{:.1f}' {}>{}</text>\n", x, y, attributes, escape_xml(words));
  };
  const auto point = [&](double theta_deg, double r) {
    return fmt::format("{:.2f},{:.2f}", cx + r * std::sin(theta_deg * radians),
                       cy - r * std::cos(theta_deg * radians));
  };
  text(20, 24, "font-size='15' font-weight='bold' fill='#222222'", "Lobes in the plane of incidence");
  if (alone) text(20, 42, "font-size='12' fill='#222222'", materials[0].label);
  for (int ring = 1; ring <= 4; ++ring) {
    const double r = radius * ring / 4;
    svg += fmt::format("<path d='M {} A {:.1f} {:.1f} 0 0 1 {}{}' fill='none' stroke='#dddddd'/>\n",
                       point(-90, r), r, r, point(90, r),
                       through ? fmt::format(" A {:.1f} {:.1f} 0 0 1 {}", r, r, point(-90, r)) : "");
  }
  for (int angle = -int(reach) + (through ? 15 : 0); angle <= int(reach); angle += 15) {
    svg += fmt::format("<path d='M {},{} L {}' stroke='{}'/>\n", cx, cy, point(angle, radius),
                       std::abs(angle) == 90 ? "#888888" : "#dddddd");
    const double x = cx + (radius + 18) * std::sin(angle * radians),
                 y = cy - (radius + 18) * std::cos(angle * radians);
    text(x, y + 4, "font-size='12' text-anchor='middle' fill='#444444'",
         fmt::format("{}{}°", angle < 0 ? "−" : "", std::abs(angle)));
  }
  int colour = 0;
  for (const Lobe& lobe : lobes) {
    std::string path = fmt::format("M {},{}", cx, cy);
    // Steps that no eye could see are left out.
    double last_x = 0, last_y = 0;
    for (std::size_t i = 0; i < lobe.r.size(); ++i) {
      const double r = longest > 0 ? radius * lobe.r[i] / longest : 0;
      const double x = r * std::sin(theta_o[i] * radians), y = r * std::cos(theta_o[i] * radians);
      const bool peak =
          i > 0 && i + 1 < lobe.r.size() && lobe.r[i] >= lobe.r[i - 1] && lobe.r[i] > lobe.r[i + 1];
      if (!peak && std::hypot(x - last_x, y - last_y) < 2) continue;
      last_x = x, last_y = y;
      path += " L " + point(theta_o[i], r);
    }
    const std::string stroke = plot_colour(colour);
    svg += fmt::format("<path class='lobe' d='{} Z' fill='{}' fill-opacity='0.08' stroke='{}' "
                       "stroke-width='1.8' stroke-linejoin='round'/>\n",
                       path, stroke, stroke);
    const double y = below + row * (colour + 1);
    svg += fmt::format("<rect x='20' y='{:.1f}' width='18' height='3' fill='{}'/>\n", y - 5.5, stroke);
    text(46, y, "font-size='12' fill='#222222'", lobe.label);
    ++colour;
  }
  for (std::size_t i = 0; i < theta_i_deg.size(); ++i)
    svg += fmt::format("<path d='M {} L {},{}' stroke='{}' stroke-dasharray='5 4'/>\n",
                       point(-theta_i_deg[i], radius), cx, cy, alone ? plot_colour(int(i)) : "#555555");
  const std::string power = compression == 1 ? "" : fmt::format(" to the power {:g}", compression);
  text(20, below + row * double(lobes.size() + 1), "font-size='12' fill='#444444'",
       fmt::format("length: f {}cos θo{}{}, luminance; dashed: where the light comes from",
                   through ? "|" : "", through ? "|" : "", power));
  return svg + "</svg>\n";
}

} // namespace

std::string polar_svg(std::span<const PlottedMaterial> materials, std::span<const double> theta_i_deg,
                      double compression) {
  return polar_plot(materials, theta_i_deg, compression,
                    "<?xml version='1.0' encoding='UTF-8'?>\n<svg xmlns='http://www.w3.org/2000/svg'");
}
std::string polar_element(std::span<const PlottedMaterial> materials, std::span<const double> theta_i_deg,
                          double compression) {
  return polar_plot(materials, theta_i_deg, compression, "<svg class='plot'");
}

} // namespace nacre

#include "report/curves.h"

#include "core/error.h"
#include "core/parallel.h"
#include "measured/rusinkiewicz.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace nacre {
namespace {

constexpr double radians = pi / 180;
constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();

constexpr std::array<std::string_view, 9> kind_names{"theta_h", "theta_d", "theta_i", "theta_o", "phi",
                                                     "polar",   "albedo",  "D",       "G1"};

/// Even in angle, and half of the points within some degrees of the mirror direction, where peaks are narrow.
std::vector<double> about_mirror(double lo, double hi, double mirror, int points) {
  constexpr double reach = 6;
  const double near_lo = std::max(lo, mirror - reach), near_hi = std::min(hi, mirror + reach);
  const int near = near_hi > near_lo && points >= 32 ? points / 3 : 0;
  std::vector<double> x;
  for (int i = 0; i < points - near; ++i)
    x.push_back(lo + (hi - lo) * i / (points - near - 1));
  for (int i = 0; i < near; ++i)
    x.push_back(near_lo + (near_hi - near_lo) * (i + 0.5) / near);
  std::sort(x.begin(), x.end());
  return x;
}

std::vector<double> abscissae(CurveKind kind, const CurveGeometry& g, int points, bool through) {
  std::vector<double> x;
  const auto even = [&](double lo, double hi) {
    for (int i = 0; i < points; ++i)
      x.push_back(lo + (hi - lo) * i / (points - 1));
  };
  switch (kind) {
  case CurveKind::theta_h:
  case CurveKind::D:
    for (int i = 0; i < points; ++i)
      x.push_back(90 * sqr(i / double(points - 1)));
    break;
  case CurveKind::theta_i:
  case CurveKind::theta_o:
    x = about_mirror(0, 90, g.theta_i, points);
    break;
  case CurveKind::phi:
    x = about_mirror(0, 360, 180, points);
    break;
  case CurveKind::polar:
    x = through ? about_mirror(-180, 180, g.theta_i, points) : about_mirror(-90, 90, g.theta_i, points);
    break;
  case CurveKind::theta_d:
  case CurveKind::albedo:
  case CurveKind::G1:
    even(0, 90);
    break;
  }
  return x;
}

/// A direction at exactly 90 degrees lies in the surface, where nothing is defined: just above it.
Vec3d direction(double theta_deg, double phi_deg) {
  const double theta = std::abs(theta_deg) == 90 ? std::copysign(90 - 1e-4, theta_deg) : theta_deg;
  return spherical_direction(theta * radians, phi_deg * radians);
}

struct Pair {
  Vec3d wo, wi;
  double cosine;
};

Pair pair_at(CurveKind kind, const CurveGeometry& g, double x) {
  const double mirror = g.phi_i + 180;
  Vec3d wo, wi;
  switch (kind) {
  case CurveKind::theta_h:
  case CurveKind::theta_d: {
    const bool half = kind == CurveKind::theta_h;
    // At 90 degrees both directions reach the surface.
    const double angle = std::min(x, 90 - 1e-4) * radians;
    const auto pair =
        directions(HalfDifference<double>{half ? angle : 0, half ? g.theta_d * radians : angle, pi / 2});
    return {pair.wo, pair.wi, pair.wi.z};
  }
  case CurveKind::theta_i:
    wi = direction(x, g.phi_i);
    return {direction(g.theta_i, mirror), wi, wi.z};
  case CurveKind::theta_o:
    wo = direction(x, g.phi_i + g.phi_o);
    break;
  case CurveKind::phi:
    wo = direction(g.theta_i, g.phi_i + x);
    break;
  default:
    wo = direction(x, mirror);
    break;
  }
  return {wo, direction(g.theta_i, g.phi_i), std::abs(wo.z)};
}

std::vector<std::array<double, 3>> facet_curve(const MaterialSpec& material, CurveKind kind, double phi_deg,
                                               const std::vector<double>& x) {
  std::vector<std::array<double, 3>> y(x.size());
  for (auto& v : y)
    v.fill(not_measured);
  for (const LobeSpec& lobe : material.lobes) {
    if (lobe.measured || !model_facets(lobe.model).D) continue;
    const FacetFunctions& facets = model_facets(lobe.model);
    const std::vector<double> values = parameter_vector(lobe);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3d w = direction(x[i], phi_deg);
      y[i].fill(kind == CurveKind::D ? facets.D(values.data(), w)
                                     : facets.G1(values.data(), w, direction(x[i] / 2, phi_deg)));
    }
    break; // the first lobe that is made of facets
  }
  return y;
}

/// Sobol' points that choose the directions of an albedo: its error is some 1/samples.
constexpr int albedo_samples = 256;
/// Angles at which it is computed; it is smooth between them.
constexpr int albedo_nodes = 31;

std::vector<std::array<double, 3>> albedo_curve(const MaterialSpec& material, double phi_deg,
                                                const std::vector<double>& x) {
  // Closer towards grazing: theta = 90 (1 - (1 - t)^2), t even.
  std::array<std::array<double, 3>, albedo_nodes + 1> nodes;
  const auto angle = [](double t) { return 90 * (1 - sqr(1 - t)); };
  const bool hole_at_grazing = is_hole(material, direction(89.9, phi_deg), direction(0.01, phi_deg));
  parallel_for(nodes.size(), [&](std::size_t i) {
    nodes[i] = sampled_albedo(material, std::min(angle(double(i) / albedo_nodes), 89.9) * radians,
                              albedo_samples, phi_deg * radians);
  });
  std::vector<std::array<double, 3>> y(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double t = (1 - std::sqrt(std::max(1 - x[i] / 90, 0.0))) * albedo_nodes;
    const auto k = std::min(std::size_t(t), std::size_t(albedo_nodes - 1));
    for (std::size_t c = 0; c < 3; ++c)
      y[i][c] = nodes[k][c] + (nodes[k + 1][c] - nodes[k][c]) * (t - double(k));
  }
  if (hole_at_grazing && x.back() == 90) y.back().fill(not_measured);
  return y;
}

} // namespace

CurveKind parse_curve_kind(std::string_view name) {
  for (std::size_t i = 0; i < kind_names.size(); ++i)
    if (kind_names[i] == name) return CurveKind(i);
  const std::vector<std::string> known(kind_names.begin(), kind_names.end());
  throw Error(fmt::format("unknown kind of curve '{}'{}", name, suggestion(name, known)));
}

bool transmits(const MaterialSpec& material) {
  return std::any_of(material.lobes.begin(), material.lobes.end(), [](const LobeSpec& lobe) {
    return lobe.measured ? lobe.measured->sides().transmits() : model_info(lobe).laws.transmits;
  });
}

bool is_hole(const MaterialSpec& material, const Vec3d& wo, const Vec3d& wi) {
  std::array<float, Channels::max_count> f;
  return std::all_of(material.lobes.begin(), material.lobes.end(), [&](const LobeSpec& lobe) {
    return lobe.measured && !lobe.measured->evaluate(
                                wo, wi, std::span(f.data(), std::size_t(lobe.measured->channels().count())));
  });
}

std::vector<std::array<double, 3>> evaluate_with_holes(const MaterialSpec& material, const Directions& d) {
  auto f = evaluate(material, d);
  const bool measured = std::all_of(material.lobes.begin(), material.lobes.end(),
                                    [](const LobeSpec& lobe) { return bool(lobe.measured); });
  if (!measured) return f;
  // A hole evaluates to 0, and little else does.
  for (std::size_t i = 0; i < f.size(); ++i)
    if (f[i] == std::array<double, 3>{} &&
        is_hole(material, {d.wo_x[i], d.wo_y[i], d.wo_z[i]}, {d.wi_x[i], d.wi_y[i], d.wi_z[i]}))
      f[i].fill(not_measured);
  return f;
}

Curves make_curves(std::span<const MaterialSpec* const> materials, CurveKind kind,
                   const CurveGeometry& geometry, int points) {
  if (points < 2 || points > 100000)
    throw Error(fmt::format("a curve has 2 to 100000 points, not {}", points));
  for (const double angle : {geometry.theta_i, geometry.phi_i, geometry.phi_o, geometry.theta_d})
    if (!std::isfinite(angle)) throw Error("an angle is not a finite number");
  Curves curves;
  const bool through =
      std::any_of(materials.begin(), materials.end(), [](const MaterialSpec* m) { return transmits(*m); });
  curves.x = abscissae(kind, geometry, points, through);
  Directions pairs;
  for (const double x : curves.x) {
    if (kind == CurveKind::albedo || kind == CurveKind::G1) {
      curves.cosine.push_back(1);
    } else if (kind == CurveKind::D) {
      curves.cosine.push_back(std::cos(x * radians));
    } else {
      const Pair pair = pair_at(kind, geometry, x);
      pairs.add(pair.wo, pair.wi);
      curves.cosine.push_back(pair.cosine);
    }
  }
  curves.y.resize(materials.size());
  parallel_for(materials.size(), [&](std::size_t m) {
    const MaterialSpec& material = *materials[m];
    if (kind == CurveKind::albedo)
      curves.y[m] = albedo_curve(material, geometry.phi_i, curves.x);
    else if (kind == CurveKind::D || kind == CurveKind::G1)
      curves.y[m] = facet_curve(material, kind, geometry.phi_i, curves.x);
    else
      curves.y[m] = evaluate_with_holes(material, pairs);
  });
  return curves;
}

} // namespace nacre

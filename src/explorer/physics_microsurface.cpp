// Topics of rough surfaces.
#include "core/random.h"
#include "explorer/physics_topics.h"
#include "optics/masking.h"
#include "report/material_plots.h"

#include <limits>

namespace nacre {
namespace {

constexpr double degrees = 180 / pi;

/// Distribution of normals of the request: what the topics ask of it.
struct Facets {
  double alpha;
  bool beckmann;

  explicit Facets(const Arguments& a) : alpha(a.number("alpha", 0.4, 0.01, 1)) {
    const std::string name = a.text("distribution", "ggx");
    const std::vector<std::string> known{"ggx", "beckmann"};
    if (name != "ggx" && name != "beckmann")
      throw Error(fmt::format("unknown distribution '{}'{}", name, suggestion(name, known)));
    beckmann = name == "beckmann";
  }
  double D(const Vec3d& wm) const {
    return beckmann ? Beckmann<double>{alpha, alpha}.D(wm) : Ggx<double>{alpha, alpha}.D(wm);
  }
  double g1(const Vec3d& w) const {
    return beckmann ? smith_g1(Beckmann<double>{alpha, alpha}, w) : smith_g1(Ggx<double>{alpha, alpha}, w);
  }
  /// Slopes are distributed so along any direction: Gaussian, or Student's t with two degrees of freedom.
  double slope(double u) const {
    if (beckmann) return alpha * erfinv(std::clamp(2 * u - 1, -0.999999, 0.999999));
    const double t = 2 * u - 1;
    return alpha * t / std::sqrt(std::max(1 - t * t, 1e-6));
  }
};

/// Integral over the hemisphere by midpoints.
template <class F>
double hemisphere_integral(F f) {
  constexpr int n_theta = 512, n_phi = 128;
  double sum = 0;
  for (int i = 0; i < n_theta; ++i) {
    // Even in theta: distributions are narrow about the normal. dw = sin theta dtheta dphi.
    const double theta = pi / 2 * (i + 0.5) / n_theta,
                 weight = std::sin(theta) * (pi / 2 / n_theta) * (2 * pi / n_phi);
    for (int k = 0; k < n_phi; ++k)
      sum += weight * f(spherical_direction(theta, 2 * pi * (k + 0.5) / n_phi));
  }
  return sum;
}

constexpr int profile_points = 241;

/// A line across a surface whose slopes are distributed as the facets say, over x in [0, 1]. Source: none is
/// needed for a sketch; slopes keep their sign over some points so that facets are seen.
std::vector<float> profile(const Facets& facets) {
  constexpr int stride = 4; // points a facet
  std::vector<float> x, height{0};
  double slope = 0;
  double h = 0;
  for (int i = 0; i < profile_points; ++i) {
    x.push_back(float(i) / (profile_points - 1));
    if (i % stride == 0) slope = facets.slope(double(uniform(7, 0, std::uint64_t(i), 0)));
    h += slope / (profile_points - 1);
    if (i + 1 < profile_points) height.push_back(float(h));
  }
  // Level: the ends lie at the same height.
  const float drift = height.back();
  for (std::size_t i = 0; i < height.size(); ++i)
    height[i] -= drift * x[i];
  x.insert(x.end(), height.begin(), height.end());
  return x;
}

/// 1 where a point of the profile is seen from theta_o, the viewer on the right.
std::vector<float> visibility_of(const std::vector<float>& xy, double theta_o) {
  const std::size_t n = profile_points;
  std::vector<float> visible(n);
  // Seen from afar: nothing to the right rises above the ray, that is h - x / tan(theta) grows to the right.
  const double rise = theta_o > 1e-6 ? 1 / std::tan(theta_o) : 1e9;
  double highest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = n; i-- > 0;) {
    const double level = double(xy[n + i]) - double(xy[i]) * rise;
    visible[i] = level >= highest - 1e-9;
    highest = std::max(highest, level);
  }
  return visible;
}

double visible_density(const Facets& f, const Vec3d& wo, const Vec3d& wm) {
  return f.g1(wo) * std::max(dot(wo, wm), 0.0) * f.D(wm) / wo.z;
}

double viewer_angle(const Arguments& a) { return std::min(a.angle("theta_o", 45, 0, 90), 89.9) / degrees; }

} // namespace

Answer answer_ndf(const Arguments& a, const Desk&) {
  const Facets facets(a);
  CurveAnswer answer("θm / degrees", "1/sr", {"D", "D cos θm"});
  for (int i = 0; i <= 360; ++i) {
    const Vec3d wm = spherical_direction(std::min(i / 4.0, 89.999) / degrees, 0.0);
    answer.add(i / 4.0, {facets.D(wm), facets.D(wm) * wm.z});
  }
  answer.array("profile", {2, profile_points}, profile(facets));
  answer.value("integral", hemisphere_integral([&](const Vec3d& wm) { return facets.D(wm) * wm.z; }));
  return answer.finish();
}

Answer answer_visible_normals(const Arguments& a, const Desk&) {
  const Facets facets(a);
  const Vec3d wo = spherical_direction(viewer_angle(a), 0.0);
  CurveAnswer answer("θm / degrees, positive to the viewer", "1/sr", {"D cos θm", "D_v"});
  for (int i = -360; i <= 360; ++i) {
    const Vec3d wm = spherical_direction(std::clamp(i / 4.0, -89.999, 89.999) / degrees, 0.0);
    answer.add(i / 4.0, {facets.D(wm) * wm.z, visible_density(facets, wo, wm)});
  }
  const auto line = profile(facets);
  answer.array("visible", {profile_points}, visibility_of(line, viewer_angle(a)));
  answer.array("profile", {2, profile_points}, line);
  answer.value("integral",
               hemisphere_integral([&](const Vec3d& wm) { return visible_density(facets, wo, wm); }));
  return answer.finish();
}

Answer answer_masking(const Arguments& a, const Desk&) {
  const Facets facets(a);
  const double theta_o = viewer_angle(a);
  // V-cavities, for the facets that lie level: Torrance and Sparrow's factor averaged over the visible
  // normals.
  const auto vcavity = [&](double theta) {
    const Vec3d wo = spherical_direction(theta, 0.0);
    double seen = 0;
    constexpr int n_theta = 128, n_phi = 64;
    for (int i = 0; i < n_theta; ++i) {
      const double t = pi / 2 * (i + 0.5) / n_theta;
      for (int k = 0; k < n_phi; ++k) {
        const Vec3d wm = spherical_direction(t, 2 * pi * (k + 0.5) / n_phi);
        const double d = dot(wo, wm);
        if (d <= 0) continue;
        const double g = std::min(1.0, 2 * wm.z * wo.z / d);
        seen += g * facets.D(wm) * wm.z * std::sin(t) * (pi / 2 / n_theta) * (2 * pi / n_phi);
      }
    }
    return seen;
  };
  CurveAnswer answer("θ / degrees", "share of the facets seen", {"Smith G1", "V-cavity G1"});
  for (int i = 0; i <= 90; ++i) {
    const double theta = std::min(double(i), 89.9) / degrees;
    answer.add(i, {facets.g1(spherical_direction(theta, 0.0)), vcavity(theta)});
  }
  const auto line = profile(facets);
  answer.array("visible", {profile_points}, visibility_of(line, theta_o));
  answer.array("profile", {2, profile_points}, line);
  answer.value("g1", facets.g1(spherical_direction(theta_o, 0.0)));
  return answer.finish();
}

Answer answer_projected_area(const Arguments& a, const Desk&) {
  const Facets facets(a);
  const auto facing = [&](double theta) {
    const Vec3d wo = spherical_direction(theta, 0.0);
    return hemisphere_integral([&](const Vec3d& wm) { return std::max(dot(wo, wm), 0.0) * facets.D(wm); });
  };
  CurveAnswer answer("θo / degrees", "area, projected, per area of the surface",
                     {"area seen", "cos θo", "area without G1"});
  for (int i = 0; i <= 45; ++i) {
    const double theta = std::min(2.0 * i, 89.9) / degrees, all = facing(theta);
    answer.add(2.0 * i, {facets.g1(spherical_direction(theta, 0.0)) * all, std::cos(theta), all});
  }
  const double theta = viewer_angle(a), all = facing(theta);
  answer.value("area seen", facets.g1(spherical_direction(theta, 0.0)) * all);
  answer.value("cos θo", std::cos(theta));
  answer.value("area without G1", all);
  return answer.finish();
}

Answer answer_multiple_bounces(const Arguments& a, const Desk&) {
  const double alpha = a.number("alpha", 0.6, 0.01, 1);
  const std::string metal = a.text("metal", "Au");
  const auto named = [&](const char* model) {
    return parse_material(fmt::format("{}:metal={},alpha_x={},alpha_y={}", model, metal, alpha, alpha));
  };
  const MaterialSpec one = named("ggx_conductor"), all = named("walk_ggx_conductor");
  CurveAnswer answer("θo / degrees", "albedo, luminance", {"one bounce", "all bounces"});
  for (int i = 0; i <= 30; ++i) {
    const double theta = std::min(3.0 * i, 89.5);
    answer.add(theta, {luminance(sampled_albedo(one, theta / degrees, 512)),
                       luminance(sampled_albedo(all, theta / degrees, 512))});
  }
  answer.value("lost", luminance(sampled_albedo(all, 0, 4096)) - luminance(sampled_albedo(one, 0, 4096)));
  return answer.finish();
}

} // namespace nacre

#include "scene/sky.h"

#include "core/error.h"
#include "spectra/cie.h"
#include "spectra/illuminants.h"

#include <cmath>

namespace nacre {
namespace {

/// Largest luminous efficacy, lm/W.
constexpr double k_m = 683;
constexpr double cd_per_unit = k_m * cie_y_integral_nm;

/// Perez et al. 1993's distribution over the sky, Preetham's eq. 3.
struct Perez {
  double a, b, c, d, e;

  double operator()(double cos_theta, double gamma) const {
    const double cos_gamma = std::cos(gamma);
    return (1 + a * std::exp(b / std::max(cos_theta, 1e-3))) *
           (1 + c * std::exp(d * gamma) + e * cos_gamma * cos_gamma);
  }
};

/// Polynomial in the sun's angle from the zenith and in turbidity, Preetham's appendix A.2.
double zenith_chromaticity(const double (&m)[3][4], double turbidity, double theta) {
  double value = 0, power = turbidity * turbidity;
  for (const auto& row : m) {
    value += power * (((row[0] * theta + row[1]) * theta + row[2]) * theta + row[3]);
    power /= turbidity;
  }
  return value;
}

class Sky {
public:
  Sky(double t, const Vec3d& sun) : sun_(sun) {
    const double theta = std::acos(clamp(sun.y, 0.0, 1.0));
    luminance_ = {0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771,
                  -0.0670 * t + 0.3703};
    x_ = {-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989,
          -0.0033 * t + 0.0452};
    y_ = {-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537,
          -0.0109 * t + 0.0529};
    static constexpr double zenith_x[3][4] = {{0.00166, -0.00375, 0.00209, 0},
                                              {-0.02903, 0.06377, -0.03202, 0.00394},
                                              {0.11693, -0.21196, 0.06052, 0.25886}};
    static constexpr double zenith_y[3][4] = {{0.00275, -0.00610, 0.00317, 0},
                                              {-0.04214, 0.08970, -0.04153, 0.00516},
                                              {0.15346, -0.26756, 0.06670, 0.26688}};
    const double chi = (4.0 / 9 - t / 120) * (pi - 2 * theta);
    const double zenith_kcd = (4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192;
    zenith_luminance_ = std::max(zenith_kcd, 0.0) * 1000 / cd_per_unit / luminance_(1, theta);
    zenith_x_ = zenith_chromaticity(zenith_x, t, theta) / x_(1, theta);
    zenith_y_ = zenith_chromaticity(zenith_y, t, theta) / y_(1, theta);
  }
  /// Linear sRGB, never negative, in the unit direction `d` above the horizon.
  RGB operator()(const Vec3d& d) const {
    const double gamma = std::acos(clamp(dot(d, sun_), -1.0, 1.0));
    const double luminance = std::max(zenith_luminance_ * luminance_(d.y, gamma), 0.0);
    XYZ xyz = to_xyz(Chromaticity{zenith_x_ * x_(d.y, gamma), zenith_y_ * y_(d.y, gamma)});
    for (double& v : xyz)
      v *= luminance;
    RGB rgb = xyz_to_srgb * xyz;
    for (double& v : rgb)
      v = std::isfinite(v) ? std::max(v, 0.0) : 0;
    return rgb;
  }

private:
  Vec3d sun_;
  Perez luminance_{}, x_{}, y_{};
  double zenith_luminance_ = 0, zenith_x_ = 0, zenith_y_ = 0; ///< already divided by F(0, theta_sun)
};

/// Radius of the sun's disk at one astronomical unit, rad: IAU 2015 resolution B3's solar radius over IAU
/// 2012 resolution B2's unit.
constexpr double sun_radius = 6.957e8 / 1.495978707e11;
constexpr double sun_temperature_k = 5772; ///< effective temperature, IAU 2015 resolution B3

/// Radiance of the sun's disk at the ground, linear sRGB. Preetham, appendix A.1, with its optical mass m.
RGB sun_radiance(double turbidity, double cos_theta) {
  const double theta_deg = std::acos(clamp(cos_theta, 0.0, 1.0)) * 180 / pi;
  const double m = 1 / (cos_theta + 0.15 * std::pow(93.885 - theta_deg, -1.253));
  const double beta = 0.04608 * turbidity - 0.04586; // Angstrom's turbidity coefficient
  RGB rgb = xyz_to_srgb * integrate_xyz([&](float lambda_nm) {
              const double um = lambda_nm * 1e-3;
              const double rayleigh = std::exp(-0.008735 * m * std::pow(um, -4.08));
              const double aerosol = std::exp(-beta * m * std::pow(um, -1.3));
              return blackbody(lambda_nm, sun_temperature_k) * rayleigh * aerosol;
            });
  for (double& v : rgb)
    v = std::max(v, 0.0);
  return rgb;
}

/// A latitude-longitude map under construction. Rows 0 and height - 1 lie at the poles.
struct Map {
  int width, height;
  std::vector<RGB> texels;

  double theta(double row) const { return pi * clamp(row / (height - 1), 0.0, 1.0); }
  double solid_angle(int row) const {
    return 2 * pi / width * (std::cos(theta(row - 0.5)) - std::cos(theta(row + 0.5)));
  }
  /// The inverse of EnvironmentLight's mapping, at texel coordinates: (0, 0) is the centre of the first.
  Vec3d direction(double column, double row) const {
    const double phi = 2 * pi * (column + 0.5) / width, angle = pi * row / (height - 1);
    return {std::sin(angle) * std::sin(phi), std::cos(angle), -std::sin(angle) * std::cos(phi)};
  }
};

/// Adds the sun's disk with anti-aliased edges, scaled so that its irradiance is exact whatever the texels.
void add_sun(Map& map, const Vec3d& sun, const RGB& radiance) {
  const double radius = std::max(sun_radius, 0.75 * pi / (map.height - 1)), cos_radius = std::cos(radius);
  constexpr int grid = 8;
  std::vector<std::pair<std::size_t, double>> covered; // texel, share of it inside the disk
  double covered_solid_angle = 0;
  for (int y = 0; y < map.height; ++y) {
    const double away = std::abs(map.theta(y) - std::acos(clamp(sun.y, -1.0, 1.0)));
    if (away > radius + pi / (map.height - 1)) continue;
    for (int x = 0; x < map.width; ++x) {
      int inside = 0;
      for (int k = 0; k < grid * grid; ++k) {
        const Vec3d d = map.direction(x + (k % grid + 0.5) / grid - 0.5, y + (k / grid + 0.5) / grid - 0.5);
        inside += d.y > 0 && dot(d, sun) > cos_radius;
      }
      if (inside == 0) continue;
      const double share = static_cast<double>(inside) / (grid * grid);
      covered.emplace_back(static_cast<std::size_t>(y) * map.width + x, share);
      covered_solid_angle += share * map.solid_angle(y);
    }
  }
  if (!(covered_solid_angle > 0)) return;
  const double factor = pi * sqr(std::sin(sun_radius)) / covered_solid_angle;
  for (const auto& [texel, share] : covered)
    for (int c = 0; c < 3; ++c)
      map.texels[texel][c] += radiance[c] * factor * share;
}

void check(bool ok, const std::string& message) {
  if (!ok) throw Error("sky: " + message);
}

} // namespace

Image make_sky(const SkyOptions& o) {
  check(o.turbidity >= 2 && o.turbidity <= 10,
        "turbidity must lie in [2, 10], found " + std::to_string(o.turbidity));
  const double l = length(o.sun_direction);
  check(l > 0 && std::isfinite(l), "sun_direction must be a finite vector other than 0");
  const Vec3d sun = o.sun_direction / l;
  check(sun.y >= 0, "the sun must not be below the horizon (y of sun_direction, up, must be at least 0)");
  for (const double albedo : {o.ground_albedo.x, o.ground_albedo.y, o.ground_albedo.z})
    check(albedo >= 0 && albedo <= 1, "ground_albedo must lie in [0, 1]");
  check(o.sky_scale >= 0 && std::isfinite(o.sky_scale), "sky_scale must be finite and at least 0");
  check(o.sun_scale >= 0 && std::isfinite(o.sun_scale), "sun_scale must be finite and at least 0");
  check(o.width >= 4 && o.width <= 16384 && o.height >= 4 && o.height <= 8192 && o.height % 2 == 0,
        "the size must be between 4 x 4 and 16384 x 8192, with an even height");

  Map map{o.width, o.height, std::vector<RGB>(static_cast<std::size_t>(o.width) * o.height, RGB{})};
  const Sky sky(o.turbidity, sun);
  for (int y = 0; y < o.height / 2; ++y)
    for (int x = 0; x < o.width; ++x) {
      RGB& texel = map.texels[static_cast<std::size_t>(y) * o.width + x];
      texel = sky(map.direction(x, y));
      for (double& v : texel)
        v *= o.sky_scale;
    }
  RGB disk = sun_radiance(o.turbidity, sun.y);
  for (double& v : disk)
    v *= o.sun_scale;
  add_sun(map, sun, disk);

  RGB irradiance{}; // on the ground
  for (int y = 0; y < o.height / 2; ++y)
    for (int x = 0; x < o.width; ++x)
      for (int c = 0; c < 3; ++c)
        irradiance[c] += map.texels[static_cast<std::size_t>(y) * o.width + x][c] * map.solid_angle(y) *
                         std::cos(map.theta(y));
  const double albedo[3] = {o.ground_albedo.x, o.ground_albedo.y, o.ground_albedo.z};
  Image image(o.width, o.height, {"R", "G", "B"});
  for (int y = 0; y < o.height; ++y)
    for (int x = 0; x < o.width; ++x)
      for (int c = 0; c < 3; ++c)
        image.at(x, y)[c] =
            static_cast<float>(y < o.height / 2 ? map.texels[static_cast<std::size_t>(y) * o.width + x][c]
                                                : albedo[c] * irradiance[c] * inv_pi);
  return image;
}

} // namespace nacre

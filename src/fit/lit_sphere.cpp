#include "fit/lit_sphere.h"

#include "core/error.h"
#include "core/image.h"
#include "core/parallel.h"
#include "spectra/cielab.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace nacre {
namespace {

/// Directions of even solid angle in a spiral about y. Source: Gonzalez 2010, Measurement of Areas on a
/// Sphere Using Fibonacci and Latitude-Longitude Lattices.
Vec3d spiral(int i, int n) {
  const double y = 1 - (2 * i + 1.0) / n, s = std::sqrt(1 - y * y), phi = pi * (3 - std::sqrt(5.0)) * i;
  return {s * std::sin(phi), y, s * std::cos(phi)};
}

} // namespace

std::vector<DistantLight> studio_lights() {
  std::vector<DistantLight> lights{{normalize(Vec3d{-0.6, 0.7, 0.8}), {2.4, 2.4, 2.4}},
                                   {normalize(Vec3d{0.9, 0.2, 0.4}), {0.8, 0.8, 0.8}},
                                   {normalize(Vec3d{0.3, 0.5, -0.7}), {1.2, 1.2, 1.2}}};
  constexpr int sky = 96;
  for (int i = 0; i < sky; ++i)
    lights.push_back({spiral(i, sky), {4 * pi / sky * 0.2, 4 * pi / sky * 0.2, 4 * pi / sky * 0.2}});
  return lights;
}

std::vector<DistantLight> environment_lights(const std::string& path, int count) {
  const Image map = read_image_linear(path);
  if (map.width < 1 || map.height < 1) throw Error(fmt::format("{}: an empty picture lights nothing", path));
  std::vector<DistantLight> lights;
  for (int i = 0; i < count; ++i)
    lights.push_back({spiral(i, count), {0, 0, 0}});
  for (int row = 0; row < map.height; ++row) {
    const double theta = pi * (row + 0.5) / map.height;
    const double solid_angle =
        2 * pi / map.width * (std::cos(pi * row / map.height) - std::cos(pi * (row + 1) / map.height));
    for (int column = 0; column < map.width; ++column) {
      const double phi = 2 * pi * ((column + 0.5) / map.width - 0.5);
      const Vec3d w{std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi)};
      // The nearest of the spiral lies at about its height: a few turns above or below.
      const int middle = int((1 - w.y) * count / 2), reach = int(3 * std::sqrt(double(count))) + 2;
      int nearest = 0;
      double most = -2;
      for (int i = std::max(0, middle - reach); i < std::min(count, middle + reach + 1); ++i)
        if (const double d = dot(w, lights[std::size_t(i)].direction); d > most) most = d, nearest = i;
      for (int c = 0; c < 3; ++c)
        lights[std::size_t(nearest)].irradiance[std::size_t(c)] +=
            solid_angle * double(map.at(column, row)[std::min(c, map.channel_count() - 1)]);
    }
  }
  return lights;
}

ImageErrors image_errors(const MeasuredBsdf& measured, const MaterialSpec& material,
                         const std::vector<DistantLight>& lights, int size, double max_theta_deg) {
  const double cut = max_theta_deg < 90 ? std::cos(max_theta_deg * pi / 180) : 0;
  const Bsdf<double, 3> bsdf = make_bsdf<double>(material);
  struct Pixel {
    bool seen = false;
    double measured_white = 0; ///< irradiance, of luminance
    RGB is{}, fitted{};
  };
  std::vector<Pixel> pixels(std::size_t(size) * std::size_t(size));
  parallel_for(pixels.size(), [&](std::size_t p) {
    const double x = (double(p % std::size_t(size)) + 0.5) / size * 2 - 1,
                 y = (double(p / std::size_t(size)) + 0.5) / size * 2 - 1;
    const double z2 = 1 - x * x - y * y;
    if (!(z2 > cut * cut)) return;
    const Vec3d normal{x, y, std::sqrt(z2)};
    // The tangent is that of a globe: along the parallels.
    const Vec3d tangent = normalize(Vec3d{normal.z, 0, -normal.x}), bitangent = cross(normal, tangent);
    const auto local = [&](const Vec3d& w) {
      return Vec3d{dot(w, tangent), dot(w, bitangent), dot(w, normal)};
    };
    Pixel& pixel = pixels[p];
    const Vec3d wo = local({0, 0, 1});
    std::vector<float> f(std::size_t(measured.channels().count()));
    for (const DistantLight& light : lights) {
      const Vec3d wi = local(light.direction);
      if (!(wi.z > cut) || !measured.evaluate(wo, wi, f)) continue;
      pixel.seen = true;
      const auto rgb = measured.channels().to_rgb(f);
      const auto model = bsdf.eval(wo, wi);
      for (std::size_t c = 0; c < 3; ++c) {
        pixel.is[c] += std::max(rgb[c], 0.0) * wi.z * light.irradiance[c];
        pixel.fitted[c] += model[int(c)] * wi.z * light.irradiance[c];
        pixel.measured_white += wi.z * light.irradiance[c] / 3;
      }
    }
  });
  ImageErrors errors;
  double white = 0, squares = 0, size2 = 0;
  for (const Pixel& p : pixels)
    white = std::max(white, p.measured_white / pi);
  if (!(white > 0)) throw Error("nothing was measured in the light of the picture");
  for (const Pixel& p : pixels) {
    if (!p.seen) continue;
    ++errors.pixels;
    for (std::size_t c = 0; c < 3; ++c) {
      squares += sqr(p.is[c] - p.fitted[c]);
      size2 += sqr(p.is[c]);
    }
    const auto shown = [&](const RGB& rgb) {
      return srgb_to_lab({rgb[0] / white, rgb[1] / white, rgb[2] / white});
    };
    const Lab a = shown(p.is), b = shown(p.fitted);
    errors.delta_e += std::sqrt(sqr(a[0] - b[0]) + sqr(a[1] - b[1]) + sqr(a[2] - b[2]));
  }
  errors.delta_e /= double(errors.pixels);
  errors.image = size2 > 0 ? std::sqrt(squares / size2) : std::sqrt(squares);
  return errors;
}

} // namespace nacre

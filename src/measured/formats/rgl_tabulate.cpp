// Any measurement in the adaptive parameterisation: the microfacet distribution first, since it decides where
// the other tables are dense.

#include "measured/formats/rgl_bsdf.h"

#include "core/error.h"
#include "core/parallel.h"
#include "spectra/color_space.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace nacre {
namespace {

constexpr std::size_t ndf_width = 128, ndf_height = 65;    ///< polar angles; azimuths of a whole turn
constexpr std::size_t sigma_width = 64, sigma_height = 33; ///< the projected area is smooth
constexpr double constant_share = 0.05;
constexpr int power_iterations = 8; ///< the paper uses 4

double node(std::size_t i, std::size_t n) { return double(i) / double(n - 1); }
double theta_of(double u) { return u * u * pi / 2; }
double phi_of(double v) { return (2 * v - 1) * pi; }

double luminance_of(const Channels& channels, std::span<const float> f) {
  const auto rgb = channels.to_rgb(f);
  return std::max(srgb_luminance({rgb[0], rgb[1], rgb[2]}), 0.0);
}

/// A distribution over the nodes of a (u, v) grid, with the solid angle each stands for. Isotropic ones have
/// two equal rows in the file, and one here whose nodes stand for circles.
class Distribution {
public:
  explicit Distribution(bool isotropic) : isotropic_(isotropic), rows_(isotropic ? 1 : ndf_height - 1) {
    for (std::size_t y = 0; y < rows_; ++y) // the last row is the first again
      for (std::size_t x = 0; x < ndf_width; ++x) {
        const double u = node(x, ndf_width), theta = theta_of(u);
        const double du = (x == 0 || x + 1 == ndf_width ? 0.5 : 1.0) / double(ndf_width - 1);
        w_.push_back(spherical_direction(theta, isotropic ? 0.0 : phi_of(node(y, ndf_height))));
        solid_angle_.push_back(std::sin(theta) * pi * u * du * 2 * pi / double(rows_));
      }
    density_.resize(w_.size());
  }
  std::size_t size() const { return w_.size(); }
  const Vec3d& direction(std::size_t i) const { return w_[i]; }
  double& operator[](std::size_t i) { return density_[i]; }

  /// The area of the microfacets seen from w: integral of D(m) max(0, w.m).
  double projected_area(const Vec3d& w) const {
    double sum = 0;
    const double sin_w = std::sqrt(std::max(1 - w.z * w.z, 0.0));
    for (std::size_t i = 0; i < size(); ++i) {
      double seen;
      if (isotropic_) { // mean over the circle of max(0, a + b cos phi)
        const double a = w.z * w_[i].z, b = sin_w * w_[i].x;
        const double edge = a >= b ? pi : std::acos(-a / b);
        seen = (a * edge + b * std::sin(edge)) / pi;
      } else {
        seen = std::max(dot(w, w_[i]), 0.0);
      }
      sum += density_[i] * solid_angle_[i] * seen;
    }
    return sum;
  }
  /// Scaled so that the area seen along the normal is 1.
  void normalise() {
    const double area = projected_area({0, 0, 1});
    for (double& d : density_)
      d = area > 0 ? d / area : inv_pi;
  }
  BilinearTable table() const {
    BilinearTable t{ndf_width, isotropic_ ? 2 : ndf_height, {}};
    for (std::size_t y = 0; y < t.height; ++y)
      for (std::size_t x = 0; x < ndf_width; ++x)
        t.values.push_back(float(density_[y % rows_ * ndf_width + x]));
    return t;
  }
  BilinearTable sigma_table() const {
    BilinearTable t{sigma_width, isotropic_ ? 2 : sigma_height, {}};
    t.values.resize(t.width * t.height);
    parallel_for(t.height, [&](std::size_t y) {
      for (std::size_t x = 0; x < t.width; ++x)
        t.values[y * t.width + x] = float(projected_area(
            spherical_direction(theta_of(node(x, t.width)), isotropic_ ? 0.0 : phi_of(node(y, t.height)))));
    });
    return t;
  }

private:
  bool isotropic_;
  std::size_t rows_;
  std::vector<Vec3d> w_;
  std::vector<double> solid_angle_, density_;
};

/// f(w, w) cos(theta) in luminance at the nodes; holes as the nearest angle of the same azimuth that has a
/// value, and where there is none as if the surface were diffuse.
std::vector<double> backscattering(const MeasuredBsdf& measured, const Distribution& grid) {
  std::vector<double> r(grid.size(), -1);
  parallel_for(grid.size() / ndf_width, [&](std::size_t row) {
    std::vector<float> f(std::size_t(measured.channels().count()));
    double* line = &r[row * ndf_width];
    for (std::size_t x = 0; x < ndf_width; ++x) {
      const Vec3d& w = grid.direction(row * ndf_width + x);
      if (w.z > 1e-6 && measured.evaluate(w, w, f)) line[x] = luminance_of(measured.channels(), f) * w.z;
    }
    const auto is_known = [](double v) { return v >= 0; };
    const double* first = std::find_if(line, line + ndf_width, is_known);
    double nearest = first != line + ndf_width ? *first : -1;
    for (std::size_t x = 0; x < ndf_width; ++x) {
      if (is_known(line[x])) nearest = line[x];
      line[x] = nearest >= 0 ? nearest : grid.direction(row * ndf_width + x).z;
    }
  });
  return r;
}

/// A microfacet surface scatters f(w, w) cos(theta) = F(0) D(w) / (4 sigma(w)) back, so D is the
/// eigenfunction of D -> f(w, w) cos(theta) sigma(w; D) with the largest eigenvalue (section 4.1).
Distribution distribution_of(const MeasuredBsdf& measured) {
  Distribution d(measured.is_isotropic());
  const std::vector<double> back = backscattering(measured, d);
  for (std::size_t i = 0; i < d.size(); ++i)
    d[i] = inv_pi;
  for (int n = 0; n < power_iterations; ++n) {
    const BilinearTable sigma = d.sigma_table();
    for (std::size_t i = 0; i < d.size(); ++i) {
      const std::size_t y = i / ndf_width;
      d[i] = back[i] * sigma.at({node(i % ndf_width, ndf_width), node(y, ndf_height)});
    }
    d.normalise();
  }
  for (std::size_t i = 0; i < d.size(); ++i)
    d[i] = (1 - constant_share) * d[i] + constant_share * inv_pi;
  return d;
}

} // namespace

RglResolution rgl_resolution(const MeasuredBsdf& measured) {
  const bool few = measured.channels().count() <= 16;
  if (measured.is_isotropic()) return {32, 1, few ? std::size_t(64) : 32};
  return few ? RglResolution{16, 17, 32} : RglResolution{8, 9, 32};
}

RglTables tabulate_rgl(const MeasuredBsdf& measured, const RglResolution& resolution) {
  if (!measured.sides().reflects_front)
    throw Error(
        "the adaptive parameterisation holds reflection on the front, and this measurement has none: " +
        measured.kind());
  const Distribution distribution = distribution_of(measured);
  RglTables t;
  t.description = measured.kind();
  t.wavelengths_nm = measured.channels().wavelengths_nm();
  for (std::size_t i = 0; i < resolution.theta_i; ++i)
    t.theta_i.push_back(float(node(i, std::max<std::size_t>(resolution.theta_i, 2)) * 89.5 * pi / 180));
  for (std::size_t i = 0; i < resolution.phi_i; ++i)
    t.phi_i.push_back(resolution.phi_i > 1 ? float(phi_of(node(i, resolution.phi_i))) : 0.0f);
  t.ndf = distribution.table();
  t.sigma = distribution.sigma_table();
  t.vndf_width = ndf_width, t.vndf_height = ndf_height;
  const std::size_t slices = t.theta_i.size() * t.phi_i.size(), slice = resolution.nodes * resolution.nodes;
  const auto wo_of = [&](std::size_t s) {
    return spherical_direction(double(t.theta_i[s % t.theta_i.size()]),
                               double(t.phi_i[s / t.theta_i.size()]));
  };
  t.vndf.resize(slices * ndf_width * ndf_height);
  parallel_for(slices, [&](std::size_t s) {
    const Vec3d wo = wo_of(s);
    float* out = &t.vndf[s * ndf_width * ndf_height];
    for (std::size_t y = 0; y < ndf_height; ++y)
      for (std::size_t x = 0; x < ndf_width; ++x) {
        const Vec2d u{node(x, ndf_width), node(y, ndf_height)};
        const Vec3d m = spherical_direction(theta_of(u.x), phi_of(u.y));
        *out++ = float(t.ndf.at(u) * std::max(dot(wo, m), 0.0) * u.x * std::sin(theta_of(u.x)));
      }
  });
  t.width = t.height = resolution.nodes;
  t.luminance.assign(slices * slice, 1.0f);
  t.spectra.assign(slices * slice * t.channel_count(), 1.0f);
  const RglBsdf frame(t); // all 1: says where each node lies and what a unit of it is worth

  const Channels& channels = measured.channels();
  parallel_for(slices, [&](std::size_t s) {
    std::vector<float> f(std::size_t(channels.count())), unit(t.channel_count());
    const Vec3d wo = wo_of(s);
    for (std::size_t i = 0; i < slice; ++i) {
      const Vec2d at{node(i % t.width, t.width), node(i / t.width, t.height)};
      const Vec3d wi = frame.direction(wo, at).first;
      const bool known =
          wi.z > 0 && measured.evaluate(wo, wi, f) && frame.evaluate(wo, wi, unit) && unit[0] > 0;
      t.luminance[s * slice + i] = known ? float(luminance_of(channels, f) / double(unit[0])) : 0.0f;
      for (std::size_t c = 0; c < t.channel_count(); ++c)
        t.spectra[(s * t.channel_count() + c) * slice + i] =
            known ? f[channels.count() == 1 ? 0 : c] / unit[c] : 0.0f;
    }
  });
  return t;
}

} // namespace nacre

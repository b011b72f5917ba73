#include "render/filter.h"

#include "core/error.h"

#include <cmath>

namespace nacre {
namespace {

constexpr int cells = 1024;

float default_radius(FilterKind kind, float stddev) {
  switch (kind) {
  case FilterKind::box:
    return 0.5f;
  case FilterKind::tent:
    return 1;
  case FilterKind::gaussian:
    return 4 * stddev;
  case FilterKind::lanczos:
    return 3;
  default:
    return 2;
  }
}

/// Mitchell and Netravali 1988, Reconstruction Filters in Computer Graphics, eq. 8, for |x| < 2.
double cubic(double x, double B, double C) {
  x = std::abs(x);
  if (x < 1) return ((12 - 9 * B - 6 * C) * x * x * x + (-18 + 12 * B + 6 * C) * x * x + 6 - 2 * B) / 6;
  if (x < 2)
    return ((-B - 6 * C) * x * x * x + (6 * B + 30 * C) * x * x + (-12 * B - 48 * C) * x + 8 * B + 24 * C) /
           6;
  return 0;
}
double sinc(double x) { return std::abs(x) < 1e-8 ? 1 : std::sin(pi * x) / (pi * x); }

double evaluate(FilterKind kind, double x, double radius, double stddev) {
  if (!(std::abs(x) <= radius)) return 0;
  switch (kind) {
  case FilterKind::box:
    return 1;
  case FilterKind::tent:
    return 1 - std::abs(x) / radius;
  case FilterKind::gaussian: { // falls to 0 at the radius
    const auto bell = [&](double t) { return std::exp(-t * t / (2 * stddev * stddev)); };
    return std::max(0.0, bell(x) - bell(radius));
  }
  case FilterKind::mitchell:
    return cubic(2 * x / radius, 1.0 / 3, 1.0 / 3);
  case FilterKind::catmull_rom:
    return cubic(2 * x / radius, 0, 0.5);
  case FilterKind::lanczos:
    return sinc(x) * sinc(x / radius);
  }
  return 0;
}

float checked_radius(FilterKind kind, float radius, float stddev) {
  if (!(radius >= 0) || !std::isfinite(radius) || !(stddev > 0) || !std::isfinite(stddev))
    throw Error("a pixel filter needs a finite radius >= 0 and a standard deviation > 0, found radius " +
                std::to_string(radius) + " and standard deviation " + std::to_string(stddev));
  return radius == 0 ? default_radius(kind, stddev) : radius;
}

std::vector<double> magnitudes(FilterKind kind, double radius, double stddev) {
  std::vector<double> v(cells);
  for (int i = 0; i < cells; ++i)
    v[std::size_t(i)] = std::abs(evaluate(kind, ((i + 0.5) / cells * 2 - 1) * radius, radius, stddev));
  return v;
}

} // namespace

PixelFilter::PixelFilter(FilterKind kind, float radius, float stddev)
    : kind_(kind), radius_(checked_radius(kind, radius, stddev)), stddev_(stddev),
      density_(magnitudes(kind, radius_, stddev)) {
  // Midpoints, 16 a cell: exact to 1e-7 for the cubics, whose third derivative jumps at cell borders alone.
  double sum = 0;
  constexpr int n = cells * 16;
  for (int i = 0; i < n; ++i)
    sum += raw(((i + 0.5) / n * 2 - 1) * radius_);
  integral_ = sum / n * 2 * radius_;
}

double PixelFilter::raw(double x) const { return evaluate(kind_, x, radius_, stddev_); }

PixelFilter::Sample PixelFilter::sample(Vec2f u) const {
  if (kind_ == FilterKind::box) return {{(2 * u.x - 1) * radius_, (2 * u.y - 1) * radius_}, 1};
  const auto sx = density_.sample(u.x), sy = density_.sample(u.y);
  const float x = (2 * sx.x - 1) * radius_, y = (2 * sy.x - 1) * radius_;
  const float px = sx.pdf / (2 * radius_), py = sy.pdf / (2 * radius_);
  return {{x, y}, eval(x) * eval(y) / (px * py)};
}

} // namespace nacre

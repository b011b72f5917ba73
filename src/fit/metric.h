#pragma once
// How far a model is from a measurement. All metrics compare y(x) of model and measurement, x = f cos
// theta_i, over what was measured and weigh a node of a table by the part w of the space of direction pairs
// that is nearest to it:
//
//   E = sqrt( sum over nodes and channels of w s^2 (y(x) - y(x_measured))^2 / (3 sum w) )
//
//   cosine     y = x         Ngan et al. 2005, Experimental Analysis of BRDF Models, section 3; also E1 of
//   Loew
//                            et al. 2012, BRDF Models for Accurate and Efficient Rendering of Glossy
//                            Surfaces: radiance leaving under uniform light. Decided by the peak; 1/sr.
//   log        y = log(1+x)  E2 of Loew et al. 2012: compresses the peak, so that the diffuse part and the
//                            tail count too.
//   cube_root  y = x^(1/3)   Fores, Ferwerda and Gu 2012, Toward a Perceptually Based Metric for BRDF
//                            Modeling: lightness as CIELAB has it. The dimmest values count most. The metric
//                            in which the fits of Bagher et al. 2012 are judged here.
//   relative   y = x, s = 1 / (x_measured + 0.001)   share of the measured value; the constant, of Nielsen et
//                            al. 2015, On Optimal, Minimal BRDF Sampling for Reflectance Acquisition, keeps
//                            what is below the noise from counting. s = 1 in the other metrics.
//
// In half and difference angles dwo dwi = 4 cos theta_d dw_h dw_d, hence w = |d cos theta_h| d(sin^2 theta_d)
// dphi_d over the cell whose faces lie midway between nodes. (Ngan weighs by solid angle too; Loew by sin
// theta_i on an even grid of directions: E is of the same kind as the figures of the papers, not comparable
// digit by digit.) Nodes with theta_i or theta_o beyond the cut of 80 degrees (Ngan) and holes take no part.

#include "measured/material_spec.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>

namespace nacre {

enum class Metric { cosine, log, cube_root, relative };
inline constexpr std::array all_metrics{Metric::cosine, Metric::log, Metric::cube_root, Metric::relative};

std::string_view metric_name(Metric metric);
/// @throws Error that suggests the nearest name
Metric parse_metric(std::string_view name);

/// The constant of `relative`, and the x below which the slope of `cube_root` is that at this x: at 0 it
/// would be infinite.
inline constexpr double relative_floor = 1e-3, cube_root_floor = 1e-6;

/// s (y(x) - y(measured)), x = f cos theta_i. R: double or Pack.
template <class R>
inline R metric_error(Metric metric, const R& x, const R& measured) {
  using std::cbrt, std::log1p, std::max;
  switch (metric) {
  case Metric::log:
    return log1p((x - measured) / (R(1) + measured));
  case Metric::cube_root:
    return cbrt(max(x, R(0))) - cbrt(max(measured, R(0)));
  case Metric::relative:
    return (x - measured) / (measured + constant<R>(relative_floor));
  case Metric::cosine:
    break;
  }
  return x - measured;
}
/// Its derivative by x.
template <class R>
inline R metric_slope(Metric metric, const R& x, const R& measured) {
  using std::cbrt, std::max;
  switch (metric) {
  case Metric::log:
    return R(1) / (R(1) + x);
  case Metric::cube_root:
    return R(1) / (R(3) * sqr(cbrt(max(x, constant<R>(cube_root_floor)))));
  case Metric::relative:
    return R(1) / (measured + constant<R>(relative_floor));
  case Metric::cosine:
    break;
  }
  return R(1);
}

struct MetricErrors {
  double cosine = 0, log = 0, cube_root = 0, relative = 0;
  std::size_t nodes = 0; ///< of the table, that were compared
  double of(Metric metric) const { return std::array{cosine, log, cube_root, relative}[std::size_t(metric)]; }
};

struct Observations;

/// E of a material in every metric, over all nodes of the table inside the cut.
/// @param max_theta_deg  the cut, in (0, 90]
/// @throws Error if no node is left to compare
MetricErrors metric_errors(const MeasuredBsdf& measured, const MaterialSpec& material,
                           double max_theta_deg = 80);
/// The same over nodes that are at hand. @throws Error if there are none
MetricErrors metric_errors(const Observations& nodes, const MaterialSpec& material);

} // namespace nacre

#pragma once
// How far a model is from a measurement. Both metrics compare y(f cos theta_i) of model and measurement over
// the nodes of a table and weigh a node by the part w of the space of direction pairs that is nearest to it:
//
//   E = sqrt( sum over nodes and channels of w (y(f cos theta_i) - y(f_measured cos theta_i))^2 / (3 sum w) )
//
//   cosine  y(x) = x           Ngan et al. 2005, Experimental Analysis of BRDF Models: radiance
//                              leaving under uniform light. Decided by the peak; 1/sr.
//   log     y(x) = log(1 + x)  Loew et al. 2012, BRDF Models for Accurate and Efficient Rendering of Glossy
//                              Surfaces, the fits called E2: compresses the peak, so that the diffuse part
//                              and the tail count too.
//
// In half and difference angles dwo dwi = 4 cos theta_d dw_h dw_d, hence w = |d cos theta_h| d(sin^2 theta_d)
// dphi_d over the cell whose faces lie midway between nodes. (Ngan weighs by solid angle too; Loew by sin
// theta_i on an even grid of directions: E is of the same kind as the figures of both papers, not comparable
// digit by digit.) Nodes with theta_i or theta_o beyond the cut of 80 degrees (Ngan) and holes take no part.

#include "measured/material_spec.h"

#include <cmath>
#include <cstddef>
#include <string_view>

namespace nacre {

enum class Metric { cosine, log };

std::string_view metric_name(Metric metric);
/// @throws Error that suggests the nearest name
Metric parse_metric(std::string_view name);

/// y(x) of the metric, x = f cos theta_i >= 0.
inline double compress(Metric metric, double x) { return metric == Metric::log ? std::log1p(x) : x; }
/// dy/dx.
inline double compress_slope(Metric metric, double x) { return metric == Metric::log ? 1 / (1 + x) : 1; }

struct MetricErrors {
  double cosine = 0, log = 0;
  std::size_t nodes = 0; ///< of the table, that were compared
  double of(Metric metric) const { return metric == Metric::log ? log : cosine; }
};

/// E of a material in every metric, over all nodes of the table inside the cut.
/// @param max_theta_deg  the cut, in (0, 90]
/// @throws Error if no node is left to compare
MetricErrors metric_errors(const MeasuredBsdf& measured, const MaterialSpec& material,
                           double max_theta_deg = 80);

} // namespace nacre

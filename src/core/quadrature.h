#pragma once
// Numerical integration: fixed rules for smooth functions on known domains, adaptive ones where the shape is
// not known.

#include "core/vec.h"

#include <functional>
#include <vector>

namespace nacre {

/// Nodes and weights: the integral of f is about the sum of weight[i] * f(node[i]).
struct QuadratureRule {
  std::vector<double> node, weight;
};

/// Gauss-Legendre rule on [a, b], exact for polynomials of degree 2n - 1; nodes ascend.
/// @throws Error unless n is in [1, 10000]
/// Source: Abramowitz and Stegun 1964, 25.4.29-30; roots by Newton's method from Tricomi's estimate
/// (22.16.6).
QuadratureRule gauss_legendre(int n, double a = -1, double b = 1);
/// The same rule repeated on `panels` equal parts of [a, b].
QuadratureRule composite_gauss_legendre(int n, int panels, double a, double b);

/// The weighted sum; f returns a number or anything with + and * by double.
template <class F>
auto integrate(const QuadratureRule& rule, F&& f) {
  auto sum = f(rule.node[0]) * rule.weight[0];
  for (std::size_t i = 1; i < rule.node.size(); ++i)
    sum = sum + f(rule.node[i]) * rule.weight[i];
  return sum;
}

/// A direction of a quadrature over solid angle, and the solid angle it stands for in sr.
struct DirectionNode {
  Vec3d w;
  double weight;
};
/// Product rule over the upper hemisphere: Gauss-Legendre in mu = cos(theta) on (0, 1) and the midpoint rule,
/// which converges exponentially for smooth periodic functions, in phi. Weights sum to 2 pi; no node is at
/// the horizon, the pole or phi = 0. Integrates without cosine: multiply by w.z for what a surface receives.
/// @throws Error unless both counts are positive and their product is at most 2^26
std::vector<DirectionNode> hemisphere_rule(int n_theta, int n_phi);

/// Integral of f(direction) over the solid angle of the upper hemisphere by hemisphere_rule.
template <class F>
auto integrate_hemisphere(F&& f, int n_theta, int n_phi) {
  const std::vector<DirectionNode> nodes = hemisphere_rule(n_theta, n_phi);
  auto sum = f(nodes[0].w) * nodes[0].weight;
  for (std::size_t i = 1; i < nodes.size(); ++i)
    sum = sum + f(nodes[i].w) * nodes[i].weight;
  return sum;
}

/// When to stop refining. An interval is accepted when its error estimate is below the absolute tolerance
/// (shared out in proportion to length) or the relative one times its integral, or at max_depth halvings.
/// Before min_depth it is never accepted: raise it for a function with narrow peaks that 15 nodes could miss.
struct AdaptiveOptions {
  double absolute = 1e-10, relative = 1e-9;
  int max_depth = 24, min_depth = 0;
};
struct AdaptiveResult {
  double value = 0;
  double error = 0; ///< sum of the estimates |K15 - G7|, usually far above the true error
};
/// Adaptive Gauss-Kronrod (7, 15) on [a, b]. A function value that is not finite ends the refinement and
/// shows in the result. Source: Piessens et al. 1983, QUADPACK, rule QK15.
AdaptiveResult integrate_adaptive(const std::function<double(double)>& f, double a, double b,
                                  const AdaptiveOptions& options = {});
/// The same nested: x outside, y inside.
AdaptiveResult integrate_adaptive_2d(const std::function<double(double, double)>& f, Vec2<double> low,
                                     Vec2<double> high, const AdaptiveOptions& options = {});

} // namespace nacre

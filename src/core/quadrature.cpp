#include "core/quadrature.h"

#include "core/error.h"

#include <array>
#include <fmt/format.h>

namespace nacre {
namespace {

struct Legendre {
  double value, slope;
};
/// P_n and its derivative at x in (-1, 1), by the three-term recurrence (Abramowitz and
/// Stegun 22.7.10, 22.8.5).
Legendre legendre(int n, double x) {
  double below = 1, at = x;
  for (int k = 2; k <= n; ++k) {
    const double above = ((2 * k - 1) * x * at - (k - 1) * below) / k;
    below = at;
    at = above;
  }
  return {at, n * (below - x * at) / (1 - x * x)};
}

// QK15: nodes of the Kronrod rule on [0, 1] (odd ones are those of Gauss), its weights, and Gauss's.
constexpr std::array<double, 8> kronrod_node = {
    0.991455371120812639206854697526329, 0.949107912342758524526189684047851,
    0.864864423359769072789712788640926, 0.741531185599394439863864773280788,
    0.586087235467691130294144691693829, 0.405845151377397166906606412076961,
    0.207784955007898467600689403773245, 0.0};
constexpr std::array<double, 8> kronrod_weight = {
    0.022935322010529224963732008058970, 0.063092092629978553290700663189204,
    0.104790010322250183839876322541518, 0.140653259715525918745189590510238,
    0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
    0.204432940075298892414161999234649, 0.209482141084727828012999174891714};
constexpr std::array<double, 4> gauss_weight = {
    0.129484966168869693270611432679082, 0.279705391489276667901467771423780,
    0.381830050505118944950369775488975, 0.417959183673469387755102040816327};

AdaptiveResult kronrod(const std::function<double(double)>& f, double a, double b) {
  const double centre = 0.5 * (a + b), half = 0.5 * (b - a), middle = f(centre);
  double k = kronrod_weight[7] * middle, g = gauss_weight[3] * middle;
  for (std::size_t i = 0; i < 7; ++i) {
    const double pair = f(centre - half * kronrod_node[i]) + f(centre + half * kronrod_node[i]);
    k += kronrod_weight[i] * pair;
    if (i % 2 == 1) g += gauss_weight[i / 2] * pair;
  }
  return {k * half, std::abs((k - g) * half)};
}

AdaptiveResult refine(const std::function<double(double)>& f, double a, double b, double absolute, int depth,
                      const AdaptiveOptions& options) {
  const AdaptiveResult whole = kronrod(f, a, b);
  if (!std::isfinite(whole.value) || depth >= options.max_depth) return whole;
  if (depth >= options.min_depth &&
      whole.error <= std::max(absolute, options.relative * std::abs(whole.value)))
    return whole;
  const double middle = 0.5 * (a + b);
  const AdaptiveResult left = refine(f, a, middle, absolute / 2, depth + 1, options);
  if (!std::isfinite(left.value)) return left;
  const AdaptiveResult right = refine(f, middle, b, absolute / 2, depth + 1, options);
  return {left.value + right.value, left.error + right.error};
}

} // namespace

QuadratureRule gauss_legendre(int n, double a, double b) {
  if (n < 1 || n > 10000) throw Error(fmt::format("quadrature: {} nodes, expected 1 to 10000", n));
  QuadratureRule rule{std::vector<double>(n), std::vector<double>(n)};
  const double centre = 0.5 * (a + b), half = 0.5 * (b - a);
  for (int i = 0; i < (n + 1) / 2; ++i) {
    double x = 0;
    if (2 * i + 1 < n) { // the middle node of an odd rule is 0 itself
      const double m = n;
      x = std::cos(pi * (i + 0.75) / (m + 0.5)) * (1 - (m - 1) / (8 * m * m * m));
      // Newton converges quadratically: after a step this small the next would be below rounding.
      for (double step = 1; std::abs(step) > 1e-10;) {
        const Legendre p = legendre(n, x);
        step = p.value / p.slope;
        x -= step;
      }
    }
    const double slope = legendre(n, x).slope, weight = 2 / ((1 - x * x) * slope * slope);
    rule.node[i] = centre - half * x;
    rule.node[n - 1 - i] = centre + half * x;
    rule.weight[i] = rule.weight[n - 1 - i] = half * weight;
  }
  return rule;
}

QuadratureRule composite_gauss_legendre(int n, int panels, double a, double b) {
  if (panels < 1 || panels > 1000000)
    throw Error(fmt::format("quadrature: {} panels, expected 1 to 1000000", panels));
  if (static_cast<double>(n) * panels > 0x1p26)
    throw Error(fmt::format("quadrature: {} panels of {} nodes are over 2^26 nodes", panels, n));
  const QuadratureRule unit = gauss_legendre(n, 0, 1);
  const double width = (b - a) / panels;
  QuadratureRule rule;
  rule.node.reserve(unit.node.size() * static_cast<std::size_t>(panels));
  rule.weight.reserve(rule.node.capacity());
  for (int panel = 0; panel < panels; ++panel)
    for (int i = 0; i < n; ++i) {
      rule.node.push_back(a + width * (panel + unit.node[i]));
      rule.weight.push_back(width * unit.weight[i]);
    }
  return rule;
}

std::vector<DirectionNode> hemisphere_rule(int n_theta, int n_phi) {
  if (n_theta < 1 || n_phi < 1 || static_cast<double>(n_theta) * n_phi > 0x1p26)
    throw Error(fmt::format("quadrature: {} x {} directions, expected at least 1 each way and at most 2^26",
                            n_theta, n_phi));
  const QuadratureRule mu = gauss_legendre(n_theta, 0, 1);
  std::vector<DirectionNode> nodes;
  nodes.reserve(static_cast<std::size_t>(n_theta) * static_cast<std::size_t>(n_phi));
  for (int i = 0; i < n_theta; ++i) {
    const double z = mu.node[i], s = std::sqrt((1 - z) * (1 + z));
    for (int j = 0; j < n_phi; ++j) {
      const double phi = 2 * pi * (j + 0.5) / n_phi;
      nodes.push_back({{s * std::cos(phi), s * std::sin(phi), z}, mu.weight[i] * 2 * pi / n_phi});
    }
  }
  return nodes;
}

AdaptiveResult integrate_adaptive(const std::function<double(double)>& f, double a, double b,
                                  const AdaptiveOptions& options) {
  return refine(f, a, b, options.absolute, 0, options);
}

AdaptiveResult integrate_adaptive_2d(const std::function<double(double, double)>& f, Vec2<double> low,
                                     Vec2<double> high, const AdaptiveOptions& options) {
  const double width = std::abs(high.x - low.x);
  if (width == 0) return {};
  // The inner integrals are the outer one's function values: their noise must stay well below its tolerance.
  AdaptiveOptions inner = options;
  inner.absolute = 0.1 * options.absolute / width;
  inner.relative = 0.1 * options.relative;
  const auto column = [&](double x) {
    return integrate_adaptive([&](double y) { return f(x, y); }, low.y, high.y, inner).value;
  };
  return integrate_adaptive(column, low.x, high.x, options);
}

} // namespace nacre

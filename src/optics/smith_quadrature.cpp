#include "optics/smith_quadrature.h"

#include "core/quadrature.h"

namespace nacre {

const SmithNodes& smith_nodes() {
  static const SmithNodes nodes = [] {
    const QuadratureRule rule = gauss_legendre(SmithNodes::count, 0, 1);
    SmithNodes n;
    for (int i = 0; i < SmithNodes::count; ++i) {
      const double x = rule.node[i], weight = rule.weight[i], q = x / (1 - x), slope = 1 / sqr(1 - x);
      n.x[i] = x;
      n.weight[i] = weight;
      n.narrow.t[i] = q * q;
      n.narrow.weight[i] = weight * 2 * q * slope;
      n.bounded.t[i] = x * x * x;
      n.bounded.weight[i] = weight * 3 * x * x;
      n.wide.t[i] = q * q * q;
      n.wide.weight[i] = weight * 3 * q * q * slope;
    }
    return n;
  }();
  return nodes;
}

} // namespace nacre

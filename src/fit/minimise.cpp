#include "fit/minimise.h"

#include <Eigen/Dense>
#include <limits>
#include <map>
#include <utility>

namespace nacre {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

struct Box {
  Vector lo, hi;
  explicit Box(const ParameterLayout& layout) : lo(layout.size()), hi(layout.size()) {
    for (int i = 0; i < layout.size(); ++i) {
      lo[i] = layout[i].coordinate_lo();
      hi[i] = layout[i].coordinate_hi();
    }
  }
};

std::span<const double> span_of(const Vector& x) { return {x.data(), std::size_t(x.size())}; }

/// The step d that makes g.d + d.H.d / 2 small with x + d in the box. Coordinates outside `free` stay. Those
/// that would leave the box stop at its end, and the others are solved for again.
Vector step_inside(const Matrix& H, const Vector& g, const Vector& x, const Box& box, std::vector<int> free) {
  Vector d = Vector::Zero(x.size());
  while (!free.empty()) {
    const auto n = Eigen::Index(free.size());
    Matrix part(n, n);
    Vector right(n);
    const Vector pull = g + H * d;
    for (Eigen::Index a = 0; a < n; ++a) {
      right[a] = -pull[free[std::size_t(a)]];
      for (Eigen::Index b = 0; b < n; ++b)
        part(a, b) = H(free[std::size_t(a)], free[std::size_t(b)]);
    }
    const Vector solved = part.ldlt().solve(right);
    if (!solved.allFinite()) return d;
    std::vector<int> left;
    for (Eigen::Index a = 0; a < n; ++a) {
      const int i = free[std::size_t(a)];
      const double y = x[i] + solved[a];
      if (y >= box.lo[i] && y <= box.hi[i])
        left.push_back(i);
      else
        d[i] = (y < box.lo[i] ? box.lo[i] : box.hi[i]) - x[i];
    }
    if (left.size() == free.size()) {
      for (Eigen::Index a = 0; a < n; ++a)
        d[free[std::size_t(a)]] = solved[a];
      return d;
    }
    free = std::move(left);
  }
  return d;
}

/// Coordinates that move the residuals and are not pressed against a bound.
std::vector<int> movable(const CostSlope& at, const Vector& x, const Box& box) {
  std::vector<int> free;
  for (int i = 0; i < int(x.size()); ++i)
    if (at.gauss_newton(i, i) > 0 && !(x[i] <= box.lo[i] && at.gradient[i] >= 0) &&
        !(x[i] >= box.hi[i] && at.gradient[i] <= 0))
      free.push_back(i);
  return free;
}

/// Hessian by forward differences of the gradient that stay inside the bounds. The channels of a parameter
/// are moved at once where no lobe mixes them.
/// @param step  length of the difference, per coordinate
bool hessian(const Residuals& residuals, const Vector& x, const Vector& g, const Vector& step, const Box& box,
             Matrix& H) {
  const ParameterLayout& layout = residuals.layout();
  const int width = layout.size();
  const auto& lobes = layout.start().lobes;
  const bool mixes = std::any_of(lobes.begin(), lobes.end(), [](const LobeSpec& l) { return bool(l.user); });
  std::map<std::array<int, 3>, std::vector<int>> groups; // of lobe and parameter; one number: by itself
  for (int i = 0; i < width; ++i)
    groups[{layout[i].lobe, layout[i].parameter, mixes ? layout[i].channel : std::min(layout[i].channel, 0)}]
        .push_back(i);
  H.setZero(width, width);
  CostSlope moved;
  for (const auto& [key, members] : groups) {
    Vector y = x;
    for (const int i : members)
      y[i] += x[i] + step[i] <= box.hi[i] ? step[i] : -step[i];
    if (!residuals.slope(span_of(y), moved)) return false;
    for (const int i : members)
      for (int j = 0; j < width; ++j) {
        const int channel = layout[i].channel, other = layout[j].channel;
        if (!mixes && channel >= 0 && other != channel)
          continue; // of a shared parameter: by its own difference
        H(j, i) = (moved.gradient[j] - g[j]) / (y[i] - x[i]);
      }
  }
  for (int i = 0; i < width; ++i)
    for (int j = 0; j < i; ++j) {
      const bool i_shared = layout[i].channel < 0, j_shared = layout[j].channel < 0;
      const double both = mixes || i_shared == j_shared ? 0.5 * (H(i, j) + H(j, i))
                          : i_shared                    ? H(j, i)
                                                        : H(i, j);
      H(i, j) = H(j, i) = both;
    }
  return H.allFinite();
}

} // namespace

bool at_bound(const FreeParameter& p, double coordinate) {
  const double lo = p.coordinate_lo(), hi = p.coordinate_hi();
  return std::min(coordinate - lo, hi - coordinate) < 1e-6 * (hi - lo);
}

Minimum levenberg_marquardt(const Residuals& residuals, std::vector<double> start, int max_iterations,
                            double relative_decrease, const OnStep& on_step) {
  const Box box(residuals.layout());
  Vector x = Eigen::Map<Vector>(start.data(), residuals.layout().size()).cwiseMax(box.lo).cwiseMin(box.hi);
  Minimum result{std::move(start), std::numeric_limits<double>::infinity(), 0, false};
  CostSlope at;
  if (!residuals.slope(span_of(x), at)) return result;
  double damping = 1e-3, growth = 2;
  int small_steps = 0;
  for (; result.iterations < max_iterations && damping < 1e10; ++result.iterations) {
    const std::vector<int> free = movable(at, x, box);
    if (free.empty() || at.cost <= residuals.rounding_cost()) {
      result.converged = true;
      break;
    }
    Matrix damped = at.gauss_newton;
    damped.diagonal() *= 1 + damping;
    Vector d = step_inside(damped, at.gradient, x, box, free);
    d = d.cwiseMin(0.5 * (box.hi - box.lo)).cwiseMax(-0.5 * (box.hi - box.lo));
    const double promised = -(at.gradient.dot(d) + 0.5 * d.dot(at.gauss_newton * d));
    if (promised < 0.1 * relative_decrease * at.cost) {
      result.converged = true;
      break;
    }
    const Vector y = (x + d).cwiseMax(box.lo).cwiseMin(box.hi);
    const double cost = residuals.cost(span_of(y)), gain = (at.cost - cost) / promised;
    if (gain > 1e-4) {
      small_steps = at.cost - cost < relative_decrease * at.cost ? small_steps + 1 : 0;
      CostSlope next;
      if (!residuals.slope(span_of(y), next)) {
        damping *= growth;
        growth *= 2;
        continue;
      }
      x = y;
      at = std::move(next);
      if (on_step && !on_step(span_of(x), at.cost)) break;
      damping = std::max(damping * std::max(1.0 / 3, 1 - std::pow(2 * gain - 1, 3)), 1e-9);
      growth = 2;
      if (small_steps == 2) {
        result.converged = true;
        break;
      }
    } else {
      damping *= growth;
      growth *= 2;
    }
  }
  Eigen::Map<Vector>(result.coordinates.data(), x.size()) = x;
  result.cost = at.cost;
  return result;
}

Minimum newton(const Residuals& residuals, std::vector<double> start, int max_iterations,
               double relative_decrease, const Residuals& curvature, const OnStep& on_step) {
  constexpr double cost_rounding = 1e-7; // residuals are single precision
  const ParameterLayout& layout = residuals.layout();
  const int width = layout.size();
  const Box box(layout);
  Vector x = Eigen::Map<Vector>(start.data(), width);
  Minimum result{std::move(start), std::numeric_limits<double>::infinity(), 0, false};
  CostSlope at, of_curvature;
  if (!residuals.slope(span_of(x), at)) return result;
  const bool own = &curvature == &residuals;
  Matrix H;
  std::vector<int> free;
  double last_promise = 0; // of the step before, 0 where the Hessian is to be computed again
  for (; result.iterations < max_iterations; ++result.iterations) {
    const std::vector<int> before = std::exchange(free, movable(at, x, box));
    result.converged = free.empty() || at.cost <= residuals.rounding_cost();
    if (result.converged) break;

    // Near the optimum the Hessian changes little: it is kept as long as each step promises a tenth of the
    // one before at most.
    const bool kept = last_promise > 0 && free == before;
    if (!kept) {
      if (!own && !curvature.slope(span_of(x), of_curvature)) break;
      const CostSlope& near = own ? at : of_curvature;
      // Differences that move the residuals by some thousandth of their size, where single precision still
      // has four digits.
      Vector step(width), scale(width);
      for (int i = 0; i < width; ++i) {
        const double strength = std::sqrt(near.gauss_newton(i, i));
        scale[i] = 1 / std::sqrt(std::max(at.gauss_newton(i, i), 1e-300));
        step[i] = std::min(3e-3 * std::sqrt(2 * near.cost) / std::max(strength, 1e-300),
                           0.01 * (box.hi[i] - box.lo[i]));
        step[i] = std::max(step[i], 1e-6 * (box.hi[i] - box.lo[i]));
      }
      if (!hessian(curvature, x, near.gradient, step, box, H)) break;
      const auto n = Eigen::Index(free.size());
      Matrix scaled(n, n);
      for (Eigen::Index a = 0; a < n; ++a)
        for (Eigen::Index b = 0; b < n; ++b) {
          const int i = free[std::size_t(a)], j = free[std::size_t(b)];
          scaled(a, b) = scale[i] * H(i, j) * scale[j];
        }
      const Eigen::SelfAdjointEigenSolver<Matrix> eigen(scaled);
      const Vector positive = eigen.eigenvalues().cwiseAbs().cwiseMax(1e-5);
      scaled = eigen.eigenvectors() * positive.asDiagonal() * eigen.eigenvectors().transpose();
      for (Eigen::Index a = 0; a < n; ++a)
        for (Eigen::Index b = 0; b < n; ++b) {
          const int i = free[std::size_t(a)], j = free[std::size_t(b)];
          H(i, j) = scaled(a, b) / (scale[i] * scale[j]);
        }
    }
    Vector d = step_inside(H, at.gradient, x, box, free);
    const Vector most = 0.2 * (box.hi - box.lo);
    d = d.cwiseMin(most).cwiseMax(-most);
    const double promised = -(at.gradient.dot(d) + 0.5 * d.dot(H * d));
    const bool slow = kept && promised > 0.1 * last_promise;
    last_promise = slow ? 0 : promised;
    if (promised < std::max(relative_decrease, 1e-12) * at.cost) {
      result.converged = true;
      break;
    }
    const auto moved_by = [&](double t) { return Vector((x + t * d).cwiseMax(box.lo).cwiseMin(box.hi)); };
    double t = 1;
    Vector y = moved_by(t);
    // A step that promises less than the rounding of the cost cannot be judged by the cost: it is taken.
    const bool judged = promised > cost_rounding * at.cost;
    double next = residuals.cost(span_of(y));
    while (!(std::isfinite(next) && (!judged || next < at.cost)) && t > 1e-3) {
      y = moved_by(t *= 0.5);
      next = residuals.cost(span_of(y));
    }
    if (judged && !(next < at.cost)) {
      if (!kept) break;
      last_promise = 0; // once more from here, with a Hessian of here
      continue;
    }
    CostSlope there;
    if (!residuals.slope(span_of(y), there)) break;
    x = y;
    at = std::move(there);
    if (on_step && !on_step(span_of(x), at.cost)) break;
  }
  Eigen::Map<Vector>(result.coordinates.data(), width) = x;
  result.cost = at.cost;
  return result;
}

} // namespace nacre

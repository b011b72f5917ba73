#include "optics/smith_invariance.h"

#include "core/parallel.h"
#include "core/quadrature.h"
#include "optics/microfacet.h"

namespace nacre {
namespace {

constexpr int n_alpha = SmithInvariance::n_alpha, n_cos = SmithInvariance::n_cos,
              n_phi = SmithInvariance::n_phi;
constexpr int n_modes = n_phi;

/// Fourier coefficients in azimuth of D / 4 for GGX, at the vector from one direction to another or their
/// sum. With P the square of its horizontal part and z its height, D = alpha^2 / pi (1 + c / X)^2 with X = P
/// + alpha^2 z^2 = a - b cos(phi) and c = (1 - alpha^2) z^2; 1 / X and 1 / X^2 have geometric series.
/// @param sign  1: difference of two directions whose azimuths differ by phi; -1: sum
void kernel_modes(double alpha, double sin_1, double sin_2, double z, int sign, double* modes) {
  const double a2z2 = sqr(alpha * z), c = (1 - sqr(alpha)) * sqr(z), b = 2 * sin_1 * sin_2;
  const double a_minus_b = sqr(sin_1 - sin_2) + a2z2, a = a_minus_b + b;
  const double r = std::sqrt(a_minus_b * (a + b)), q = b / (a + r);
  const double D0 = sqr(alpha) / (4 * pi);
  double power = 1;
  for (int m = 0; m < n_modes; ++m) {
    const double first = power / r, second = power * (a + m * r) / (r * r * r);
    modes[m] = D0 * (m == 0 ? 1 : 2) * (2 * c * first + c * c * second) + (m == 0 ? D0 : 0);
    power *= sign * q;
  }
}

using Grid = std::vector<double>; ///< square, over the cosines of i and o

/// One roughness: the light after each bounce, on a grid uniform in t = sqrt(cos), by the trapezoid rule.
class March {
public:
  /// @param refinement  cosines of the march to one of the table
  March(double alpha, std::size_t refinement) : n(std::size_t(n_cos - 1) * refinement + 1) {
    const double h = 1.0 / double(n - 1);
    for (std::size_t j = 0; j < n; ++j) {
      const double t = double(j) * h;
      mu_.push_back(t * t);
      sin_.push_back(std::sqrt(1 - sqr(t * t)));
      weight_.push_back(2 * t * h * (j == n - 1 ? 0.5 : 1));
      lambda_cos_.push_back(0.5 * (std::sqrt(sqr(alpha * sin_.back()) + sqr(mu_.back())) - mu_.back()));
    }
    rise_.assign(n_modes, Grid(n * n));
    turn_.assign(n_modes, Grid(n * n));
    double modes[n_modes];
    for (std::size_t d = 1; d < n; ++d)
      for (std::size_t o = 1; o < n; ++o) {
        kernel_modes(alpha, sin_[d], sin_[o], mu_[d] + mu_[o], -1, modes);
        for (std::size_t m = 0; m < n_modes; ++m)
          turn_[m][d * n + o] = modes[m];
        if (o <= d) continue;
        kernel_modes(alpha, sin_[d], sin_[o], mu_[o] - mu_[d], 1, modes);
        for (std::size_t m = 0; m < n_modes; ++m)
          rise_[m][o * n + d] = modes[m];
      }
    // The half interval beside d itself, where the kernel jumps to 0, takes what the rule finds missing of
    // the facets that a ray d meets: no light is lost to quadrature.
    for (std::size_t d = 0; d < n; ++d) {
      double met = lambda_cos_[d];
      for (std::size_t o = d + 1; o < n; ++o)
        met -= 2 * pi * weight_[o] * rise_[0][o * n + d];
      same_.push_back(met);
    }
    // Nothing lies above the zenith, but the interval below it has an end there.
    same_[n - 1] = 0.5 * h * sqr(alpha);
  }

  /// (1 + Lambda_i + Lambda_o) T of the first bounce.
  const Grid& first(std::size_t mode) const { return turn_[mode]; }

  /// Light of the next bounce from that of one, both as (1 + Lambda_i + Lambda_o) T.
  Grid next(std::size_t mode, const Grid& light) const {
    Grid T(n * n), result(n * n);
    for (std::size_t i = 1; i < n; ++i)
      for (std::size_t o = 1; o < n; ++o)
        T[i * n + o] = light[i * n + o] / facets_met(i, o);
    for (std::size_t i = 1; i < n; ++i)
      for (std::size_t o = 1; o <= i; ++o) {
        const double at_ends = mode == 0 ? (same_[i] / mu_[i] + same_[o] / mu_[o]) * T[i * n + o] : 0;
        result[i * n + o] = result[o * n + i] = at_ends + lifted(mode, T, i, o);
      }
    return result;
  }
  /// All bounces after the first.
  Grid all_later(std::size_t mode) const {
    Grid T(n * n), result(n * n);
    for (std::size_t i = 1; i < n; ++i)
      for (std::size_t o = 1; o <= i; ++o) {
        const double at_ends = mode == 0 ? same_[i] / mu_[i] + same_[o] / mu_[o] : 0;
        const double source = turn_[mode][i * n + o] + lifted(mode, T, i, o);
        T[i * n + o] = T[o * n + i] = source / (facets_met(i, o) - at_ends);
        result[i * n + o] = result[o * n + i] = T[i * n + o] * facets_met(i, o) - turn_[mode][i * n + o];
      }
    return result;
  }

private:
  double facets_met(std::size_t i, std::size_t o) const {
    return 1 + lambda_cos_[i] / mu_[i] + lambda_cos_[o] / mu_[o];
  }
  /// Both integrals, without the half intervals at their ends.
  double lifted(std::size_t mode, const Grid& T, std::size_t i, std::size_t o) const {
    const double* from_i = &rise_[mode][i * n];
    const double* from_o = &rise_[mode][o * n];
    double sum = 0; // T is symmetric: rows are read, not columns
    for (std::size_t d = 1; d < i; ++d)
      sum += weight_[d] / mu_[d] * T[o * n + d] * from_i[d];
    for (std::size_t d = 1; d < o; ++d)
      sum += weight_[d] / mu_[d] * T[i * n + d] * from_o[d];
    return (mode == 0 ? 2 * pi : pi) * sum;
  }

  std::size_t n;
  std::vector<double> mu_, sin_, weight_, lambda_cos_, same_;
  std::vector<Grid> rise_; ///< [o][d] with cos_d < cos_o: from d up to o
  std::vector<Grid> turn_; ///< down along -i, up along o
};

/// What mirror facets leave to later bounces: 1 - E of single scattering, by a product rule over visible
/// normals.
double left_over(const Ggx<double>& d, double cos_theta) {
  static const QuadratureRule height = gauss_legendre(64, 0, 1);
  constexpr int n_azimuth = 16; // of half a turn: the other half mirrors it
  const Vec3d wo{std::sqrt(1 - sqr(cos_theta)), 0, cos_theta};
  const double lo = d.lambda_cos(wo);
  double kept = 0;
  for (std::size_t j = 0; j < height.node.size(); ++j)
    for (int i = 0; i < n_azimuth; ++i) {
      const Vec3d wi = reflect(wo, d.sample_visible(wo, {0.5 * (i + 0.5) / n_azimuth, height.node[j]}));
      if (wi.z > 0) // G2 / G1(wo), Heitz 2014, eq. 43 and 99
        kept += height.weight[j] / n_azimuth * (wo.z + lo) * wi.z /
                (wo.z * wi.z + lo * wi.z + d.lambda_cos(wi) * wo.z);
    }
  return 1 - kept;
}

} // namespace

SmithInvariance::SmithInvariance() {
  solve();
  balance();
}

void SmithInvariance::solve() {
  constexpr std::size_t row = n_phi, per_alpha = std::size_t(n_cos) * n_cos * row;
  for (auto& order : orders_)
    order.assign(n_alpha * per_alpha, 0.0f); // alpha = 0 is a mirror: no bounce follows the first
  parallel_for(n_alpha - 1, [&](std::size_t k) {
    const double alpha = sqr(double(k + 1) / (n_alpha - 1));
    const std::size_t refinement = alpha < 0.12 ? 5 : 3, n = (n_cos - 1) * refinement + 1;
    const March march(alpha, refinement);
    std::array<std::vector<Grid>, 3> modes;
    for (std::size_t m = 0; m < n_modes; ++m) {
      modes[0].push_back(march.next(m, march.first(m)));
      modes[1].push_back(march.next(m, modes[0].back()));
      modes[2].push_back(march.all_later(m));
    }
    for (std::size_t i = 1; i < n_cos; ++i)
      for (std::size_t o = 1; o < n_cos; ++o)
        for (std::size_t p = 0; p < n_phi; ++p)
          for (std::size_t order = 0; order < 3; ++order) {
            double sum = 0;
            for (std::size_t m = 0; m < n_modes; ++m)
              sum += modes[order][m][(i * n + o) * refinement] * std::cos(double(m * p) * pi / (n_phi - 1));
            // Per sqrt(cos_i cos_o), which takes out how it vanishes at the horizon.
            const double t2 = double(i * o) / sqr(n_cos - 1);
            orders_[order][(k + 1) * per_alpha + (i * n_cos + o) * row + p] = float(std::max(sum / t2, 0.0));
          }
  });
}

void SmithInvariance::balance() {
  constexpr int n_all = 97; // cosines of the integral over outgoing light
  const auto direction = [](double t) { return Vec3d{std::sqrt(1 - sqr(t * t)), 0, t * t}; };
  balance_.assign(std::size_t(n_balance_alpha) * n_balance_cos, 1.0f);
  parallel_for(n_balance_alpha - 1, [&](std::size_t k) {
    const double alpha = std::max(1e-4, sqr(double(k + 1) / (n_balance_alpha - 1)));
    const Ggx<double> d{alpha, alpha};
    std::vector<double> target, factor(n_balance_cos, 1.0), albedo(std::size_t(n_balance_cos) * n_all);
    for (int i = 0; i < n_balance_cos; ++i) {
      const Vec3d wi = direction(std::max(i, 1) / double(n_balance_cos - 1));
      target.push_back(left_over(d, wi.z));
      for (int o = 1; o < n_all; ++o) {
        const double t = double(o) / (n_all - 1), step = (o == n_all - 1 ? 0.5 : 1.0) / (n_all - 1);
        const Vec3d wo = direction(t);
        double mean = 0; // over azimuth; exact for what is linear between its nodes
        for (int p = 0; p < n_phi; ++p)
          mean += (p % (n_phi - 1) == 0 ? 0.5 : 1.0) / (n_phi - 1) * interpolate(wo, wi, alpha, p).all;
        albedo[std::size_t(i * n_all + o)] =
            2 * pi * 2 * t * step * wo.z * 4 * visibility(d, wo, wi, 0.0) * mean;
      }
    }
    // Symmetric scaling of a symmetric kernel to given sums (Sinkhorn 1967), with damping.
    for (int pass = 0; pass < 30; ++pass) {
      std::vector<double> next = factor;
      for (std::size_t i = 0; i < n_balance_cos; ++i) {
        double sum = 0;
        for (std::size_t o = 1; o < n_all; ++o) {
          const double x = double(o) * (n_balance_cos - 1) / (n_all - 1);
          const std::size_t cell = std::min(std::size_t(x), std::size_t(n_balance_cos - 2));
          const double t = x - double(cell);
          sum += albedo[i * n_all + o] * (factor[cell] * (1 - t) + factor[cell + 1] * t);
        }
        if (sum > 0) next[i] = std::clamp(std::sqrt(factor[i] * target[i] / sum), 0.25, 4.0);
      }
      factor = next;
    }
    for (std::size_t i = 0; i < n_balance_cos; ++i)
      balance_[(k + 1) * n_balance_cos + i] = float(factor[i]);
  });
}

const SmithInvariance& SmithInvariance::table() {
  static const SmithInvariance instance;
  return instance;
}

} // namespace nacre

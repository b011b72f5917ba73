#include "measured/merl_sampling.h"

#include "core/warp.h"
#include "measured/merl_table.h"

#include <limits>

namespace nacre {

namespace {

constexpr int subdivisions = 2; // of a cell, each way, when its probability is estimated

double luminance(const Spectrum<double, 3>& rgb) {
  return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

/// One node of the midpoint rule that fills a cell.
struct Probe {
  double reflected;  ///< luminance of f times cos theta_i
  double cosine;     ///< cos theta_i
  double half_to_wi; ///< dwi / dwh
  double half_angle; ///< solid angle of wh it stands for
};

} // namespace

MerlSampling::MerlSampling(const MerlTable& table)
    : cosine_share_(n_wo), probability_(static_cast<std::size_t>(n_wo) * n_theta * n_v),
      row_cdf_(static_cast<std::size_t>(n_wo) * n_theta), cell_cdf_(probability_.size()) {
  for (int node = 0; node < n_wo; ++node)
    build_node(table, node);
}

void MerlSampling::build_node(const MerlTable& table, int node) {
  // Not quite to the horizon, where a table has nothing measured.
  const double theta_o = std::min(pi / 2 * (1 - sqr(1 - node / double(n_wo - 1))), 89.5 * pi / 180);
  const Vec3d wo = spherical_direction(theta_o, 0.0);
  const HalfVectorChart<double> chart(wo);
  const double theta_max = chart.theta_max();

  std::vector<Probe> probes;
  probes.reserve(static_cast<std::size_t>(n_theta) * n_v * subdivisions * subdivisions * 2);
  std::vector<double> mass(n_theta * n_v);
  for (int i = 0; i < n_theta; ++i) {
    const double lower = theta_max * sqr(i / double(n_theta)),
                 upper = theta_max * sqr((i + 1) / double(n_theta));
    const double versine = sqr(std::sin(lower / 2)), versine_range = half_versine_between(lower, upper);
    for (int j = 0; j < n_v; ++j)
      for (int a = 0; a < subdivisions; ++a) {
        const double theta = 2 * std::asin(std::sqrt(versine + versine_range * (a + 0.5) / subdivisions));
        const double phi_max = chart.phi_max(theta);
        for (int b = 0; b < 2 * subdivisions; ++b) {
          const double v = (j + (b / 2 + 0.5) / subdivisions) / n_v * (b % 2 ? 1 : -1);
          const Vec3d wh = spherical_direction(theta, v * phi_max), wi = reflect(wo, wh);
          Probe p;
          p.cosine = std::max(wi.z, 0.0);
          p.reflected = luminance(table.interpolate(half_difference(wo, wi))) * p.cosine;
          p.half_to_wi = 4 * dot(wo, wh);
          p.half_angle = 4 * versine_range * phi_max / n_v / (2 * subdivisions * subdivisions);
          mass[i * n_v + j] += p.reflected * p.half_to_wi * p.half_angle;
          probes.push_back(p);
        }
      }
  }
  double total = 0;
  for (const double m : mass)
    total += m;
  if (!(total > 0)) { // black, or nothing measured: any density will do
    std::fill(mass.begin(), mass.end(), 1.0);
    total = static_cast<double>(mass.size());
  }

  // The probability of a cell is what the rounded distribution functions make of it: pdf and sample agree.
  float* const rows = &row_cdf_[static_cast<std::size_t>(node) * n_theta];
  double rows_sum = 0;
  for (int i = 0; i < n_theta; ++i) {
    float* const cells = &cell_cdf_[(static_cast<std::size_t>(node) * n_theta + i) * n_v];
    double row = 0, row_sum = 0;
    for (int j = 0; j < n_v; ++j)
      row += mass[i * n_v + j];
    for (int j = 0; j < n_v; ++j) {
      row_sum += row > 0 ? mass[i * n_v + j] / row : 1.0 / n_v;
      cells[j] = j + 1 < n_v ? static_cast<float>(std::min(row_sum, 1.0)) : 1.0f;
    }
    rows_sum += row / total;
    rows[i] = i + 1 < n_theta ? static_cast<float>(std::min(rows_sum, 1.0)) : 1.0f;
    float* const probability = &probability_[(static_cast<std::size_t>(node) * n_theta + i) * n_v];
    for (int j = 0; j < n_v; ++j)
      probability[j] = (rows[i] - (i > 0 ? rows[i - 1] : 0.0f)) * (cells[j] - (j > 0 ? cells[j - 1] : 0.0f));
  }

  // The share of the cosine lobe: second moments of f cos / pdf, by the same probes.
  double least = std::numeric_limits<double>::infinity();
  for (int tenths = 1; tenths <= 9; ++tenths) {
    const double share = tenths / 10.0;
    double moment = 0;
    constexpr int probes_per_cell = 2 * subdivisions * subdivisions;
    for (std::size_t n = 0; n < probes.size(); ++n) {
      const Probe& p = probes[n];
      const float cell = probability_[static_cast<std::size_t>(node) * n_theta * n_v + n / probes_per_cell];
      const double solid_angle = p.half_angle * p.half_to_wi;
      const double density = cell / (solid_angle * probes_per_cell);
      if (p.reflected > 0)
        moment += sqr(p.reflected) / (share * p.cosine * inv_pi + (1 - share) * density) * solid_angle;
    }
    if (moment < least) {
      least = moment;
      cosine_share_[node] = static_cast<float>(share);
    }
  }
}

template <class R>
Vec3<R> MerlSampling::sample(const Vec3<R>& wo, R u_lobe, const Vec2<R>& u) const {
  const HalfVectorChart<R> chart(wo);
  const R position = node_position(chart.theta_o);
  int node = static_cast<int>(whole_below(position, n_wo - 1));
  const R t = position - node;
  const R share = cosine_share_[node] * (1 - t) + cosine_share_[node + 1] * t;
  if (u_lobe < share) return square_to_cosine_hemisphere(u);
  node += (u_lobe - share) < t * (1 - share) ? 1 : 0;

  // Index of the interval of a distribution function that holds x, and the fraction of the way through it.
  const auto invert = [](const float* cdf, int n, R x, int& index) {
    index = static_cast<int>(std::upper_bound(cdf, cdf + n - 1, x, [](R a, float b) { return a < b; }) - cdf);
    const R before = index > 0 ? cdf[index - 1] : 0, width = cdf[index] - before;
    return width > 0 ? clamp((x - before) / width, R(0), R(1)) : R(0.5);
  };
  int i, j;
  const R along_theta = invert(&row_cdf_[static_cast<std::size_t>(node) * n_theta], n_theta, u.x, i);
  const R sign = u.y < R(0.5) ? R(-1) : R(1), y = u.y < R(0.5) ? 2 * u.y : 2 * u.y - 1;
  const R along_v = invert(&cell_cdf_[(static_cast<std::size_t>(node) * n_theta + i) * n_v], n_v, y, j);

  const R theta_max = chart.theta_max();
  const R lower = theta_max * sqr(i / R(n_theta)), upper = theta_max * sqr((i + 1) / R(n_theta));
  const R versine = sqr(sin(lower / 2)) + half_versine_between(lower, upper) * along_theta;
  const R theta = 2 * asin(min(sqrt(versine), R(1)));
  const R phi = sign * (j + along_v) / R(n_v) * chart.phi_max(theta);
  const Vec3<R> h = spherical_direction(theta, phi);
  const Vec2<R> x = chart.azimuth(wo);
  return reflect(wo, Vec3<R>{h.x * x.x - h.y * x.y, h.x * x.y + h.y * x.x, h.z});
}

template Vec3<float> MerlSampling::sample(const Vec3<float>&, float, const Vec2<float>&) const;
template Vec3<double> MerlSampling::sample(const Vec3<double>&, double, const Vec2<double>&) const;

} // namespace nacre

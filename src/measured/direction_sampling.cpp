#include "measured/direction_sampling.h"

#include "core/warp.h"

#include <algorithm>
#include <numeric>

namespace nacre {
namespace {

constexpr int subdivisions = 2; // of a cell, each way, when its probability is estimated

/// A direction that light is scattered to.
struct Probe {
  Vec3d wi;
  double scattered;   ///< luminance of f times |cos theta_i|
  double solid_angle; ///< of wi, that it stands for
};

/// Shares of the cosine lobe to choose from. Some is always there: weights stay bounded.
constexpr std::array cosine_shares{0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9};
/// Light both reflected and let through: neither is looked for less often than this.
constexpr double least_share_of_a_side = 0.02;

double luminance(const std::array<double, 3>& rgb) {
  return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

/// True with probability p; leaves `u` uniform in [0, 1).
template <class R>
bool chance(R& u, R p) {
  const bool yes = u < p;
  u = clamp(yes ? u / p : (u - p) / (1 - p), R(0), R(1 - 6e-8));
  return yes;
}

/// The half vectors of a direction and the light that is scattered by way of each. `wo` is given with z > 0,
/// though it may stand for one on the back; columns are of v, or of |v| if `folded`.
class HalfVectors {
public:
  HalfVectors(const MeasuredBsdf& measured, const Vec3d& wo, bool from_back, bool transmits, bool folded)
      : measured_(measured), wo_(wo), chart_(wo), azimuth_(chart_.azimuth(wo)), outer_(from_back ? -1 : 1),
        inner_(from_back != transmits ? -1 : 1), folded_(folded) {}

  /// Calls f(column, probe) for n_theta x n_v probes a cell of one row, and for both signs if folded.
  template <class Visit>
  void visit(int row, int rows, int columns, int n_theta, int n_v, Visit f) const {
    const double theta_max = chart_.theta_max();
    const double lower = theta_max * sqr(row / double(rows)),
                 upper = theta_max * sqr((row + 1) / double(rows));
    const double versine = sqr(std::sin(lower / 2)), range = half_versine_between(lower, upper);
    for (int a = 0; a < n_theta; ++a) {
      const double theta = 2 * std::asin(std::min(std::sqrt(versine + range * (a + 0.5) / n_theta), 1.0));
      const double phi_max = chart_.phi_max(theta);
      const int sides = folded_ ? 2 : 1;
      const double half_angle = 4 * range * phi_max / columns / (n_theta * n_v * sides);
      for (int j = 0; j < columns; ++j)
        for (int b = 0; b < n_v; ++b)
          for (int side = 0; side < sides; ++side) {
            const double along = (j + (b + 0.5) / n_v) / columns;
            const double v = folded_ ? (side == 0 ? along : -along) : 2 * along - 1;
            f(j, probe(theta, v * phi_max, half_angle));
          }
    }
  }

private:
  Probe probe(double theta, double phi, double half_angle) const {
    const Vec3d h = spherical_direction(theta, phi);
    const Vec3d wh{h.x * azimuth_.x - h.y * azimuth_.y, h.x * azimuth_.y + h.y * azimuth_.x, h.z};
    const Vec3d wi = reflect(wo_, wh);
    const double cosine = std::max(wi.z, 0.0);
    const Vec3d there{wi.x, wi.y, inner_ * wi.z};
    const double f = cosine > 0 ? luminance(measured_.rgb({wo_.x, wo_.y, outer_ * wo_.z}, there)) : 0;
    // A formula may fail at some directions: nobody is sent there on its account.
    return {there, std::isfinite(f) ? f * cosine : 0, half_angle * 4 * dot(wo_, wh)};
  }

  const MeasuredBsdf& measured_;
  Vec3d wo_;
  HalfVectorChart<double> chart_;
  Vec2d azimuth_;
  double outer_, inner_;
  bool folded_;
};

} // namespace

DirectionSampling::DirectionSampling(const MeasuredBsdf& measured)
    : n_(measured.is_isotropic() ? isotropic : anisotropic) {
  const MeasuredSides sides = measured.sides();
  const bool known[4] = {sides.reflects_front, sides.transmits_to_front, sides.reflects_back,
                         sides.transmits_to_back};
  std::size_t passages = 0;
  for (std::size_t p = 0; p < 4; ++p)
    place_[p] = known[p] ? float(passages++) : -1.0f;
  front_only_ = known[0] && passages == 1;
  const std::size_t nodes = passages * std::size_t(n_.azimuths * n_.thetas);
  cosine_.resize(nodes);
  lobe_.resize(nodes);
  probability_.resize(nodes * n_.cells());
  row_cdf_.resize(nodes * n_.rows);
  cell_cdf_.resize(nodes * n_.cells());
  for (const bool from_back : {false, true}) {
    if (place_[from_back ? 2 : 0] < 0 && place_[from_back ? 3 : 1] < 0) continue;
    for (int azimuth = 0; azimuth < n_.azimuths; ++azimuth)
      build_azimuth(measured, from_back, azimuth);
    choose_cosine_shares(measured, from_back);
  }
}

Vec3d DirectionSampling::direction_at(double azimuth, double theta) const {
  // Not quite to the horizon, where nothing is measured.
  const double theta_o = std::min(pi / 2 * (1 - sqr(1 - theta / (n_.thetas - 1))), 89.5 * pi / 180);
  return spherical_direction(theta_o, 2 * pi * azimuth / n_.azimuths);
}

void DirectionSampling::build_azimuth(const MeasuredBsdf& measured, bool from_back, int azimuth) {
  std::vector<int> dark; // black, or nothing measured
  std::vector<bool> is_dark(std::size_t(n_.thetas));
  for (int theta = 0; theta < n_.thetas; ++theta) {
    const Vec3d wo = direction_at(azimuth, theta);
    std::array<std::vector<double>, 2> mass, even; // even: what a white surface would scatter
    std::array<double, 2> total{};
    for (std::size_t side = 0; side < 2; ++side) {
      if (place_[2 * from_back + side] < 0) continue;
      mass[side].resize(std::size_t(n_.cells()));
      even[side].resize(std::size_t(n_.cells()));
      const HalfVectors half_vectors(measured, wo, from_back, side == 1, n_.azimuths == 1);
      for (int i = 0; i < n_.rows; ++i)
        half_vectors.visit(i, n_.rows, n_.columns, subdivisions, n_.azimuths == 1 ? subdivisions : 1,
                           [&](int j, const Probe& p) {
                             mass[side][std::size_t(i * n_.columns + j)] += p.scattered * p.solid_angle;
                             even[side][std::size_t(i * n_.columns + j)] += std::abs(p.wi.z) * p.solid_angle;
                             total[side] += p.scattered * p.solid_angle;
                           });
    }
    is_dark[std::size_t(theta)] = !(total[0] + total[1] > 0);
    for (std::size_t side = 0; side < 2; ++side) {
      if (place_[2 * from_back + side] < 0) continue;
      const std::size_t node = node_index(std::size_t(place_[2 * from_back + side]), azimuth, theta);
      const bool both = place_[2 * from_back] >= 0 && place_[2 * from_back + 1] >= 0;
      lobe_[node] = !both ? 1.0f
                    : is_dark[std::size_t(theta)]
                        ? 0.5f
                        : float(least_share_of_a_side +
                                (1 - 2 * least_share_of_a_side) * total[side] / (total[0] + total[1]));
      const std::vector<double>& shape = total[side] > 0 ? mass[side] : even[side];
      set_cells(node, shape, std::accumulate(shape.begin(), shape.end(), 0.0));
    }
  }
  // Where there is nothing to go by, the nearest direction that has something serves.
  for (int theta = 0; theta < n_.thetas; ++theta)
    if (is_dark[std::size_t(theta)])
      for (int away = 1; away < n_.thetas; ++away) {
        const auto lit = [&](int at) { return at >= 0 && at < n_.thetas && !is_dark[std::size_t(at)]; };
        const int from = lit(theta - away) ? theta - away : theta + away;
        if (!lit(from)) continue;
        for (std::size_t side = 0; side < 2; ++side)
          if (const float place = place_[2 * from_back + side]; place >= 0)
            copy_node(node_index(std::size_t(place), azimuth, from),
                      node_index(std::size_t(place), azimuth, theta));
        break;
      }
}

void DirectionSampling::copy_node(std::size_t from, std::size_t to) {
  lobe_[to] = lobe_[from];
  const auto copy = [&](std::vector<float>& numbers, int n) {
    std::copy_n(numbers.begin() + std::ptrdiff_t(from) * n, n, numbers.begin() + std::ptrdiff_t(to) * n);
  };
  copy(probability_, n_.cells());
  copy(row_cdf_, n_.rows);
  copy(cell_cdf_, n_.cells());
}

void DirectionSampling::set_cells(std::size_t node, std::span<const double> mass, double total) {
  // The probability of a cell is what the rounded distribution functions make of it: pdf and sample agree.
  const int rows = n_.rows, columns = n_.columns;
  float* const row_cdf = &row_cdf_[node * rows];
  double rows_sum = 0;
  for (int i = 0; i < rows; ++i) {
    const double* const in = &mass[std::size_t(i * columns)];
    float* const cells = &cell_cdf_[(node * rows + i) * columns];
    float* const probability = &probability_[(node * rows + i) * columns];
    double row = 0, row_sum = 0;
    for (int j = 0; j < columns; ++j)
      row += in[j];
    rows_sum += row / total;
    row_cdf[i] = i + 1 < rows ? float(std::min(rows_sum, 1.0)) : 1.0f;
    for (int j = 0; j < columns; ++j) {
      row_sum += row > 0 ? in[j] / row : 1.0 / columns;
      cells[j] = j + 1 < columns ? float(std::min(row_sum, 1.0)) : 1.0f;
      probability[j] = lobe_[node] * (row_cdf[i] - (i > 0 ? row_cdf[i - 1] : 0.0f)) *
                       (cells[j] - (j > 0 ? cells[j - 1] : 0.0f));
    }
  }
}

void DirectionSampling::choose_cosine_shares(const MeasuredBsdf& measured, bool from_back) {
  // Second moments of f cos / pdf half way between the nodes, where the densities know least. Up to here the
  // cosine lobe's probability is 0 and pdf gives that of the cells alone.
  const int azimuths = n_.azimuths, intervals = n_.thetas - 1;
  std::vector<double> share(std::size_t(azimuths * n_.thetas));
  for (int azimuth = 0; azimuth < azimuths; ++azimuth)
    for (int theta = 0; theta < intervals; ++theta) {
      const Vec3d up = direction_at(azimuths == 1 ? 0 : azimuth + 0.5, theta + 0.5);
      const Vec3d wo{up.x, up.y, from_back ? -up.z : up.z};
      std::array<double, cosine_shares.size()> moment{};
      for (const bool transmits : {false, true}) {
        const float place = place_[2 * from_back + transmits];
        if (place < 0) continue;
        const double side_share = lobe_[node_index(std::size_t(place), azimuth, theta)];
        const HalfVectors half_vectors(measured, up, from_back, transmits, azimuths == 1);
        for (int i = 0; i < n_.rows; ++i)
          half_vectors.visit(i, n_.rows, n_.columns, 1, 1, [&](int, const Probe& p) {
            if (!(p.scattered > 0)) return;
            const double cells = pdf(wo, p.wi), cosine = side_share * std::abs(p.wi.z) * inv_pi;
            for (std::size_t k = 0; k < moment.size(); ++k)
              moment[k] += sqr(p.scattered) * p.solid_angle /
                           (cosine_shares[k] * cosine + (1 - cosine_shares[k]) * cells);
          });
      }
      const double best =
          cosine_shares[std::size_t(std::min_element(moment.begin(), moment.end()) - moment.begin())];
      for (const int a : {azimuth, (azimuth + 1) % azimuths})
        for (const int t : {theta, theta + 1}) {
          double& most = share[std::size_t(a * n_.thetas + t)];
          most = std::max(most, best);
        }
    }

  for (std::size_t side = 0; side < 2; ++side) {
    if (place_[2 * from_back + side] < 0) continue;
    const std::size_t first = node_index(std::size_t(place_[2 * from_back + side]), 0, 0);
    for (std::size_t n = 0; n < share.size(); ++n) {
      const std::size_t node = first + n;
      const float cells = float(1 - share[n]);
      cosine_[node] = float(share[n]) * lobe_[node];
      lobe_[node] *= cells;
      for (std::size_t c = node * n_.cells(); c < (node + 1) * n_.cells(); ++c)
        probability_[c] *= cells;
    }
  }
}

template <class R>
Vec3<R> DirectionSampling::sample(const Vec3<R>& wo, R u_lobe, const Vec2<R>& u) const {
  const bool from_back = wo.z < 0;
  const std::array<float, 2> places{place_[2 * from_back], place_[2 * from_back + 1]};
  if (!(abs(wo.z) > 0) || (places[0] < 0 && places[1] < 0)) return {R(0), R(0), R(-1)};
  const Vec3<R> o{wo.x, wo.y, abs(wo.z)};
  const HalfVectorChart<R> chart(o);
  const Vec2<R> x = chart.azimuth(o);
  const Between<R> thetas = theta_nodes(chart.theta_o), azimuths = azimuth_nodes(x);

  const int azimuth = int(chance(u_lobe, azimuths.fraction) ? azimuths.next : azimuths.node);
  const int theta = int(chance(u_lobe, thetas.fraction) ? thetas.next : thetas.node);
  const auto node_of = [&](int side) {
    return node_index(std::size_t(places[std::size_t(side)]), azimuth, theta);
  };
  int side = places[0] < 0 ? 1 : 0;
  if (places[0] >= 0 && places[1] >= 0)
    side = chance(u_lobe, R(cosine_[node_of(1)] + lobe_[node_of(1)])) ? 1 : 0;
  const std::size_t node = node_of(side);
  const R up = R((wo.z < 0) == (side == 1) ? 1 : -1);
  if (chance(u_lobe, R(cosine_[node] / (cosine_[node] + lobe_[node])))) {
    const Vec3<R> w = square_to_cosine_hemisphere(u);
    return {w.x, w.y, up * w.z};
  }

  // Index of the interval of a distribution function that holds x, and the fraction of the way through it.
  const auto invert = [](const float* cdf, int n, R at, int& index) {
    index = int(std::upper_bound(cdf, cdf + n - 1, at, [](R a, float b) { return a < b; }) - cdf);
    const R before = index > 0 ? cdf[index - 1] : 0, width = cdf[index] - before;
    return width > 0 ? clamp((at - before) / width, R(0), R(1)) : R(0.5);
  };
  const bool folded = n_.azimuths == 1;
  int i, j;
  const R along_theta = invert(&row_cdf_[node * n_.rows], n_.rows, u.x, i);
  const R y = !folded ? u.y : u.y < R(0.5) ? 2 * u.y : 2 * u.y - 1;
  const R along_v = invert(&cell_cdf_[(node * n_.rows + i) * n_.columns], n_.columns, y, j);

  const R theta_max = chart.theta_max();
  const R lower = theta_max * sqr(i / R(n_.rows)), upper = theta_max * sqr((i + 1) / R(n_.rows));
  const R versine = sqr(sin(lower / 2)) + half_versine_between(lower, upper) * along_theta;
  const R theta_h = 2 * asin(min(sqrt(versine), R(1))), phi_max = chart.phi_max(theta_h);
  R v = (j + along_v) / R(n_.columns);
  if (folded) {
    v = u.y < R(0.5) ? -v : v;
  } else {
    v = 2 * v - 1;
    const R delta = azimuths.fraction - R(azimuth == int(azimuths.node) ? 0 : 1);
    const auto [shift, round] = shift_of(R(delta * constant<R>(2 * pi / n_.azimuths)), phi_max);
    const R turned = v - shift, bent = (v - shift) / (v < shift ? 1 + shift : 1 - shift);
    v = round ? turned - 2 * floor((turned + 1) / 2) : bent;
  }
  const Vec3<R> h = spherical_direction(theta_h, v * phi_max);
  const Vec3<R> w = reflect(o, Vec3<R>{h.x * x.x - h.y * x.y, h.x * x.y + h.y * x.x, h.z});
  return {w.x, w.y, up * w.z};
}

template Vec3<float> DirectionSampling::sample(const Vec3<float>&, float, const Vec2<float>&) const;
template Vec3<double> DirectionSampling::sample(const Vec3<double>&, double, const Vec2<double>&) const;

} // namespace nacre

#include "measured/scattered_bsdf.h"

#include "core/error.h"
#include "core/parallel.h"
#include "measured/plane_mesh.h"
#include "measured/point_tree.h"
#include "measured/rusinkiewicz.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <unordered_map>

namespace nacre {
namespace {

/// Directions nearer than this, in radians, are one.
constexpr double same_direction = 1e-4;
/// Half vectors nearer than this, seen from above, are one sample.
constexpr double same_half_vector = 1e-6;
constexpr double least_margin = pi / 360;
constexpr double margin_of_edge = 0.15;
constexpr double longest_edge = 0.5;
constexpr std::size_t neighbours = 12, spacing_neighbour = 8;
constexpr double mean_samples_of_a_row = 4;

Vec3d wide(const Vec3f& w) { return {double(w.x), double(w.y), double(w.z)}; }
double polar_angle(const Vec3d& w) { return std::atan2(std::hypot(w.x, w.y), w.z); }
double azimuth(const Vec3d& w) { return w.x == 0 && w.y == 0 ? 0 : std::atan2(w.y, w.x); }
Vec3d turned(const Vec3d& w, double c, double s) { return {c * w.x - s * w.y, s * w.x + c * w.y, w.z}; }

/// Both directions in front.
struct Pair {
  Vec3d wo, wi;
};
Pair in_front(const Vec3d& wo, const Vec3d& wi) {
  return {{wo.x, wo.y, std::abs(wo.z)}, {wi.x, wi.y, std::abs(wi.z)}};
}
/// Turned about the normal so that wi has azimuth 0.
Pair turned_to_incidence(const Pair& p) {
  const double sin_i = std::hypot(p.wi.x, p.wi.y);
  if (!(sin_i > 0)) return p;
  const double c = p.wi.x / sin_i, s = -p.wi.y / sin_i;
  return {turned(p.wo, c, s), {sin_i, 0, p.wi.z}};
}

Vec2d half_vector_from_above(const Pair& p) {
  const Vec3d h = normalize(p.wo + p.wi);
  return {h.x, h.y};
}
Vec2d plane_of_incidences(const Vec3d& wi) {
  const double theta = polar_angle(wi), phi = azimuth(wi);
  return {theta * std::cos(phi), theta * std::sin(phi)};
}

/// Share that a value on or beyond a border keeps: 1 within the hull, falling to 0 at the margin. In a
/// triangle too large to say what lies in it, the samples themselves remain.
double kept(const PlaneMesh::Place& place) {
  if (place.edge > longest_edge) return std::max(0.0, 1 - place.nearest / least_margin);
  return std::max(0.0, 1 - place.outside / std::max(least_margin, margin_of_edge * place.edge));
}

/// Numbers that differ from their predecessor by at most the tolerance get the same label. Sorted by value.
/// Empty where labels lie so densely, or a chain of near numbers reaches so far, that they are spread rather
/// than repeated.
std::vector<std::uint32_t> labels_of(const std::vector<double>& x, double tolerance) {
  std::vector<std::uint32_t> order(x.size()), label(x.size());
  for (std::uint32_t i = 0; i < order.size(); ++i)
    order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return x[a] < x[b]; });
  std::uint32_t current = 0;
  double first = x[order[0]], last = first;
  for (const std::uint32_t i : order) {
    if (x[i] - last > tolerance) {
      ++current;
      first = x[i];
    }
    last = x[i];
    if (last - first > 10 * tolerance) return {};
    label[i] = current;
  }
  if (last - x[order[0]] < 20 * tolerance * current) return {};
  return label;
}

} // namespace

class ScatteredBsdf::Side {
public:
  Side(const MeasuredSamples& samples, const std::vector<std::uint32_t>& used, std::size_t channels,
       bool isotropic, bool bilateral)
      : channels_(channels), isotropic_(isotropic), bilateral_(bilateral) {
    std::vector<Pair> pairs;
    for (const std::uint32_t n : used) {
      Pair p = in_front(wide(samples.wo[n]), wide(samples.wi[n]));
      if (isotropic_) p = turned_to_incidence(p);
      pairs.push_back(p);
    }
    const auto value = [&](std::size_t n) { return &samples.f[std::size_t(used[n]) * channels_]; };
    if (const auto rows = rows_of(pairs); !rows.empty())
      make_rows(pairs, rows, value);
    else
      make_cloud(pairs, value);
  }

  std::size_t row_count() const { return rows_.size(); }

  bool evaluate(Pair p, std::span<float> f) const {
    if (isotropic_) p = turned_to_incidence(p);
    if (bilateral_) p.wo.y = std::abs(p.wo.y);
    return cloud_ ? in_cloud(p, f) : in_rows(p, f);
  }

private:
  struct Row {
    PlaneMesh mesh;
    std::vector<float> values; ///< a point's channels together
    bool around_normal;        ///< isotropic at normal incidence: a function of the half vector's length
  };

  /// The samples of each direction of incidence, or nothing where too few share theirs.
  std::vector<std::vector<std::uint32_t>> rows_of(const std::vector<Pair>& pairs) const {
    std::vector<double> theta, phi;
    for (const Pair& p : pairs) {
      theta.push_back(polar_angle(p.wi));
      // At theta small the azimuth says little; what counts is the distance on the sphere. The cut of the
      // azimuth is moved to where no instrument has a node.
      phi.push_back(std::sin(theta.back()) < same_direction ? 0
                    : azimuth(p.wi) < -3.14159              ? azimuth(p.wi) + 2 * pi
                                                            : azimuth(p.wi));
    }
    const auto label_theta = labels_of(theta, same_direction), label_phi = labels_of(phi, same_direction);
    if (label_theta.empty() || label_phi.empty()) return {};
    std::unordered_map<std::uint64_t, std::size_t> known;
    std::vector<std::vector<std::uint32_t>> rows;
    for (std::uint32_t n = 0; n < pairs.size(); ++n) {
      const auto [at, is_new] =
          known.emplace(std::uint64_t(label_theta[n]) << 32 | label_phi[n], rows.size());
      if (is_new) rows.emplace_back();
      rows[at->second].push_back(n);
    }
    if (double(pairs.size()) < mean_samples_of_a_row * double(rows.size())) return {};
    return rows;
  }

  template <class Value>
  void make_rows(const std::vector<Pair>& pairs, const std::vector<std::vector<std::uint32_t>>& rows,
                 Value value) {
    std::vector<Vec2d> incidences;
    for (const auto& row : rows) {
      incidences.push_back(plane_of_incidences(pairs[row[0]].wi));
      const bool around_normal = isotropic_ && polar_angle(pairs[row[0]].wi) < same_direction;
      std::vector<Vec2d> points;
      std::vector<float> values;
      std::vector<double> sums;
      std::vector<int> counts;
      std::unordered_map<std::uint64_t, std::uint32_t> known;
      const auto add = [&](const Vec2d& h, const float* f) {
        const auto cell = [](double x) {
          return std::uint32_t(std::int32_t(std::lround(x / same_half_vector)));
        };
        const auto [at, is_new] =
            known.emplace(std::uint64_t(cell(h.x)) << 32 | cell(h.y), std::uint32_t(points.size()));
        if (is_new) {
          points.push_back(h);
          sums.resize(sums.size() + channels_);
          counts.push_back(0);
        }
        ++counts[at->second];
        for (std::size_t c = 0; c < channels_; ++c)
          sums[at->second * channels_ + c] += double(f[c]);
      };
      for (const std::uint32_t n : row) {
        Vec2d h = half_vector_from_above(pairs[n]);
        if (around_normal) h = {std::hypot(h.x, h.y), 0};
        if (bilateral_) h.y = std::abs(h.y);
        if (bilateral_ && h.y < 2 * same_half_vector) h.y = 0;
        add(h, value(n));
        if (bilateral_ && h.y > 0) add({h.x, -h.y}, value(n));
      }
      for (std::size_t i = 0; i < sums.size(); ++i)
        values.push_back(float(sums[i] / counts[i / channels_]));
      rows_.push_back({PlaneMesh(points), std::move(values), around_normal});
    }
    incidences_ = std::make_unique<PlaneMesh>(incidences);
  }

  bool in_rows(const Pair& p, std::span<float> f) const {
    PlaneMesh::Place incidence = incidences_->locate(plane_of_incidences(p.wi));
    incidence.edge = std::min(incidence.edge, longest_edge); // incidences may be as far apart as they are
    if (!(kept(incidence) > 0)) return false;
    const Vec2d h = half_vector_from_above(p);
    std::array<double, Channels::max_count> sum;
    std::fill_n(sum.begin(), channels_, 0.0);
    double total = 0;
    for (int k = 0; k < 3; ++k) {
      if (!(incidence.weight[k] > 0)) continue;
      const Row& row = rows_[incidence.point[k]];
      const PlaneMesh::Place place = row.mesh.locate(row.around_normal ? Vec2d{std::hypot(h.x, h.y), 0} : h);
      const double w = incidence.weight[k] * kept(place);
      if (!(w > 0)) continue;
      total += w;
      for (int corner = 0; corner < 3; ++corner)
        for (std::size_t c = 0; c < channels_; ++c)
          sum[c] += w * place.weight[corner] * double(row.values[place.point[corner] * channels_ + c]);
    }
    if (!(total > 0)) return false;
    for (std::size_t c = 0; c < channels_; ++c)
      f[c] = float(sum[c] / total);
    return true;
  }

  PointTree<4>::Point cloud_point(const Pair& p) const {
    const HalfDifference<double> a = half_difference(p.wo, p.wi);
    const Vec3d h = p.wo + p.wi;
    const double r = std::sqrt(a.theta_h * pi / 2), phi = isotropic_ ? 0 : azimuth(h);
    return {float(r * std::cos(phi)), float(r * std::sin(phi)), float(a.theta_d * std::cos(a.phi_d)),
            float(bilateral_ ? std::abs(a.theta_d * std::sin(a.phi_d)) : a.theta_d * std::sin(a.phi_d))};
  }

  template <class Value>
  void make_cloud(const std::vector<Pair>& pairs, Value value) {
    std::vector<PointTree<4>::Point> points;
    for (std::size_t n = 0; n < pairs.size(); ++n) {
      points.push_back(cloud_point(pairs[n]));
      cloud_values_.insert(cloud_values_.end(), value(n), value(n) + channels_);
    }
    cloud_ = std::make_unique<PointTree<4>>(points);
    spacing_.resize(points.size());
    constexpr std::size_t block = 1024;
    parallel_for((points.size() + block - 1) / block, [&](std::size_t b) {
      std::vector<PointTree<4>::Near> near;
      for (std::size_t n = b * block; n < std::min(points.size(), (b + 1) * block); ++n) {
        cloud_->nearest(points[n], spacing_neighbour + 1, near);
        spacing_[n] = float(near.back().squared);
      }
    });
  }

  bool in_cloud(const Pair& p, std::span<float> f) const {
    std::vector<PointTree<4>::Near> near;
    cloud_->nearest(cloud_point(p), neighbours + 1, near);
    constexpr double at_sample = 1e-6 * 1e-6; // floats
    if (near[0].squared > std::max(double(spacing_[near[0].point]), at_sample)) return false;
    const bool exact = near[0].squared <= at_sample;
    // With fewer samples than neighbours none comes or goes, and all count.
    const double reach =
        near.size() > neighbours ? std::sqrt(near.back().squared) : 2 * std::sqrt(near.back().squared) + 1e-6;
    std::array<double, Channels::max_count> sum;
    std::fill_n(sum.begin(), channels_, 0.0);
    double total = 0;
    for (const auto& n : near) {
      const double r = std::sqrt(n.squared);
      const double w = exact ? double(n.squared <= at_sample) : sqr((reach - r) / (reach * r));
      total += w;
      for (std::size_t c = 0; c < channels_; ++c)
        sum[c] += w * double(cloud_values_[n.point * channels_ + c]);
    }
    // All at the same distance.
    if (!(total > 0)) {
      for (const auto& n : near)
        for (std::size_t c = 0; c < channels_; ++c)
          sum[c] += double(cloud_values_[n.point * channels_ + c]);
      total = double(near.size());
    }
    for (std::size_t c = 0; c < channels_; ++c)
      f[c] = float(sum[c] / total);
    return true;
  }

  std::size_t channels_;
  bool isotropic_, bilateral_;
  std::unique_ptr<PlaneMesh> incidences_;
  std::vector<Row> rows_;
  std::unique_ptr<PointTree<4>> cloud_;
  std::vector<float> cloud_values_, spacing_; ///< spacing squared
};

ScatteredBsdf::~ScatteredBsdf() = default;

ScatteredBsdf::ScatteredBsdf(MeasuredSamples samples, Channels channels, Symmetry symmetry, std::string kind,
                             std::vector<std::pair<std::string, std::string>> facts)
    : samples_(std::move(samples)), channels_(std::move(channels)), kind_(std::move(kind)),
      facts_(std::move(facts)) {
  const std::size_t n = samples_.size(), count = std::size_t(channels_.count());
  if (n == 0) throw Error("a list of samples is empty");
  if (n > std::size_t(1) << 28) throw Error(fmt::format("{} samples, more than can be read", n));
  if (samples_.wi.size() != n || samples_.f.size() != n * count)
    throw Error(fmt::format("{} samples of {} channels need {} values, found {}", n, count, n * count,
                            samples_.f.size()));
  samples_.weight.assign(n, 1.0);
  for (const float x : samples_.f)
    if (!std::isfinite(x)) throw Error("a sample's value is not finite");
  std::array<std::vector<std::uint32_t>, 4> used;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d wo = wide(samples_.wo[i]), wi = wide(samples_.wi[i]);
    if (!(std::abs(length(wo) - 1) < 1e-3 && std::abs(length(wi) - 1) < 1e-3 && wo.z != 0 && wi.z != 0))
      throw Error(fmt::format("sample {} has a direction in the surface, or of no unit length", i));
    used[(wo.z < 0 ? 1 : 0) + (wi.z < 0 ? 2 : 0)].push_back(std::uint32_t(i));
  }
  isotropic_ = symmetry == Symmetry::isotropic || symmetry == Symmetry::bilateral;
  bilateral_ = symmetry == Symmetry::bilateral;
  if (symmetry == Symmetry::found) {
    const Vec3d* first = nullptr;
    Vec3d incidence;
    isotropic_ = true;
    bool left = true, right = true;
    for (std::size_t i = 0; i < n; ++i) {
      const Pair p = in_front(wide(samples_.wo[i]), wide(samples_.wi[i]));
      if (std::hypot(p.wi.x, p.wi.y) < same_direction) continue;
      if (!first) {
        incidence = p.wi;
        first = &incidence;
      }
      const double off = azimuth(p.wi) - azimuth(*first);
      isotropic_ =
          isotropic_ && std::abs(std::remainder(off, 2 * pi)) * std::hypot(p.wi.x, p.wi.y) < same_direction;
      const double y = turned_to_incidence(p).wo.y;
      left = left && y > -same_direction;
      right = right && y < same_direction;
    }
    bilateral_ = isotropic_ && (left || right);
  }
  sides_.reflects_front = !used[0].empty();
  sides_.transmits_to_back = !used[1].empty();
  sides_.transmits_to_front = !used[2].empty();
  sides_.reflects_back = !used[3].empty();
  for (std::size_t s = 0; s < 4; ++s)
    if (!used[s].empty())
      side_[s] = std::make_unique<const Side>(samples_, used[s], count, isotropic_, bilateral_);
}

std::vector<std::pair<std::string, std::string>> ScatteredBsdf::facts() const {
  std::vector<std::pair<std::string, std::string>> all{
      {"samples", fmt::format("{}", samples_.size())},
      {"symmetry", bilateral_   ? "isotropic, mirrored at the plane of incidence"
                   : isotropic_ ? "isotropic"
                                : "none"},
  };
  for (std::size_t s = 0; s < 4; ++s)
    if (side_[s])
      all.emplace_back(
          fmt::format("{}, light {}", s == 0 || s == 3 ? "reflection" : "transmission",
                      s < 2 ? "in front" : "behind"),
          side_[s]->row_count() > 0
              ? fmt::format("meshes of half vectors for {} directions of incidence", side_[s]->row_count())
              : "a cloud in half and difference angles, nearest samples mixed");
  all.insert(all.end(), facts_.begin(), facts_.end());
  return all;
}

bool ScatteredBsdf::evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const {
  std::fill_n(f.begin(), channels_.count(), 0.0f);
  if (!sides_.contain(wo, wi)) return false;
  return side_[(wo.z < 0 ? 1 : 0) + (wi.z < 0 ? 2 : 0)]->evaluate(in_front(wo, wi), f);
}

} // namespace nacre

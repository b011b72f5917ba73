#include "measured/formats/kaist_pbsdf.h"

#include "core/error.h"
#include "measured/rusinkiewicz.h"
#include "measured/tensor_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <functional>

namespace nacre {
namespace {

constexpr double slack = 1e-4; ///< angles are float32
/// Nodes of an axis of the database.
constexpr std::size_t full_phi_d = 361, full_theta = 91;

bool ascends(const std::vector<double>& x, double low, double high) {
  return !x.empty() && x.front() >= low - slack && x.back() <= high + slack &&
         std::adjacent_find(x.begin(), x.end(), std::greater_equal<>()) == x.end();
}

struct Place {
  std::size_t low, high;
  double fraction;
};
Place place(const std::vector<double>& nodes, double x) {
  if (nodes.size() < 2 || !(x > nodes.front())) return {0, 0, 0};
  if (x >= nodes.back()) return {nodes.size() - 1, nodes.size() - 1, 0};
  const auto i = std::size_t(std::upper_bound(nodes.begin(), nodes.end(), x) - nodes.begin()) - 1;
  return {i, i + 1, (x - nodes[i]) / (nodes[i + 1] - nodes[i])};
}
Place place_on_circle(const std::vector<double>& nodes, double x) {
  const double gap = nodes.front() + 2 * pi - nodes.back();
  double beyond = x - nodes.back();
  if (x < nodes.front()) beyond += 2 * pi;
  if (x >= nodes.front() && x <= nodes.back()) return place(nodes, x);
  return {nodes.size() - 1, 0, gap > 0 ? std::clamp(beyond / gap, 0.0, 1.0) : 0};
}

/// Halfway to the neighbours, within [low, high].
std::pair<double, double> faces(const std::vector<double>& nodes, std::size_t i, double low, double high) {
  return {i > 0 ? 0.5 * (nodes[i - 1] + nodes[i]) : low,
          i + 1 < nodes.size() ? 0.5 * (nodes[i] + nodes[i + 1]) : high};
}

void check(bool holds, const char* what) {
  if (!holds) throw Error(fmt::format("polarimetric table: {}", what));
}

} // namespace

KaistPbsdf::KaistPbsdf(MuellerTable table)
    : table_(std::move(table)), channels_(Channels::spectral(table_.wavelengths_nm)) {
  check(ascends(table_.phi_d, -pi, pi), "phi_d ascends within [-pi, pi]");
  check(ascends(table_.theta_d, 0, pi / 2), "theta_d ascends within [0, pi/2]");
  check(ascends(table_.theta_h, 0, pi / 2), "theta_h ascends within [0, pi/2]");
  const std::size_t count = table_.phi_d.size() * table_.theta_d.size() * table_.theta_h.size();
  const std::size_t n = std::size_t(channels_.count());
  check(table_.entries.size() == count * n * 16, "sizes agree");
  known_.resize(count);
  intensity_.resize(count * n);
  for (std::size_t i = 0; i < count; ++i) {
    const float* node = &table_.entries[i * n * 16];
    bool dark = true, known = true;
    for (std::size_t c = 0; c < n; ++c) {
      intensity_[i * n + c] = node[16 * c];
      dark &= node[16 * c] == 0;
      known &= !std::isnan(node[16 * c]);
    }
    known_[i] = known && !dark;
    holes_ += !known_[i];
    if (known_[i])
      check(std::all_of(node, node + n * 16, [](float x) { return std::isfinite(x); }),
            "a matrix of known intensity has finite entries");
  }
}

std::vector<std::pair<std::string, std::string>> KaistPbsdf::facts() const {
  std::vector<std::pair<std::string, std::string>> facts{
      {"resolution", fmt::format("phi_d {}, theta_d {}, theta_h {}", table_.phi_d.size(),
                                 table_.theta_d.size(), table_.theta_h.size())},
      {"wavelengths", fmt::format("{} from {} to {} nm", channels_.count(), table_.wavelengths_nm.front(),
                                  table_.wavelengths_nm.back())},
      {"polarisation", "a Mueller matrix a node; the value shown is for unpolarised light"}};
  if (table_.axes_assumed)
    facts.emplace_back("axes", "not in the file; assumed to be every so many of the database's nodes");
  return facts;
}

KaistPbsdf::Nodes KaistPbsdf::nodes(const Vec3d& wo, const Vec3d& wi) const {
  Nodes nodes;
  if (!(wo.z > 0 && wi.z > 0)) return nodes;
  const auto a = half_difference(wo, wi);
  const Place p = place_on_circle(table_.phi_d, a.phi_d), d = place(table_.theta_d, a.theta_d),
              h = place(table_.theta_h, a.theta_h);
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const bool up = corner & 1, ud = corner & 2, uh = corner & 4;
    const double w = (up ? p.fraction : 1 - p.fraction) * (ud ? d.fraction : 1 - d.fraction) *
                     (uh ? h.fraction : 1 - h.fraction);
    const std::size_t i =
        ((up ? p.high : p.low) * table_.theta_d.size() + (ud ? d.high : d.low)) * table_.theta_h.size() +
        (uh ? h.high : h.low);
    if (!(w > 0) || !known_[i]) continue;
    nodes.index[nodes.count] = i;
    nodes.weight[nodes.count++] = w;
    sum += w;
  }
  for (std::size_t k = 0; k < nodes.count; ++k)
    nodes.weight[k] /= sum;
  return nodes;
}

bool KaistPbsdf::evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const {
  std::fill(f.begin(), f.end(), 0.0f);
  const Nodes at = nodes(wo, wi);
  for (std::size_t k = 0; k < at.count; ++k) {
    const float* node = &intensity_[at.index[k] * f.size()];
    for (std::size_t c = 0; c < f.size(); ++c)
      f[c] += float(at.weight[k]) * node[c];
  }
  for (float& x : f)
    x = std::max(x, 0.0f);
  return at.count > 0;
}

std::optional<Mueller<double>> KaistPbsdf::mueller(const Vec3d& wo, const Vec3d& wi,
                                                   double wavelength_nm) const {
  const Nodes at = nodes(wo, wi);
  if (at.count == 0) return std::nullopt;
  const Place w = place(table_.wavelengths_nm, wavelength_nm);
  Mueller<double> m;
  for (std::size_t k = 0; k < at.count; ++k) {
    const float* node = &table_.entries[at.index[k] * std::size_t(channels_.count()) * 16];
    for (std::size_t e = 0; e < 16; ++e)
      m.rows[e / 4][e % 4] += at.weight[k] * ((1 - w.fraction) * double(node[16 * w.low + e]) +
                                              w.fraction * double(node[16 * w.high + e]));
  }
  m.rows[0][0] = std::max(m.rows[0][0], 0.0);
  return m;
}

MeasuredSamples KaistPbsdf::samples() const {
  MeasuredSamples s;
  const auto &phi_d = table_.phi_d, &theta_d = table_.theta_d, &theta_h = table_.theta_h;
  const std::size_t n = table_.wavelengths_nm.size();
  std::size_t i = 0;
  for (std::size_t p = 0; p < phi_d.size(); ++p) {
    // A turn is shared out; nodes at -pi and pi share theirs.
    const double before = p > 0 ? phi_d[p - 1] : phi_d.back() - 2 * pi;
    const double after = p + 1 < phi_d.size() ? phi_d[p + 1] : phi_d.front() + 2 * pi;
    for (std::size_t d = 0; d < theta_d.size(); ++d) {
      const auto [d0, d1] = faces(theta_d, d, 0, pi / 2);
      for (std::size_t h = 0; h < theta_h.size(); ++h, ++i) {
        const HalfDifference<double> a{theta_h[h], theta_d[d], phi_d[p]};
        const auto [wo, wi] = directions(a);
        if (!known_[i] || !(wo.z > 0 && wi.z > 0)) continue;
        const auto [h0, h1] = faces(theta_h, h, 0, pi / 2);
        s.wo.push_back(Vec3f{float(wo.x), float(wo.y), float(wo.z)});
        s.wi.push_back(Vec3f{float(wi.x), float(wi.y), float(wi.z)});
        for (std::size_t c = 0; c < n; ++c)
          s.f.push_back(std::max(intensity_[i * n + c], 0.0f));
        // dwo dwi = 4 cos(theta_d) dwh dwd (Rusinkiewicz 1998).
        s.weight.push_back(0.5 * (after - before) * (std::cos(h0) - std::cos(h1)) *
                           (sqr(std::sin(d1)) - sqr(std::sin(d0))));
      }
    }
  }
  return s;
}

namespace {

/// An axis of `size` nodes in [low, high]; if the file leaves it empty, every s-th of `full` nodes node(i).
std::vector<double> read_axis(const TensorFile& file, std::string_view name, std::size_t size, double low,
                              double high, std::size_t full, double (*node)(double), bool& assumed) {
  const std::vector<float> values = file.floats(name, 2);
  const Tensor& f = *file.find(name);
  if (f.shape[1] != size || f.shape[0] > 1)
    file.fail(f, fmt::format("expected 1 x {}, as M has it, found {}", size, to_text(f.shape)));
  std::vector<double> axis(values.begin(), values.end());
  if (axis.empty()) {
    std::size_t step = 1;
    while (step < full && (full + step - 1) / step > size)
      ++step;
    if (size == 0 || (full + step - 1) / step != size)
      file.fail(
          f, fmt::format("has no numbers, and {} nodes are no even part of the database's {}", size, full));
    for (std::size_t i = 0; i < size; ++i)
      axis.push_back(node(double(i * step)));
    assumed = true;
  }
  if (!ascends(axis, low, high))
    file.fail(f, fmt::format("expected angles that increase within [{}, {}]", low, high));
  return axis;
}

double degree(double i) { return i * pi / 180; }
double degree_from_minus_half_turn(double i) { return (i - 180) * pi / 180; }
double squared_degree(double i) { return i * i / 90 * pi / 180; }

} // namespace

KaistPbsdf parse_kaist(std::span<const std::uint8_t> bytes, std::string_view name) {
  const TensorFile file = TensorFile::parse(bytes, name);
  MuellerTable t;
  const Tensor& wavelengths = file.field("wvls", TensorType::uint16, 1);
  for (std::size_t i = 0; i < wavelengths.bytes.size(); i += 2) {
    std::uint16_t nm;
    std::memcpy(&nm, &wavelengths.bytes[i], sizeof nm);
    t.wavelengths_nm.push_back(nm);
  }
  try {
    Channels::spectral(t.wavelengths_nm);
  } catch (const Error& e) {
    file.fail(wavelengths, e.what());
  }
  const Tensor& m = file.field("M", TensorType::float32, 6);
  if (m.shape[3] != t.wavelengths_nm.size() || m.shape[4] != 4 || m.shape[5] != 4 || m.bytes.empty())
    file.fail(m, fmt::format("expected phi_d x theta_d x theta_h x {} x 4 x 4, found {}",
                             t.wavelengths_nm.size(), to_text(m.shape)));
  t.phi_d =
      read_axis(file, "phi_d", m.shape[0], -pi, pi, full_phi_d, degree_from_minus_half_turn, t.axes_assumed);
  t.theta_d = read_axis(file, "theta_d", m.shape[1], 0, pi / 2, full_theta, degree, t.axes_assumed);
  t.theta_h = read_axis(file, "theta_h", m.shape[2], 0, pi / 2, full_theta, squared_degree, t.axes_assumed);
  t.entries = file.floats("M", 6, true);
  for (const float x : t.entries)
    if (std::abs(x) > 1e30f) file.fail(m, fmt::format("holds {}, expected at most 1e30", x));
  try {
    return KaistPbsdf(std::move(t));
  } catch (const Error& e) {
    file.fail(m, e.what());
  }
}

} // namespace nacre

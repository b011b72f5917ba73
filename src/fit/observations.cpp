#include "fit/observations.h"

#include "core/error.h"

#include <fmt/format.h>

namespace nacre {
namespace {

/// Index positions of the faces around node `i` of an axis of `n` nodes of which every `step`-th is kept.
std::pair<double, double> faces(int i, int step, int n) {
  return {std::max(0.0, i - 0.5 * step), i + step < n ? i + 0.5 * step : double(n)};
}

double weight_theta_h(const MerlTable& table, int i, int step) {
  const auto [lo, hi] = faces(i, step, table.n_theta_h());
  const auto cos_at = [&](double x) { return std::cos(pi / 2 * sqr(x / table.n_theta_h())); };
  return cos_at(lo) - cos_at(hi);
}

double weight_theta_d(const MerlTable& table, int j, int step) {
  const auto [lo, hi] = faces(j, step, table.n_theta_d());
  const auto sin2_at = [&](double x) { return sqr(std::sin(pi / 2 * x / table.n_theta_d())); };
  return sin2_at(hi) - sin2_at(lo);
}

void check(const NodeSelection& s) {
  if (s.theta_h_step < 1 || s.theta_d_step < 1 || s.phi_d_step < 1)
    throw Error(fmt::format("steps between the nodes of a fit are at least 1, found {}, {}, {}",
                            s.theta_h_step, s.theta_d_step, s.phi_d_step));
  if (!(s.max_theta_deg > 0 && s.max_theta_deg <= 90))
    throw Error(fmt::format("the cut at grazing angles lies in (0, 90] degrees, found {}", s.max_theta_deg));
}

void append(Observations& o, const MerlTable& table, const NodeSelection& s, int i) {
  const double cos_cut = s.max_theta_deg < 90 ? std::cos(s.max_theta_deg * pi / 180) : 0;
  const double weight_h = weight_theta_h(table, i, s.theta_h_step);
  for (int j = 0; j < table.n_theta_d(); j += s.theta_d_step) {
    const double weight = weight_h * weight_theta_d(table, j, s.theta_d_step);
    for (int k = 0; k < table.n_phi_d(); k += s.phi_d_step) {
      if (table.is_hole(i, j, k)) continue;
      const auto [wo, wi] = directions(table.node(i, j, k));
      if (!(wo.z > cos_cut && wi.z > cos_cut)) continue;
      // The golden angle: neighbours in the list are turned far apart, all together evenly.
      const double turn = s.turned ? pi * (3 - std::sqrt(5.0)) * double(o.count) : 0;
      const double c = std::cos(turn), t = std::sin(turn);
      const auto push = [&](std::array<std::vector<float>, 3>& to, const Vec3d& w) {
        to[0].push_back(float(c * w.x - t * w.y));
        to[1].push_back(float(t * w.x + c * w.y));
        to[2].push_back(float(w.z));
      };
      push(o.wo, wo);
      push(o.wi, wi);
      for (int channel = 0; channel < 3; ++channel)
        o.f[channel].push_back(table.cell(i, j, k)[channel]);
      o.weight.push_back(weight);
      ++o.count;
    }
  }
}

void pad(Observations& o) {
  if (o.count == 0) return;
  const std::size_t padded = (o.count + pack_width - 1) / pack_width * pack_width;
  for (auto* arrays : {&o.wo, &o.wi, &o.f})
    for (auto& a : *arrays) {
      const float last = a.back();
      a.resize(padded, last);
    }
}

} // namespace

Observations observe(const MerlTable& table, const NodeSelection& selection) {
  check(selection);
  Observations o;
  for (int i = 0; i < table.n_theta_h(); i += selection.theta_h_step)
    append(o, table, selection, i);
  pad(o);
  return o;
}

Observations observe_slice(const MerlTable& table, const NodeSelection& selection, int theta_h_index) {
  check(selection);
  Observations o;
  append(o, table, selection, theta_h_index);
  pad(o);
  return o;
}

} // namespace nacre

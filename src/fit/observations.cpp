#include "fit/observations.h"

#include "core/error.h"
#include "core/parallel.h"
#include "measured/merl_table.h"

#include <fmt/format.h>

namespace nacre {
namespace {

void check(const NodeSelection& s) {
  if (s.theta_h_step < 1 || s.theta_d_step < 1 || s.phi_d_step < 1 || s.sample_step < 1)
    throw Error(fmt::format("steps between the nodes of a fit are at least 1, found {}, {}, {}",
                            s.theta_h_step, s.theta_d_step, s.phi_d_step));
  if (!(s.max_theta_deg > 0 && s.max_theta_deg <= 90))
    throw Error(fmt::format("the cut at grazing angles lies in (0, 90] degrees, found {}", s.max_theta_deg));
}

double cosine_of_cut(const NodeSelection& s) {
  return s.max_theta_deg < 90 ? std::cos(s.max_theta_deg * pi / 180) : 0;
}

void append(Observations& o, const MerlTable& table, const NodeSelection& s, int i) {
  const double cos_cut = cosine_of_cut(s);
  for (int j = 0; j < table.n_theta_d(); j += s.theta_d_step) {
    const double weight = table.node_weight(i, j, s.theta_h_step, s.theta_d_step);
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

/// Samples `begin` to `end`, of which every `sample_step`-th.
void append(Observations& o, const Channels& channels, const MeasuredSamples& samples, const NodeSelection& s,
            std::size_t begin, std::size_t end) {
  const double cos_cut = cosine_of_cut(s);
  const std::size_t step = std::size_t(s.sample_step), n = std::size_t(channels.count());
  for (std::size_t i = (begin + step - 1) / step * step; i < end; i += step) {
    const Vec3f &wo = samples.wo[i], &wi = samples.wi[i];
    if (!(double(wo.z) > cos_cut && double(wi.z) > cos_cut)) continue;
    const auto rgb = channels.to_rgb(std::span(samples.f).subspan(i * n, n));
    const std::array<float, 3> o_at{wo.x, wo.y, wo.z}, i_at{wi.x, wi.y, wi.z};
    for (std::size_t k = 0; k < 3; ++k) {
      o.wo[k].push_back(o_at[k]);
      o.wi[k].push_back(i_at[k]);
      o.f[k].push_back(float(std::max(rgb[k], 0.0)));
    }
    o.weight.push_back(samples.weight[i]);
    ++o.count;
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

void append(Observations& to, const Observations& from) {
  for (const auto& [a, b] :
       {std::pair{&to.wo, &from.wo}, std::pair{&to.wi, &from.wi}, std::pair{&to.f, &from.f}})
    for (std::size_t k = 0; k < 3; ++k)
      (*a)[k].insert((*a)[k].end(), (*b)[k].begin(), (*b)[k].end());
  to.weight.insert(to.weight.end(), from.weight.begin(), from.weight.end());
  to.count += from.count;
}

} // namespace

Observations observe(const MeasuredBsdf& measured, const NodeSelection& selection) {
  check(selection);
  std::vector<Observations> parts;
  if (const auto* table = dynamic_cast<const MerlTable*>(&measured)) {
    const std::size_t step = std::size_t(selection.theta_h_step);
    parts.resize((std::size_t(table->n_theta_h()) + step - 1) / step);
    parallel_for(parts.size(), [&](std::size_t i) { append(parts[i], *table, selection, int(i * step)); });
  } else {
    constexpr std::size_t part_size = 16384;
    const MeasuredSamples samples = measured.samples();
    parts.resize((samples.size() + part_size - 1) / part_size);
    parallel_for(parts.size(), [&](std::size_t i) {
      append(parts[i], measured.channels(), samples, selection, i * part_size,
             std::min((i + 1) * part_size, samples.size()));
    });
  }
  Observations all;
  std::size_t count = 0;
  for (const Observations& part : parts)
    count += part.count;
  for (auto* arrays : {&all.wo, &all.wi, &all.f})
    for (auto& a : *arrays)
      a.reserve(count + pack_width);
  all.weight.reserve(count);
  for (Observations& part : parts) {
    append(all, part);
    part = {};
  }
  pad(all);
  return all;
}

} // namespace nacre

#include "fit/metric.h"

#include "core/error.h"
#include "fit/observations.h"

#include <array>
#include <fmt/format.h>
#include <vector>

namespace nacre {
namespace {
const std::vector<std::string> names{"cosine", "log"};
}

std::string_view metric_name(Metric metric) { return names[std::size_t(metric)]; }

Metric parse_metric(std::string_view name) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return Metric(i);
  throw Error(fmt::format("unknown metric '{}'{}", name, suggestion(name, names)));
}

MetricErrors metric_errors(const MeasuredBsdf& measured, const MaterialSpec& material, double max_theta_deg) {
  const Bsdf<Pack, 3> bsdf = make_bsdf<Pack>(material);
  const Vec3<Pack> up{Pack(0.0f), Pack(0.0f), Pack(1.0f)};
  (void)bsdf.eval(up, up); // tables that a model builds on first use are built outside the parallel loop

  struct Sum {
    double cosine = 0, log = 0, weight = 0;
    std::size_t nodes = 0;
  };
  std::vector<Sum> slices;
  const auto sum_up = [&](std::size_t slice, const Observations& o) {
    Sum& sum = slices[slice];
    sum.nodes = o.count;
    std::array<float, pack_width> f;
    for (std::size_t begin = 0; begin < o.count; begin += pack_width) {
      const auto at = [&](const std::array<std::vector<float>, 3>& w) {
        return Vec3<Pack>{load(&w[0][begin]), load(&w[1][begin]), load(&w[2][begin])};
      };
      const Spectrum<Pack, 3> model = bsdf.eval(at(o.wo), at(o.wi));
      for (int channel = 0; channel < 3; ++channel) {
        store(f.data(), model[channel]);
        for (std::size_t n = begin; n < std::min(begin + pack_width, o.count); ++n) {
          const double cos_i = o.wi[2][n], x = f[n - begin] * cos_i, y = o.f[channel][n] * cos_i;
          const double weight = o.weight[n];
          sum.cosine += weight * sqr(x - y);
          sum.log += weight * sqr(std::log1p(x) - std::log1p(y));
          sum.weight += weight;
        }
      }
    }
  };
  observe_in_parts(
      measured, {.max_theta_deg = max_theta_deg}, [&](std::size_t parts) { slices.resize(parts); }, sum_up);
  Sum total;
  for (const Sum& s : slices) { // in order: the same for any number of threads
    total.cosine += s.cosine;
    total.log += s.log;
    total.weight += s.weight;
    total.nodes += s.nodes;
  }
  if (total.nodes == 0)
    throw Error(fmt::format("nothing was measured with both angles below {} degrees", max_theta_deg));
  return {std::sqrt(total.cosine / total.weight), std::sqrt(total.log / total.weight), total.nodes};
}

} // namespace nacre

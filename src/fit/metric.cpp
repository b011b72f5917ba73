#include "fit/metric.h"

#include "core/error.h"
#include "core/parallel.h"
#include "fit/observations.h"

#include <fmt/format.h>
#include <vector>

namespace nacre {
namespace {

const std::vector<std::string> names{"cosine", "log", "cube_root", "relative"};
constexpr std::size_t count = all_metrics.size();

struct Sum {
  std::array<double, count> squares{};
  double weight = 0;
};

/// @param begin  a multiple of pack_width
Sum sum_up(const Bsdf<Pack, 3>& bsdf, const Observations& o, std::size_t begin, std::size_t end) {
  Sum sum;
  std::array<float, pack_width> square;
  for (; begin < end; begin += pack_width) {
    const auto at = [&](const std::array<std::vector<float>, 3>& w) {
      return Vec3<Pack>{load(&w[0][begin]), load(&w[1][begin]), load(&w[2][begin])};
    };
    const Vec3<Pack> wi = at(o.wi);
    const Spectrum<Pack, 3> model = bsdf.eval(at(o.wo), wi);
    const std::size_t n = std::min(pack_width, end - begin);
    std::array<std::array<double, pack_width>, count> squares{};
    for (int channel = 0; channel < 3; ++channel) {
      const Pack x = model[channel] * wi.z, y = load(&o.f[channel][begin]) * wi.z;
      for (std::size_t m = 0; m < count; ++m) {
        store(square.data(), sqr(metric_error(all_metrics[m], x, y)));
        for (std::size_t i = 0; i < n; ++i)
          squares[m][i] += double(square[i]);
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      const double w = o.weight[begin + i];
      for (std::size_t m = 0; m < count; ++m)
        sum.squares[m] += w * squares[m][i];
      sum.weight += 3 * w;
    }
  }
  return sum;
}

} // namespace

std::string_view metric_name(Metric metric) { return names[std::size_t(metric)]; }

Metric parse_metric(std::string_view name) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return Metric(i);
  throw Error(fmt::format("unknown metric '{}'{}", name, suggestion(name, names)));
}

MetricErrors metric_errors(const Observations& nodes, const MaterialSpec& material) {
  if (nodes.count == 0) throw Error("there is no measured value to compare with");
  const Bsdf<Pack, 3> bsdf = make_bsdf<Pack>(material);
  const Vec3<Pack> up{Pack(0.0f), Pack(0.0f), Pack(1.0f)};
  (void)bsdf.eval(up, up); // tables that a model builds on first use are built outside the parallel loop
  constexpr std::size_t part = 16384;
  std::vector<Sum> parts((nodes.count + part - 1) / part);
  parallel_for(parts.size(), [&](std::size_t i) {
    parts[i] = sum_up(bsdf, nodes, i * part, std::min((i + 1) * part, nodes.count));
  });
  Sum total;
  for (const Sum& s : parts) { // in order: the same for any number of threads
    for (std::size_t m = 0; m < count; ++m)
      total.squares[m] += s.squares[m];
    total.weight += s.weight;
  }
  const auto root = [&](Metric m) { return std::sqrt(total.squares[std::size_t(m)] / total.weight); };
  return {root(Metric::cosine), root(Metric::log), root(Metric::cube_root), root(Metric::relative),
          nodes.count};
}

MetricErrors metric_errors(const MeasuredBsdf& measured, const MaterialSpec& material, double max_theta_deg) {
  const Observations nodes = observe(measured, {.max_theta_deg = max_theta_deg});
  if (nodes.count == 0)
    throw Error(fmt::format("nothing was measured with both angles below {} degrees", max_theta_deg));
  return metric_errors(nodes, material);
}

} // namespace nacre

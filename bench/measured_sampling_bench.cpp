// How noisily measured materials are rendered, against the analytic model that fits them best: relative
// variance of f cos / pdf, each by its own samples. One line a material: the MERL files that are there, then
// the tables of published fits.
//
//   nacre_bench --benchmark_filter=measured_sampling
//
// Counters: means over wo weighted by cos theta_o of the table's variance, the model's, and their ratio; then
// the ratio at each angle; "worst" is the largest of them. The label names the model.

#include "core/random.h"
#include "core/statistics.h"
#include "fit/fit.h"
#include "measured/merl_brdf.h"
#include "measured/published_fits.h"

#include <benchmark/benchmark.h>
#include <filesystem>
#include <fmt/format.h>

namespace nacre {
namespace {

constexpr std::array angles_deg{0, 15, 30, 45, 60, 75, 85};
/// What a person would try first, one lobe and two.
constexpr std::array candidates{"ggx_schlick",           "low_microfacet",
                                "ggx_schlick+lambert",   "low_microfacet+lambert",
                                "cook_torrance+lambert", "ashikhmin_shirley"};

double luminance(const Spectrum<double, 3>& f) { return 0.2126 * f[0] + 0.7152 * f[1] + 0.0722 * f[2]; }

double relative_variance(const Bsdf<double, 3>& bsdf, double theta) {
  const Vec3d wo = spherical_direction(theta, 0.4);
  RunningMoments weight;
  for (std::uint64_t i = 0; i < 40000; ++i) {
    const auto u = [&](std::uint64_t d) { return double(uniform(7, i, 0, d)); };
    const auto s = bsdf.sample(wo, u(0), {u(1), u(2)});
    weight.add(s.pdf > 0 ? luminance(s.f) * s.wi.z / s.pdf : 0);
  }
  return weight.mean() > 0 ? weight.variance() / sqr(weight.mean()) : 0;
}

void compare(benchmark::State& state, const std::shared_ptr<const MerlTable>& table) {
  LobeSpec lobe;
  lobe.measured = table;
  const auto measured = make_bsdf<double>(MaterialSpec{"table", {lobe}});
  for (auto _ : state) {
    MaterialSpec best;
    double error = std::numeric_limits<double>::infinity();
    for (const char* model : candidates) {
      const FitResult result =
          fit(*table, {.model = model, .starts = 4, .refined = 1, .theta_d_step = 6, .phi_d_step = 15});
      if (result.errors.log < error) error = result.errors.log, best = result.material;
    }
    const auto model = make_bsdf<double>(best);
    double of_table = 0, of_model = 0, weights = 0, worst = 0;
    for (const int degrees : angles_deg) {
      const double theta = degrees * pi / 180, t = relative_variance(measured, theta),
                   m = relative_variance(model, theta), weight = std::cos(theta) * std::sin(theta + 0.1);
      of_table += weight * t, of_model += weight * m, weights += weight;
      worst = std::max(worst, t / m);
      state.counters[fmt::format("{:02}deg", degrees)] = t / m;
      state.counters[fmt::format("t{:02}", degrees)] = t;
    }
    state.counters["table"] = of_table / weights;
    state.counters["model"] = of_model / weights;
    state.counters["ratio"] = of_table / of_model;
    state.counters["worst"] = worst;
    std::string name;
    for (const LobeSpec& l : best.lobes)
      name += (name.empty() ? "" : "+") + model_infos()[std::size_t(l.model)].name;
    state.SetLabel(name);
  }
}

const bool registered = [] {
  const auto add = [](const std::string& name, auto make) {
    benchmark::RegisterBenchmark(("measured_sampling/" + name).c_str(),
                                 [make](benchmark::State& state) { compare(state, make()); })
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  };
  const std::filesystem::path folder = NACRE_SOURCE_DIR "/../shared/data/measured/merl";
  std::error_code none;
  for (const auto& file : std::filesystem::directory_iterator(folder, none))
    if (file.path().extension() == ".binary")
      add("measured/" + file.path().stem().string(),
          [path = file.path().string()] { return read_merl(path); });
  for (const PublishedFit& fit : published_fits())
    add("published/" + std::string(fit.material),
        [name = std::string(fit.material)] { return std::make_shared<const MerlTable>(demo_table(name)); });
  return true;
}();

} // namespace
} // namespace nacre

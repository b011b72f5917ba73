// What a derivative costs: GGX with Schlick's Fresnel, one channel, by number type; and a whole fit.

#include "bsdf/models/ggx_schlick.h"
#include "core/dual.h"
#include "core/file.h"
#include "core/parallel.h"
#include "core/random.h"
#include "fit/fit.h"
#include "fit/jet.h"
#include "fit/residuals.h"
#include "measured/merl_table.h"

#include <benchmark/benchmark.h>
#include <filesystem>

namespace nacre {
namespace {

constexpr std::size_t pairs = 1024;

/// Pairs of directions above the surface, one float each, or a pack of them.
template <class T>
std::vector<std::array<Vec3<T>, 2>> directions_of() {
  std::vector<std::array<Vec3<T>, 2>> list;
  std::array<std::vector<float>, 6> w;
  for (std::size_t i = 0; i < pairs; ++i)
    for (std::size_t k = 0; k < 2; ++k) {
      const float z = 0.1f + 0.9f * uniform(1, i, k, 0), phi = 6.2831853f * uniform(1, i, k, 1);
      const float s = std::sqrt(1 - z * z);
      w[3 * k].push_back(s * std::cos(phi));
      w[3 * k + 1].push_back(s * std::sin(phi));
      w[3 * k + 2].push_back(z);
    }
  constexpr std::size_t width = std::is_same_v<T, Pack> ? pack_width : 1;
  for (std::size_t i = 0; i < pairs; i += width) {
    const auto at = [&](std::size_t k) {
      if constexpr (std::is_same_v<T, Pack>)
        return load(&w[k][i]);
      else
        return T(w[k][i]);
    };
    list.push_back({Vec3<T>{at(0), at(1), at(2)}, Vec3<T>{at(3), at(4), at(5)}});
  }
  return list;
}

template <class R>
Vec3<R> raise(const Vec3<value_t<R>>& w) {
  return {R(w.x), R(w.y), R(w.z)};
}

/// @tparam Make  R(value, i): the i-th of the parameters, or a plain number
template <class R, class Make>
void evaluate_ggx(benchmark::State& state, Make make) {
  const auto list = directions_of<value_t<R>>();
  GgxSchlick<R, 1> model;
  model.f0[0] = make(0.04f, 0);
  model.alpha = make(0.2f, 1);
  benchmark::DoNotOptimize(model);
  for (auto _ : state)
    for (const auto& [wo, wi] : list) {
      R f = model.eval(raise<R>(wo), raise<R>(wi))[0];
      benchmark::DoNotOptimize(f);
    }
  state.counters["evaluations"] =
      benchmark::Counter(double(state.iterations()) * pairs, benchmark::Counter::kIsRate);
}

template <class R>
void plain(benchmark::State& state) {
  evaluate_ggx<R>(state, [](float x, int) { return R(x); });
}
template <class R>
void with_derivatives(benchmark::State& state) {
  evaluate_ggx<R>(state, [](float x, int i) { return R::variable(value_t<R>(x), i); });
}
template <class R>
void jets(benchmark::State& state) {
  evaluate_ggx<R>(state, [](float x, int i) { return R(x, i); });
}

using DualPack2 = Dual<Pack, 2>;
using DualPack4 = Dual<Pack, 4>;
using DualDouble4 = Dual<double, 4>;
using Jet4 = ceres::Jet<double, 4>;
BENCHMARK(plain<float>)->Name("ggx/float");
BENCHMARK(plain<double>)->Name("ggx/double");
BENCHMARK(plain<Pack>)->Name("ggx/Pack");
BENCHMARK(with_derivatives<DualPack2>)->Name("ggx/Dual<Pack,2>");
BENCHMARK(with_derivatives<DualPack4>)->Name("ggx/Dual<Pack,4>");
BENCHMARK(with_derivatives<DualDouble4>)->Name("ggx/Dual<double,4>");
BENCHMARK(jets<Jet4>)->Name("ggx/ceres::Jet<double,4>");

const MerlTable& full_table() {
  static const MerlTable table = [] {
    const auto bsdf = make_bsdf<double>(
        parse_material("ggx_schlick:f0=0.05/0.2/0.6,alpha=0.15+lambert:reflectance=0.3/0.1/0.02"));
    return MerlTable::tabulate(90, 90, 180, [&](double theta_h, double theta_d, double phi_d) {
      const auto [wo, wi] = directions(HalfDifference<double>{theta_h, theta_d, phi_d});
      if (!(wo.z > 0 && wi.z > 0)) return std::array{-1.0, -1.0, -1.0};
      const auto f = bsdf.eval(wo, wi);
      return std::array{f[0], f[1], f[2]};
    });
  }();
  return table;
}

/// Residuals and Jacobian of the fit's grid: three channels, seven parameters.
void jacobian(benchmark::State& state) {
  const ParameterLayout layout(parse_material("ggx_schlick+lambert"));
  const Observations at = observe(full_table(), {.theta_d_step = 3, .phi_d_step = 6});
  const Residuals residuals(at, Metric::log, layout);
  const std::vector<double> x = layout.coordinates(layout.start());
  std::vector<double> r(3 * at.count), matrix(r.size() * x.size());
  const double* parameters = x.data();
  double* jacobians = matrix.data();
  for (auto _ : state)
    residuals.Evaluate(&parameters, r.data(), &jacobians);
  state.counters["residuals"] =
      benchmark::Counter(double(state.iterations()) * double(r.size()), benchmark::Counter::kIsRate);
}
BENCHMARK(jacobian)->Name("fit/jacobian")->Unit(benchmark::kMillisecond);

void whole_fit(benchmark::State& state) {
  set_thread_count(1);
  const MerlTable& table = full_table();
  for (auto _ : state)
    benchmark::DoNotOptimize(fit(table, {.model = "ggx_schlick+lambert", .starts = int(state.range(0))}));
  set_thread_count(0);
}
BENCHMARK(whole_fit)->Name("fit/ggx_schlick+lambert/starts")->Arg(1)->Arg(12)->Unit(benchmark::kMillisecond);

/// What `nacre fit FILE --model all` does, on all threads.
void all_models(benchmark::State& state) {
  const FitData data(full_table());
  const std::vector<std::string> materials = fittable_materials();
  for (auto _ : state) {
    std::vector<FitResult> results(materials.size());
    parallel_for(materials.size(),
                 [&](std::size_t i) { results[i] = fit(data, ranking_options(materials[i])); });
    benchmark::DoNotOptimize(results);
  }
  state.counters["models"] = double(materials.size());
}
BENCHMARK(all_models)->Name("fit/all_models")->Unit(benchmark::kMillisecond)->Iterations(1)->UseRealTime();

/// A file of full resolution, 33 MB, in the system's cache: its bytes alone, and as a table.
const std::string& full_file() {
  static const std::string path = [] {
    const std::string file = (std::filesystem::temp_directory_path() / "nacre_bench.binary").string();
    write_merl(full_table(), file);
    return file;
  }();
  return path;
}
void read_bytes(benchmark::State& state) {
  const std::string& path = full_file();
  for (auto _ : state)
    benchmark::DoNotOptimize(read_file(path));
  state.SetBytesProcessed(state.iterations() * std::int64_t(std::filesystem::file_size(path)));
}
void read_table(benchmark::State& state) {
  const std::string& path = full_file();
  for (auto _ : state)
    benchmark::DoNotOptimize(read_merl(path));
  state.SetBytesProcessed(state.iterations() * std::int64_t(std::filesystem::file_size(path)));
}
BENCHMARK(read_bytes)->Name("merl/bytes")->Unit(benchmark::kMillisecond);
BENCHMARK(read_table)->Name("merl/table")->Unit(benchmark::kMillisecond);

} // namespace
} // namespace nacre

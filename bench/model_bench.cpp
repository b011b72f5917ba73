// What the models cost and how well they are sampled: evaluation one direction at a time against packs, lit
// spheres, and the variance of every model's own samples.

#include "bsdf/models/ashikhmin_shirley.h"
#include "bsdf/models/cook_torrance.h"
#include "bsdf/models/ggx_schlick.h"
#include "bsdf/models/rough_conductor.h"
#include "bsdf/models/rough_dielectric.h"
#include "bsdf/models/rough_plastic.h"
#include "bsdf/models/shaped_conductor.h"
#include "core/pack.h"
#include "core/parallel.h"
#include "core/random.h"
#include "report/material_images.h"
#include "report/model_table.h"

#include <benchmark/benchmark.h>
#include <numbers>

namespace nacre {
namespace {

constexpr std::size_t pairs = 1024; // in the first-level cache
constexpr int repeats = 16;         // to ask for the time seldom

/// Coordinates of pairs of directions above the surface; for what transmits, half of the lights are below.
std::array<std::vector<float>, 6> coordinates(bool transmits) {
  std::array<std::vector<float>, 6> w;
  for (std::size_t i = 0; i < pairs; ++i)
    for (std::size_t k = 0; k < 2; ++k) {
      const float z = 0.1f + 0.9f * uniform(3, i, k, 0), phi = 6.2831853f * uniform(3, i, k, 1);
      const float s = std::sqrt(1 - z * z);
      w[3 * k].push_back(s * std::cos(phi));
      w[3 * k + 1].push_back(s * std::sin(phi));
      w[3 * k + 2].push_back(transmits && k == 1 && i % 2 ? -z : z);
    }
  return w;
}

/// A model in three channels: 16 times 1024 evaluations by float one at a time, then the same by packs, in
/// turn, so that a slower clock slows both.
template <template <class, int> class Model>
void float_against_packs(benchmark::State& state) {
  auto one = default_model<Model<float, 3>>();
  auto many = default_model<Model<Pack, 3>>();
  benchmark::DoNotOptimize(one); // the values are not known when compiling
  benchmark::DoNotOptimize(many);
  const auto w = coordinates(Model<float, 3>::laws.transmits);
  benchmark::DoNotOptimize(one.eval({0, 0, 1}, {0, 0, 1})); // tables of first use
  double scalar_time = 0, pack_time = 0;
  for (auto _ : state) {
    const double start = cpu_seconds();
    for (int r = 0; r < repeats; ++r)
      for (std::size_t i = 0; i < pairs; ++i) {
        auto f = one.eval({w[0][i], w[1][i], w[2][i]}, {w[3][i], w[4][i], w[5][i]});
        benchmark::DoNotOptimize(f);
      }
    const double between = cpu_seconds();
    for (int r = 0; r < repeats; ++r)
      for (std::size_t i = 0; i < pairs; i += pack_width) {
        const auto at = [&](std::size_t k) { return load(&w[k][i]); };
        auto f = many.eval({at(0), at(1), at(2)}, {at(3), at(4), at(5)});
        benchmark::DoNotOptimize(f);
      }
    scalar_time += between - start;
    pack_time += cpu_seconds() - between;
  }
  const double evaluations = double(pairs) * repeats * double(state.iterations());
  state.counters["float_M/s"] = evaluations / scalar_time * 1e-6;
  state.counters["packs_M/s"] = evaluations / pack_time * 1e-6;
  state.counters["ratio"] = scalar_time / pack_time;
  state.counters["lanes"] = double(pack_width);
}
BENCHMARK(float_against_packs<GgxConductor>)->Name("eval/ggx_conductor");
BENCHMARK(float_against_packs<BeckmannConductor>)->Name("eval/beckmann_conductor");
BENCHMARK(float_against_packs<GgxSchlick>)->Name("eval/ggx_schlick");
BENCHMARK(float_against_packs<GtrConductor>)->Name("eval/gtr_conductor");
BENCHMARK(float_against_packs<StudentTConductor>)->Name("eval/student_t_conductor");
BENCHMARK(float_against_packs<ExponentialPowerConductor>)->Name("eval/exponential_power_conductor");
BENCHMARK(float_against_packs<GgxDielectric>)->Name("eval/ggx_dielectric");
BENCHMARK(float_against_packs<BeckmannDielectric>)->Name("eval/beckmann_dielectric");
BENCHMARK(float_against_packs<GgxPlastic>)->Name("eval/ggx_plastic");
BENCHMARK(float_against_packs<BeckmannPlastic>)->Name("eval/beckmann_plastic");
BENCHMARK(float_against_packs<CookTorrance>)->Name("eval/cook_torrance");
BENCHMARK(float_against_packs<AshikhminShirley>)->Name("eval/ashikhmin_shirley");

/// A sphere of 512 x 512 pixels on one core.
void sphere(benchmark::State& state, const char* text) {
  const int threads = thread_count();
  set_thread_count(1);
  const MaterialSpec material = parse_material(text);
  for (auto _ : state)
    benchmark::DoNotOptimize(lit_sphere(material, 512));
  set_thread_count(threads);
}
BENCHMARK_CAPTURE(sphere, lambert, "lambert")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(sphere, ggx_conductor, "ggx_conductor")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(sphere, ggx_plastic, "ggx_plastic")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(sphere, disney_2012, "disney_2012")->Unit(benchmark::kMillisecond);

/// Relative variance of f cos / pdf at 0, 45 and 80 degrees, every model at its defaults.
void variance(benchmark::State& state, const std::string& model) {
  const MaterialSpec material = parse_material(model);
  for (auto _ : state)
    for (const int theta : {0, 45, 80})
      state.counters[std::to_string(theta) + "deg"] =
          sampling_variance(material, theta * std::numbers::pi / 180);
}
const bool variances_registered = [] {
  for (const ModelInfo& model : model_infos())
    benchmark::RegisterBenchmark(("variance/" + model.name).c_str(),
                                 [name = model.name](benchmark::State& state) { variance(state, name); })
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  return true;
}();

} // namespace
} // namespace nacre

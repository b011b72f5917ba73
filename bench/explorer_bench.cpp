// What a slider of the explorer waits for, request and encoding included.
#include "explorer/desk.h"
#include "explorer/jobs.h"

#include <benchmark/benchmark.h>

namespace nacre {
namespace {

using nlohmann::json;

struct Bench {
  Workshop shop{Folder("."), {}, {}};
  PictureStore pictures;
  std::size_t ask(const json& request) {
    Desk desk{shop.folder, shop.materials, pictures, shop.start, 1, nullptr, {}};
    const Request decoded = decode_request(request.dump());
    return encode(1, find_handler(decoded.type).answer(Arguments(decoded.body), desk)).bytes.size();
  }
};

json eight_materials() {
  json list = json::array();
  for (const char* text : {"ggx_conductor:metal=Au", "beckmann_conductor:metal=Cu", "disney_2012",
                           "oren_nayar", "ggx_schlick+lambert", "ward", "ashikhmin_shirley", "cook_torrance"})
    list.push_back({{"text", text}});
  return list;
}

constexpr std::array<const char*, 9> kinds{"theta_h", "theta_d", "theta_i", "theta_o", "phi",
                                           "polar",   "albedo",  "D",       "G1"};

/// Curves of eight materials, of one kind, or of all.
void BM_ExplorerCurves(benchmark::State& state) {
  Bench bench;
  std::vector<json> requests;
  const auto chosen = std::size_t(state.range(0));
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    if (chosen < kinds.size() && chosen != k) continue;
    requests.push_back({{"id", 1},
                        {"type", "curves"},
                        {"kind", kinds[k]},
                        {"points", 256},
                        {"materials", eight_materials()}});
    bench.ask(requests.back()); // tables are made once
  }
  state.SetLabel(chosen < kinds.size() ? kinds[chosen] : "all kinds");
  for (auto _ : state)
    for (const json& request : requests)
      benchmark::DoNotOptimize(bench.ask(request));
}
BENCHMARK(BM_ExplorerCurves)
    ->DenseRange(0, 9)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

void sphere(benchmark::State& state, const json& material) {
  Bench bench;
  const json request{{"id", 1},       {"type", "sphere"}, {"size", 512},
                     {"theta_i", 40}, {"phi_i", 120},     {"material", material}};
  for (auto _ : state)
    benchmark::DoNotOptimize(bench.ask(request));
}
const auto sphere_of = [](const char* text) {
  return [text](benchmark::State& state) { sphere(state, {{"text", text}}); };
};
const auto sphere_of_file = [](benchmark::State& state) {
  sphere(state, {{"brdf", {{"name", "phong.brdf"}, {"source", R"(analytic
::begin parameters
float n 1 100 20
::end parameters
::begin shader
vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {
  vec3 R = reflect(-L, N);
  return vec3(0.2 + pow(max(0.0, dot(R, V)), n) * (n + 2.0) / 6.2831853);
}
::end shader
)"}}}});
};
[[maybe_unused]] const auto* registered = [] {
  for (const char* text : {"lambert", "ggx_conductor:metal=Au", "disney_2012", "openpbr"})
    benchmark::RegisterBenchmark(("BM_ExplorerSphere/" + std::string(text)).c_str(), sphere_of(text))
        ->Unit(benchmark::kMillisecond)
        ->MeasureProcessCPUTime();
  return benchmark::RegisterBenchmark("BM_ExplorerSphere/brdf_file", sphere_of_file)
      ->Unit(benchmark::kMillisecond)
      ->MeasureProcessCPUTime();
}();

} // namespace
} // namespace nacre

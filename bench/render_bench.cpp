// Whole paths a second on one core, by what covers the ball.

#include "ball_in_room.h"
#include "core/parallel.h"
#include "render/render.h"

#include <benchmark/benchmark.h>

namespace nacre {
namespace {

void render_ball(benchmark::State& state, const std::string& model) {
  Scene scene = bench::ball_in_room(model);
  scene.film.width = scene.film.height = 128;
  RenderOptions options;
  options.samples_per_pixel = 16;
  options.quiet = true;
  set_thread_count(1);
  std::uint64_t paths = 0, rays = 0;
  for (auto _ : state) {
    const RenderResult result = render(scene, options);
    paths += result.samples;
    rays += result.rays;
  }
  set_thread_count(0);
  state.counters["paths/s"] = benchmark::Counter(double(paths), benchmark::Counter::kIsRate);
  state.counters["rays/s"] = benchmark::Counter(double(rays), benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(render_ball, lambert, "lambert")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(render_ball, ggx_conductor, "ggx_conductor")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(render_ball, ggx_dielectric, "ggx_dielectric")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(render_ball, smooth_plastic, "smooth_plastic")->Unit(benchmark::kMillisecond);

} // namespace
} // namespace nacre

#include "render/render.h"

#include "core/error.h"
#include "core/parallel.h"
#include "core/version.h"
#include "render/camera.h"
#include "render/film.h"
#include "render/filter.h"
#include "render/path.h"
#include "spectra/cie.h"
#include "spectra/color_space.h"

#include <atomic>
#include <chrono>
#include <fmt/format.h>

namespace nacre {
namespace {

constexpr int tile_size = 16;
constexpr int most_samples = 1 << 20;

struct Tally {
  std::uint64_t samples = 0, rays = 0, invalid = 0;
};

/// What is needed to take one sample of one pixel.
struct PixelSampler {
  const PathTracer& tracer;
  const CameraRays& camera;
  const PixelFilter& filter;
  int width;
  std::uint64_t seed;

  template <class Sampler>
  void add(int x, int y, int index, FilmBuffer& film, Tally& tally) const {
    Sampler sampler(seed, std::uint64_t(y) * std::uint64_t(width) + std::uint64_t(x), std::uint32_t(index));
    const auto place = filter.sample(sampler.next_2d());
    const Wavelengths wavelengths = sample_wavelengths(sampler.next_1d());
    const Ray ray = camera.ray(float(x) + 0.5f + place.offset.x, float(y) + 0.5f + place.offset.y);
    const auto estimate = tracer.radiance(ray, wavelengths, sampler);
    RGB rgb = xyz_to_srgb * to_xyz(estimate.radiance, wavelengths);
    const bool valid = std::isfinite(rgb[0]) && std::isfinite(rgb[1]) && std::isfinite(rgb[2]);
    for (double& c : rgb)
      c = valid ? c * place.weight : 0;
    film.add(x, y, rgb);
    ++tally.samples;
    tally.rays += estimate.rays;
    tally.invalid += !valid;
  }
};

/// Progress of a render: by tiles and samples, or by time where time alone ends it.
class RenderProgress {
public:
  RenderProgress(std::size_t steps, double time_limit_s, bool by_time, bool quiet)
      : by_time_(by_time), steps_(by_time ? std::size_t(time_limit_s * ticks_per_second) + 1 : steps),
        progress_("rendering", steps_, quiet) {}
  void advance(std::size_t steps, double elapsed_s) {
    if (!by_time_) return progress_.advance(steps);
    const std::size_t now = std::min(steps_, std::size_t(elapsed_s * ticks_per_second) + 1);
    std::size_t before = ticks_;
    while (now > before && !ticks_.compare_exchange_weak(before, now)) {
    }
    if (now > before) progress_.advance(now - before);
  }

private:
  static constexpr double ticks_per_second = 10;
  bool by_time_;
  std::size_t steps_;
  std::atomic<std::size_t> ticks_{0};
  Progress progress_;
};

/// Number of samples a pixel gets in the pass that begins at `done`: 1, 1, 2, 4, ... 16.
int pass_length(int done, int total) { return std::min({std::max(done, 1), 16, total - done}); }

} // namespace

Renderer::Renderer(const Scene& scene) : scene_(scene), world_(std::make_unique<const World>(scene)) {}
Renderer::~Renderer() = default;

RenderResult render(const Scene& scene, const RenderOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const Renderer renderer(scene);
  const std::chrono::duration<double> preparation = std::chrono::steady_clock::now() - start;
  RenderOptions rest = options;
  // The limit counts the preparation too; what is left of it is never 0, which would be none.
  if (rest.time_limit_s > 0) rest.time_limit_s = std::max(rest.time_limit_s - preparation.count(), 1e-9);
  RenderResult result = renderer.render(rest);
  result.seconds += preparation.count();
  result.image.metadata["renderSeconds"] = fmt::format("{:.2f}", result.seconds);
  return result;
}

RenderResult Renderer::render(const RenderOptions& options) const {
  const Scene& scene = scene_;
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  const bool sobol = scene.sampler == "sobol";
  if (!sobol && scene.sampler != "independent") {
    const std::vector<std::string> known{"sobol", "independent"};
    throw Error("unknown sampler '" + scene.sampler + "'" + suggestion(scene.sampler, known));
  }
  int total = options.samples_per_pixel;
  const bool by_time = total == 0 && options.time_limit_s > 0;
  if (total == 0) total = by_time ? most_samples : scene.samples_per_pixel;
  if (total < 1 || total > most_samples)
    throw Error(fmt::format("samples per pixel must lie in 1 to {}, found {}", most_samples, total));

  const CameraRays camera(scene.camera, scene.film);
  const PixelFilter filter(scene.film);
  const PathTracer tracer(*world_, scene.integrator);
  const PixelSampler pixels{tracer, camera, filter, scene.film.width, options.seed};
  FilmBuffer film(scene.film.width, scene.film.height);

  const int columns = (film.width() + tile_size - 1) / tile_size;
  const int rows = (film.height() + tile_size - 1) / tile_size;
  const auto tiles = std::size_t(columns) * std::size_t(rows);
  std::atomic<std::uint64_t> samples{0}, rays{0}, invalid{0};
  std::atomic<bool> stopped{false};
  RenderProgress progress(tiles * std::size_t(total), options.time_limit_s, by_time, options.quiet);
  for (int done = 0; done < total && !stopped;) {
    const int length = pass_length(done, total);
    parallel_for(tiles, [&](std::size_t tile) {
      if (stopped) return;
      // One sample everywhere is made even at the shortest limit: a picture has no holes.
      const bool out_of_time = options.time_limit_s > 0 && done > 0 && elapsed() >= options.time_limit_s;
      if (out_of_time || stop_requested() || (options.stopped && options.stopped())) {
        stopped = true;
        return;
      }
      Tally tally;
      const int x0 = int(tile % std::size_t(columns)) * tile_size,
                y0 = int(tile / std::size_t(columns)) * tile_size;
      for (int y = y0; y < std::min(y0 + tile_size, film.height()); ++y)
        for (int x = x0; x < std::min(x0 + tile_size, film.width()); ++x)
          for (int i = done; i < done + length; ++i) {
            if (sobol)
              pixels.add<SobolSampler>(x, y, i, film, tally);
            else
              pixels.add<IndependentSampler>(x, y, i, film, tally);
          }
      samples += tally.samples;
      rays += tally.rays;
      invalid += tally.invalid;
      progress.advance(std::size_t(length), elapsed());
    });
    done += length;
    if (options.on_pass && !stopped) options.on_pass(film, done);
  }

  RenderResult result;
  result.image = film.to_image(options.variance);
  result.samples = samples;
  result.rays = rays;
  result.invalid_samples = invalid;
  result.complete = !stopped;
  result.seconds = elapsed();
  const double pixel_count = double(film.width()) * film.height();
  result.image.metadata = {{"colorSpace", "linear sRGB"},
                           {"integrator", scene.integrator.name},
                           {"samplesPerPixel", fmt::format("{:g}", double(result.samples) / pixel_count)},
                           {"seed", std::to_string(options.seed)},
                           {"scene", scene.file},
                           {"renderSeconds", fmt::format("{:.2f}", result.seconds)},
                           {"software", "Nacre " + version()}};
  return result;
}

namespace {

void check_pixel(const Film& film, int x, int y) {
  if (x < 0 || y < 0 || x >= film.width || y >= film.height)
    throw Error(
        fmt::format("pixel ({}, {}) lies outside the picture of {} x {}", x, y, film.width, film.height));
}

} // namespace

PixelSpectrum Renderer::spectrum(int x, int y, int samples, int bands) const {
  check_pixel(scene_.film, x, y);
  const CameraRays camera(scene_.camera, scene_.film);
  const PixelFilter filter(scene_.film);
  const PathTracer tracer(*world_, scene_.integrator);
  const double width = double(lambda_max_nm - lambda_min_nm) / bands;
  std::vector<double> sum(std::size_t(bands), 0.0), weight(std::size_t(bands), 0.0);
  XYZ xyz{};
  for (int i = 0; i < samples; ++i) {
    SobolSampler sampler(0, std::uint64_t(y) * std::uint64_t(scene_.film.width) + std::uint64_t(x),
                         std::uint32_t(i));
    const auto place = filter.sample(sampler.next_2d());
    const Wavelengths wavelengths = sample_wavelengths(sampler.next_1d());
    const Ray ray = camera.ray(float(x) + 0.5f + place.offset.x, float(y) + 0.5f + place.offset.y);
    const SampledSpectrum radiance = tracer.radiance(ray, wavelengths, sampler).radiance;
    const XYZ sample_xyz = to_xyz(radiance, wavelengths);
    for (std::size_t c = 0; c < 3; ++c)
      if (std::isfinite(sample_xyz[c])) xyz[c] += sample_xyz[c] * place.weight / samples;
    for (std::size_t k = 0; k < 4; ++k) {
      const double value = double(radiance[int(k)]) * place.weight;
      if (!(wavelengths.pdf[k] > 0) || !std::isfinite(value)) continue;
      const double at = double(wavelengths.lambda_nm[k] - lambda_min_nm) / width;
      const auto band = std::size_t(std::clamp(at, 0.0, bands - 1.0));
      sum[band] += value / double(wavelengths.pdf[k]);
      weight[band] += 1 / double(wavelengths.pdf[k]);
    }
  }
  PixelSpectrum result;
  result.xyz = {xyz[0], xyz[1], xyz[2]};
  for (int b = 0; b < bands; ++b) {
    result.wavelength_nm.push_back(double(lambda_min_nm) + (b + 0.5) * width);
    const auto i = std::size_t(b);
    result.radiance.push_back(weight[i] > 0 ? sum[i] / weight[i] : 0);
  }
  return result;
}

int Renderer::material_at(int x, int y) const {
  check_pixel(scene_.film, x, y);
  const Ray ray = CameraRays(scene_.camera, scene_.film).ray(float(x) + 0.5f, float(y) + 0.5f);
  Hit hit;
  return world_->accel.intersect(ray, hit) ? world_->surfaces.at(ray, hit).material : -1;
}

} // namespace nacre

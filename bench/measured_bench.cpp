// Measured reflectance that is looked up one pair of directions at a time: evaluations and samples a second.

#include "core/random.h"
#include "measured/formats/kaist_pbsdf.h"
#include "measured/formats/rgl_bsdf.h"
#include "measured/published_fits.h"

#include <benchmark/benchmark.h>
#include <map>

namespace nacre {
namespace {

constexpr std::size_t pairs = 4096;

std::vector<std::array<Vec3d, 2>> random_pairs() {
  std::vector<std::array<Vec3d, 2>> list(pairs);
  for (std::size_t i = 0; i < pairs; ++i)
    for (std::size_t k = 0; k < 2; ++k) {
      const double z = 0.05 + 0.95 * unit_double(hash(1, i, k)), phi = 2 * pi * unit_double(hash(2, i, k));
      const double s = std::sqrt(1 - z * z);
      list[i][k] = {s * std::cos(phi), s * std::sin(phi), z};
    }
  return list;
}

/// A published metal; azimuths and wavelengths are copies of the one there is, so that sizes are those of
/// real files.
const RglBsdf& rgl(bool anisotropic, std::size_t wavelengths) {
  static std::map<std::pair<bool, std::size_t>, RglBsdf> made;
  const std::pair key(anisotropic, wavelengths);
  if (const auto found = made.find(key); found != made.end()) return found->second;
  RglTables t = tabulate_rgl(demo_table("alum-bronze"), {8, 1, 32});
  const std::size_t slice = t.width * t.height, thetas = t.theta_i.size();
  if (wavelengths > 0) {
    std::vector<float> spectra;
    for (std::size_t s = 0; s < thetas; ++s)
      for (std::size_t c = 0; c < wavelengths; ++c) {
        const auto from = t.spectra.begin() + std::ptrdiff_t((s * 3 + c % 3) * slice);
        spectra.insert(spectra.end(), from, from + std::ptrdiff_t(slice));
      }
    t.spectra = std::move(spectra);
    for (std::size_t c = 0; c < wavelengths; ++c)
      t.wavelengths_nm.push_back(360 + 640.0 * double(c) / double(wavelengths));
  }
  if (anisotropic) {
    t.phi_i.clear();
    for (int p = 0; p <= 8; ++p)
      t.phi_i.push_back(float(-pi + p * pi / 4));
    for (auto* table : {&t.vndf, &t.luminance, &t.spectra}) {
      const std::vector<float> one = *table;
      for (int p = 0; p < 8; ++p)
        table->insert(table->end(), one.begin(), one.end());
    }
  }
  return made.emplace(key, RglBsdf(std::move(t))).first->second;
}

/// The database's resolution in angle but for every fourth azimuth.
const KaistPbsdf& kaist() {
  static const KaistPbsdf table = [] {
    MuellerTable t;
    for (int i = 0; i < 91; ++i) {
      t.phi_d.push_back(-pi + i * pi / 45);
      t.theta_d.push_back(i * pi / 180);
      t.theta_h.push_back(i * i / 90.0 * pi / 180);
    }
    t.wavelengths_nm = {450, 500, 550, 600, 650};
    t.entries.assign(std::size_t(91) * 91 * 91 * 5 * 16, 0.3f);
    return KaistPbsdf(std::move(t));
  }();
  return table;
}

void evaluate(benchmark::State& state, const MeasuredBsdf& measured) {
  const auto list = random_pairs();
  std::vector<float> f(std::size_t(measured.channels().count()));
  for (auto _ : state)
    for (const auto& [wo, wi] : list) {
      measured.evaluate(wo, wi, f);
      benchmark::DoNotOptimize(f.data());
      benchmark::ClobberMemory();
    }
  state.SetItemsProcessed(std::int64_t(state.iterations()) * pairs);
}
void at_wavelengths(benchmark::State& state, const MeasuredBsdf& measured) {
  const auto list = random_pairs();
  const Wavelengths w = sample_wavelengths(0.3f);
  for (auto _ : state)
    for (const auto& [wo, wi] : list)
      benchmark::DoNotOptimize(measured.at(wo, wi, w));
  state.SetItemsProcessed(std::int64_t(state.iterations()) * pairs);
}
void sample_and_pdf(benchmark::State& state, const MeasuredBsdf& measured) {
  const auto list = random_pairs();
  for (auto _ : state)
    for (std::size_t i = 0; i < pairs; ++i) {
      const Vec3d& wo = list[i][0];
      const Vec3d wi =
          measured.sample(wo, unit_double(hash(3, i)), {unit_double(hash(4, i)), unit_double(hash(5, i))});
      benchmark::DoNotOptimize(measured.pdf(wo, wi));
    }
  state.SetItemsProcessed(std::int64_t(state.iterations()) * pairs);
}

void rgl_isotropic_rgb(benchmark::State& s) { evaluate(s, rgl(false, 0)); }
void rgl_isotropic_195_wavelengths(benchmark::State& s) { evaluate(s, rgl(false, 195)); }
void rgl_isotropic_4_of_195(benchmark::State& s) { at_wavelengths(s, rgl(false, 195)); }
void rgl_anisotropic_rgb(benchmark::State& s) { evaluate(s, rgl(true, 0)); }
void rgl_anisotropic_4_of_195(benchmark::State& s) { at_wavelengths(s, rgl(true, 195)); }
void rgl_isotropic_sample_and_pdf(benchmark::State& s) { sample_and_pdf(s, rgl(false, 0)); }
void rgl_anisotropic_sample_and_pdf(benchmark::State& s) { sample_and_pdf(s, rgl(true, 0)); }
void rgl_tabulate_isotropic(benchmark::State& s) {
  const MerlTable table = demo_table("alum-bronze");
  for (auto _ : s)
    benchmark::DoNotOptimize(tabulate_rgl(table, rgl_resolution(table)));
}
void kaist_unpolarised(benchmark::State& s) { evaluate(s, kaist()); }
void kaist_mueller(benchmark::State& s) {
  const auto list = random_pairs();
  for (auto _ : s)
    for (const auto& [wo, wi] : list)
      benchmark::DoNotOptimize(kaist().mueller(wo, wi, 520));
  s.SetItemsProcessed(std::int64_t(s.iterations()) * pairs);
}

BENCHMARK(rgl_isotropic_rgb);
BENCHMARK(rgl_isotropic_195_wavelengths);
BENCHMARK(rgl_isotropic_4_of_195);
BENCHMARK(rgl_anisotropic_rgb);
BENCHMARK(rgl_anisotropic_4_of_195);
BENCHMARK(rgl_isotropic_sample_and_pdf);
BENCHMARK(rgl_anisotropic_sample_and_pdf);
BENCHMARK(rgl_tabulate_isotropic)->Unit(benchmark::kMillisecond);
BENCHMARK(kaist_unpolarised);
BENCHMARK(kaist_mueller);

} // namespace
} // namespace nacre

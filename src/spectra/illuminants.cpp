#include "spectra/illuminants.h"

#include "core/error.h"
#include "spectra/cie.h"
#include "spectra/data/daylight.h"

#include <cmath>
#include <fmt/format.h>

namespace nacre {
namespace {

// SI of 2019: exact.
constexpr double planck_J_s = 6.62607015e-34;
constexpr double light_speed_m_s = 299792458;
constexpr double boltzmann_J_K = 1.380649e-23;

template <class F>
DenseSpectrum tabulate(F f) {
  DenseSpectrum s;
  for (int i = 0; i < DenseSpectrum::count; ++i)
    s.values[i] = static_cast<float>(f(static_cast<double>(lambda_min_nm) + i));
  return s;
}

// Nominal temperatures date from before the change of Planck's second constant from 1.4380 to 1.4388 cm K.
constexpr double present_scale = 1.4388 / 1.4380;

double planck(double lambda_m, double temperature_k) {
  const double x = planck_J_s * light_speed_m_s / (lambda_m * boltzmann_J_K * temperature_k);
  const double e = std::expm1(x);
  if (!std::isfinite(e)) return 0;
  return 2 * planck_J_s * light_speed_m_s * light_speed_m_s / (std::pow(lambda_m, 5) * e);
}

} // namespace

DenseSpectrum cie_daylight(double cct_k) {
  if (!(cct_k >= 4000 && cct_k <= 25000))
    throw Error(fmt::format("daylight of {} K: the CIE formula holds from 4000 to 25000 K", cct_k));
  const double t = 1000 / cct_k;
  const double x = cct_k <= 7000 ? 0.244063 + t * (0.09911 + t * (2.9678 - t * 4.6070))
                                 : 0.237040 + t * (0.24748 + t * (1.9018 - t * 2.0064));
  const double y = -0.275 + x * (2.870 - x * 3.000);
  // CIE 015 rounds both to three decimals; without that the tables of the standard illuminants are missed.
  const auto round3 = [](double v) { return std::round(v * 1000) / 1000; };
  const double m = 0.0241 + 0.2562 * x - 0.7341 * y;
  const double m1 = round3((-1.3515 - 1.7703 * x + 5.9114 * y) / m);
  const double m2 = round3((0.0300 - 31.4424 * x + 30.0717 * y) / m);
  const auto& s = data::daylight_components_10nm;
  return tabulate([&](double lambda_nm) {
    const double position = (lambda_nm - static_cast<double>(lambda_min_nm)) / 10;
    const auto i = static_cast<std::size_t>(position);
    const auto at = [&](std::size_t n) { return s[0][n] + m1 * s[1][n] + m2 * s[2][n]; };
    const double f = position - static_cast<double>(i);
    return f == 0 ? at(i) : at(i) + f * (at(i + 1) - at(i));
  });
}

const DenseSpectrum& illuminant_d65() {
  static const DenseSpectrum s = cie_daylight(6500 * present_scale);
  return s;
}

const DenseSpectrum& illuminant_d50() {
  static const DenseSpectrum s = cie_daylight(5000 * present_scale);
  return s;
}

const DenseSpectrum& illuminant_a() {
  static const DenseSpectrum s = tabulate([](double lambda_nm) {
    const double c = 1.435e7 / 2848; // nm
    return 100 * std::pow(560 / lambda_nm, 5) * std::expm1(c / 560) / std::expm1(c / lambda_nm);
  });
  return s;
}

const DenseSpectrum& unit_d65() {
  static const DenseSpectrum s = [] {
    DenseSpectrum unit = illuminant_d65();
    const double luminance = integrate_xyz(unit)[1];
    for (float& v : unit.values)
      v = static_cast<float>(static_cast<double>(v) / luminance);
    return unit;
  }();
  return s;
}

double blackbody(double lambda_nm, double temperature_k) {
  constexpr double per_nm = 1e-9; // radiance per metre of wavelength to radiance per nanometre
  return planck(lambda_nm * 1e-9, temperature_k) * per_nm;
}

double blackbody_normalized(double lambda_nm, double temperature_k) {
  constexpr double wien_nm_K = 2.897771955e6; // CODATA 2018
  return blackbody(lambda_nm, temperature_k) / blackbody(wien_nm_K / temperature_k, temperature_k);
}

} // namespace nacre

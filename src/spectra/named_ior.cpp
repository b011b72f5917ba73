#include "spectra/named_ior.h"

#include "spectra/illuminants.h"
#include "spectra/ior.h"

#include <algorithm>
#include <cmath>

namespace nacre {
namespace {

constexpr double eta_min = 0.01, k_max = 30, reflectance_max = 0.99995;

double normal_reflectance(double eta, double k) {
  return ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k);
}

// Indices of equal normal reflectance lie on a circle around (c, 0) of radius sqrt(c^2 - 1), where
// c = (1 + f) / (1 - f): the equation above multiplied out. The nearest point is along the radius.
void move_to_reflectance(double f, double& eta, double& k) {
  const double c = (1 + f) / (1 - f), radius = std::sqrt(c * c - 1);
  const double distance = std::hypot(eta - c, k);
  // Far circles are nearly straight: the step, not the point, keeps the digits.
  const double step = distance > 0 ? 1 - radius / distance : 0;
  eta += step * (c - eta);
  k -= step * k;
  if (eta < eta_min) {
    eta = eta_min;
    k = std::sqrt(std::max(0.0, 2 * c * eta - 1 - eta * eta));
  }
  k = std::min(k, k_max);
}

} // namespace

std::optional<RgbIor> metal_rgb(std::string_view name) {
  const ConductorIor* metal = find_metal(name);
  if (metal == nullptr) return std::nullopt;
  RgbIor ior{};
  RGB color{}, total{};
  for (int nm = static_cast<int>(lambda_min_nm); nm <= static_cast<int>(lambda_max_nm); ++nm) {
    const auto lambda = static_cast<float>(nm);
    const auto cmf = cie_1931(lambda);
    const double eta = metal->eta.eval(lambda), k = metal->k.eval(lambda);
    const RGB sensitivity = xyz_to_srgb * XYZ{cmf[0], cmf[1], cmf[2]};
    for (int i = 0; i < 3; ++i) {
      const double weight = sensitivity[i] * unit_d65()(lambda);
      color[i] += weight / cie_y_integral_nm * normal_reflectance(eta, k);
      ior.eta[i] += std::max(weight, 0.0) * eta;
      ior.k[i] += std::max(weight, 0.0) * k;
      total[i] += std::max(weight, 0.0);
    }
  }
  for (int i = 0; i < 3; ++i) {
    ior.eta[i] /= total[i];
    ior.k[i] /= total[i];
    move_to_reflectance(std::clamp(color[i], 0.0, reflectance_max), ior.eta[i], ior.k[i]);
  }
  return ior;
}

std::optional<double> glass_eta(std::string_view name) {
  if (const DielectricIor* glass = find_glass(name)) return glass->n_d();
  return find_dielectric(name);
}

} // namespace nacre

#include "optics/ggx_albedo.h"

#include "core/parallel.h"
#include "core/quadrature.h"
#include "optics/fresnel.h"

namespace nacre {
namespace {

constexpr int n_eta = GgxAlbedo::n_eta;

double eta_of(int i) {
  const double t = 2.0 * i / (n_eta - 1) - 1;
  const double r = (GgxAlbedo::eta_max - 1) / (GgxAlbedo::eta_max + 1) * t * std::abs(t);
  return (1 + r) / (1 - r);
}

/// The square from which visible normals are sampled: Gauss-Legendre along the cap's height, midpoints over
/// the half of the azimuths that the plane of wo leaves different. Calls f(weight, wm).
template <class F>
void for_each_visible_facet(const Ggx<double>& d, const Vec3d& wo, int n_height, int n_phi, F f) {
  const QuadratureRule height = gauss_legendre(n_height, 0, 1);
  for (std::size_t j = 0; j < height.node.size(); ++j)
    for (int i = 0; i < n_phi; ++i)
      f(height.weight[j] / n_phi, d.sample_visible(wo, {0.5 * (i + 0.5) / n_phi, height.node[j]}));
}

/// G2 / G1(wo) of mirrored light, Heitz 2014, eq. 43 and 99, with Lambda times cosine.
double seen_from(const Ggx<double>& d, const Vec3d& wo, const Vec3d& wi) {
  if (wi.z <= 0) return 0;
  const double lo = d.lambda_cos(wo);
  return (wo.z + lo) * wi.z / (wo.z * wi.z + lo * wi.z + d.lambda_cos(wi) * wo.z);
}

Vec3d direction(double cos_theta) { return {std::sqrt(1 - cos_theta * cos_theta), 0, cos_theta}; }

FresnelParts<double> reflector_albedo(double cos_theta, double alpha) {
  const Ggx<double> d{alpha, alpha};
  const Vec3d wo = direction(cos_theta);
  FresnelParts<double> sum{};
  for_each_visible_facet(d, wo, 96, 24, [&](double weight, const Vec3d& wm) {
    const double c = dot(wo, wm), m2 = sqr(1 - c), m5 = m2 * m2 * (1 - c);
    const double seen = weight * seen_from(d, wo, reflect(wo, wm));
    sum.one += seen;
    sum.five += seen * m5;
    sum.six += seen * m5 * (1 - c) * c;
  });
  return sum;
}

struct DielectricAlbedos {
  std::array<double, n_eta> reflection{}, transmission{};
};
DielectricAlbedos dielectric_albedos(double cos_theta, double alpha) {
  const Ggx<double> d{alpha, alpha};
  const Vec3d wo = direction(cos_theta);
  DielectricAlbedos sum;
  for_each_visible_facet(d, wo, 28, 14, [&](double weight, const Vec3d& wm) {
    const double c = dot(wo, wm), seen = weight * seen_from(d, wo, reflect(wo, wm));
    for (int e = 0; e < n_eta; ++e) {
      const double eta = eta_of(e);
      const auto fresnel = fresnel_dielectric(c, eta);
      sum.reflection[std::size_t(e)] += seen * fresnel.reflectance;
      const Vec3d wt = wm * (c / eta + fresnel.cos_t) - wo * (1 / eta);
      if (wt.z < 0) sum.transmission[std::size_t(e)] += weight * (1 - fresnel.reflectance) * smith_g1(d, -wt);
    }
  });
  return sum;
}

/// 2 int E c dc of a row of nodes in s = sqrt(c), exact for E linear in s between them, like the table.
float average(const float* row, int n) {
  double sum = 0;
  const QuadratureRule rule = gauss_legendre(3); // exact to degree 5: E s^3 has degree 4
  for (int i = 0; i + 1 < n; ++i)
    sum += integrate(rule, [&](double x) {
      const double t = 0.5 * (1 + x), s = (i + t) / (n - 1);
      return 2 * (row[i] * (1 - t) + row[i + 1] * t) * s * s * s / (n - 1);
    });
  return float(sum);
}

} // namespace

GgxAlbedo::GgxAlbedo() {
  constexpr std::size_t cells = std::size_t(n_cos) * n_alpha;
  for (auto& part : reflector_)
    part.resize(cells);
  reflection_.resize(cells * n_eta);
  transmission_.resize(cells * n_eta);
  parallel_for(cells, [&](std::size_t cell) {
    const double c = std::max(1e-5, sqr(double(cell % n_cos) / (n_cos - 1)));
    const double a = std::max(1e-4, sqr(double(cell / n_cos) / (n_alpha - 1)));
    const FresnelParts<double> parts = reflector_albedo(c, a);
    reflector_[0][cell] = float(parts.one);
    reflector_[1][cell] = float(parts.five);
    reflector_[2][cell] = float(parts.six);
    const DielectricAlbedos dielectric = dielectric_albedos(c, a);
    for (std::size_t e = 0; e < n_eta; ++e) {
      reflection_[e * cells + cell] = float(dielectric.reflection[e]);
      transmission_[e * cells + cell] = float(dielectric.transmission[e]);
    }
  });
  const auto averages = [](const std::vector<float>& table) {
    std::vector<float> row_averages;
    for (std::size_t i = 0; i < table.size(); i += n_cos)
      row_averages.push_back(average(&table[i], n_cos));
    return row_averages;
  };
  for (std::size_t k = 0; k < 3; ++k)
    reflector_average_[k] = averages(reflector_[k]);
  reflection_average_ = averages(reflection_);
  transmission_average_ = averages(transmission_);
}

const GgxAlbedo& GgxAlbedo::table() {
  static const GgxAlbedo instance;
  return instance;
}

} // namespace nacre

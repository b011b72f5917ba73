#include "fit/export/evaluated_material.h"

#include "core/parallel.h"
#include "measured/rusinkiewicz.h"

namespace nacre {
namespace {

constexpr int n_theta_h = 90, n_theta_d = 90, n_phi_d = 180; // of the MERL database

double theta_h(double i) { return pi / 2 * sqr(i / n_theta_h); }
double theta_d(double j) { return pi / 2 * j / n_theta_d; }

Vec3d turned(const Vec3d& w, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * w.x - s * w.y, s * w.x + c * w.y, w.z};
}

} // namespace

bool is_isotropic(const Bsdf<double, 3>& bsdf) {
  for (int i = 1; i < 12; ++i) {
    const Vec3d wo = spherical_direction(0.12 * i, 0.0), wi = spherical_direction(0.1 * i, pi - 0.08 * i);
    const auto f = bsdf.eval(wo, wi);
    for (const double angle : {0.4, 1.1, pi / 2}) {
      const auto g = bsdf.eval(turned(wo, angle), turned(wi, angle));
      for (int c = 0; c < 3; ++c)
        if (std::abs(f[c] - g[c]) > 1e-6 * std::max(f[c], g[c]) + 1e-9) return false;
    }
  }
  return true;
}

EvaluatedMaterial::EvaluatedMaterial(const MaterialSpec& material, int theta_d_step, int phi_d_step)
    : bsdf_(make_bsdf<double>(material)), isotropic_(nacre::is_isotropic(bsdf_)) {
  for (const LobeSpec& lobe : material.lobes)
    kept_.push_back(lobe.measured);
  for (int i = 0; i < n_theta_h; ++i)
    for (int j = 0; j < n_theta_d; j += theta_d_step) {
      // The part of the pairs of directions nearest to the node: MerlTable::node_weight.
      const double weight = (std::cos(theta_h(std::max(i - 0.5, 0.0))) - std::cos(theta_h(i + 0.5))) *
                            (sqr(std::sin(std::min(theta_d(j + 0.5 * theta_d_step), pi / 2))) -
                             sqr(std::sin(theta_d(std::max(j - 0.5 * theta_d_step, 0.0)))));
      for (int k = 0; k < n_phi_d; k += phi_d_step) {
        auto [wo, wi] = directions(HalfDifference<double>{theta_h(i), theta_d(j), pi * k / n_phi_d});
        if (!(wo.z > 0 && wi.z > 0)) continue;
        if (!isotropic_) { // the golden angle: neighbours lie far apart, all together evenly
          const double angle = pi * (3 - std::sqrt(5.0)) * double(samples_.size());
          wo = turned(wo, angle), wi = turned(wi, angle);
        }
        samples_.wo.push_back({float(wo.x), float(wo.y), float(wo.z)});
        samples_.wi.push_back({float(wi.x), float(wi.y), float(wi.z)});
        samples_.weight.push_back(weight);
      }
    }
  samples_.f.resize(3 * samples_.size());
  const Vec3d up{0, 0, 1};
  (void)bsdf_.eval(up, up); // tables that a model builds on first use are built outside the parallel loop
  constexpr std::size_t part = 1024;
  parallel_for((samples_.size() + part - 1) / part, [&](std::size_t p) {
    for (std::size_t i = p * part; i < std::min((p + 1) * part, samples_.size()); ++i) {
      const Vec3f &o = samples_.wo[i], &w = samples_.wi[i];
      evaluate({o.x, o.y, o.z}, {w.x, w.y, w.z}, std::span(samples_.f).subspan(3 * i, 3));
    }
  });
}

bool EvaluatedMaterial::evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const {
  const auto value = bsdf_.eval(wo, wi);
  for (int c = 0; c < 3; ++c)
    f[std::size_t(c)] = float(value[c]);
  return true;
}

} // namespace nacre

#include "measured/measured_bsdf.h"

#include "measured/direction_sampling.h"

#include <algorithm>
#include <mutex>

namespace nacre {

bool MeasuredSides::contain(const Vec3d& wo, const Vec3d& wi) const {
  if (wo.z > 0) return (wi.z > 0 && reflects_front) || (wi.z < 0 && transmits_to_front);
  if (wo.z < 0) return (wi.z < 0 && reflects_back) || (wi.z > 0 && transmits_to_back);
  return false;
}

struct MeasuredBsdf::LazySampling {
  std::once_flag once;
  std::unique_ptr<const DirectionSampling> built;
};

MeasuredBsdf::MeasuredBsdf() : sampling_(std::make_unique<LazySampling>()) {}
MeasuredBsdf::MeasuredBsdf(MeasuredBsdf&&) noexcept = default;
MeasuredBsdf& MeasuredBsdf::operator=(MeasuredBsdf&&) noexcept = default;
MeasuredBsdf::~MeasuredBsdf() = default;

std::array<double, 3> MeasuredBsdf::rgb(const Vec3d& wo, const Vec3d& wi) const {
  std::array<float, Channels::max_count> f;
  const std::span used(f.data(), std::size_t(channels().count()));
  if (!evaluate(wo, wi, used)) return {};
  auto rgb = channels().to_rgb(used);
  for (double& x : rgb)
    x = std::max(x, 0.0);
  return rgb;
}

SampledSpectrum MeasuredBsdf::at(const Vec3d& wo, const Vec3d& wi, const Wavelengths& wavelengths) const {
  std::array<float, Channels::max_count> f;
  const std::span used(f.data(), std::size_t(channels().count()));
  if (!evaluate(wo, wi, used)) return {};
  return channels().at(used, wavelengths).map([](float x) { return std::max(x, 0.0f); });
}

void MeasuredBsdf::came_from(MeasuredSource source) const {
  source_ = std::make_shared<const MeasuredSource>(std::move(source));
}

const DirectionSampling& MeasuredBsdf::sampling() const {
  // Built by one thread alone: a parallel loop in here could pick up work that waits for this very table.
  std::call_once(sampling_->once, [&] { sampling_->built = std::make_unique<DirectionSampling>(*this); });
  return *sampling_->built;
}

double MeasuredBsdf::pdf(const Vec3d& wo, const Vec3d& wi) const { return sampling().pdf(wo, wi); }

Vec3d MeasuredBsdf::sample(const Vec3d& wo, double u_lobe, const Vec2d& u) const {
  return sampling().sample(wo, u_lobe, u);
}

} // namespace nacre

#include "measured/direction_sampling.h"

#include "core/warp.h"

namespace nacre {

double DirectionSampling::stays(const Vec3d& wo) const {
  const bool reflects = wo.z > 0 ? sides_.reflects_front : sides_.reflects_back;
  const bool transmits = wo.z > 0 ? sides_.transmits_to_front : sides_.transmits_to_back;
  return reflects ? (transmits ? 0.5 : 1) : 0;
}

double DirectionSampling::pdf(const Vec3d& wo, const Vec3d& wi) const {
  if (!sides_.contain(wo, wi)) return 0;
  const double stay = stays(wo);
  return std::abs(wi.z) * inv_pi * (wo.z * wi.z > 0 ? stay : 1 - stay);
}

Vec3d DirectionSampling::sample(const Vec3d& wo, double u_lobe, const Vec2d& u) const {
  const Vec3d w = square_to_cosine_hemisphere(u);
  const bool up = (wo.z > 0) == (u_lobe < stays(wo));
  return {w.x, w.y, up ? w.z : -w.z};
}

} // namespace nacre

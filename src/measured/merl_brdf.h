#pragma once
// Measured isotropic reflectance, interpolated from its table. Reciprocal by construction for tables that
// hold half the circle of phi_d; positive; conserves energy as far as the measurement does. Source: Matusik
// et al. 2003, A Data-Driven Reflectance Model.

#include "bsdf/model.h"
#include "measured/direction_sampling.h"
#include "measured/merl_table.h"

namespace nacre {

/// R = float, double or Pack. The table outlives the model.
template <class R, int C>
struct MerlBrdf : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  const MerlTable* table = nullptr;
  /// f = sum over RGB of the table's value times basis. For C = 3 the identity, for C = 1 luminance (BT.709);
  /// for C = 4 set it to the reflectance spectra of red, green and blue at the path's wavelengths.
  std::array<Color, 3> basis = default_basis();

  MerlBrdf() = default;
  explicit MerlBrdf(const MerlTable* measured) : table(measured) {}
  MerlBrdf(const MerlTable* measured, const std::array<Color, 3>& rgb_basis)
      : table(measured), basis(rgb_basis) {}

  static constexpr std::string_view name = "merl";
  static constexpr std::string_view source = "Matusik et al. 2003, A Data-Driven Reflectance Model";
  static constexpr std::string_view summary = "measured isotropic reflectance from a table";
  static constexpr auto parameters() { return std::tuple{}; }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto above = same_upper_side(wo, wi);
    if (!any(above)) return Color();
    const Spectrum<R, 3> rgb = table->interpolate(half_difference(wo, wi));
    return select(above, rgb[0] * basis[0] + rgb[1] * basis[1] + rgb[2] * basis[2], Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const { return table->sampling().pdf(wo, wi); }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const Vec3<R> wi = sample_direction(wo, u_lobe, u);
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

  static std::array<Color, 3> default_basis() {
    std::array<Color, 3> b{};
    if constexpr (C == 1)
      b = {Color(constant<R>(0.2126)), Color(constant<R>(0.7152)), Color(constant<R>(0.0722))};
    else
      for (int c = 0; c < C; ++c)
        b[c < 3 ? c : 2][c] = R(1);
    return b;
  }

private:
  Vec3<R> sample_direction(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const DirectionSampling& sampling = table->sampling();
    if constexpr (std::is_arithmetic_v<R>) {
      return sampling.sample(wo, u_lobe, u);
    } else {
      float x[pack_width], y[pack_width], z[pack_width];
      for (std::size_t l = 0; l < pack_width; ++l) {
        const Vec3f o{lane(wo.x, l), lane(wo.y, l), lane(wo.z, l)};
        const Vec3f i = sampling.sample(o, lane(u_lobe, l), Vec2f{lane(u.x, l), lane(u.y, l)});
        x[l] = i.x, y[l] = i.y, z[l] = i.z;
      }
      return {load(x), load(y), load(z)};
    }
  }
};

} // namespace nacre

#pragma once
// A measurement as a lobe: what renderer, plots and validator evaluate. MERL tables and user-written
// models answer in packs; other formats answer one pair of directions at a time.

#include "measured/merl_brdf.h"
#include "measured/user_bsdf.h"
#include "spectra/rgb.h"

namespace nacre {

/// R = float, double or Pack; C = 3 (linear RGB) or 4 (the wavelengths of a path). The measurement outlives
/// it.
template <class R, int C>
class MeasuredLobe {
public:
  using Color = Spectrum<R, C>;

  MeasuredLobe() = default;
  explicit MeasuredLobe(const MeasuredBsdf* measured) requires(C == 3)
      : data_(measured), merl_(dynamic_cast<const MerlTable*>(measured)),
        user_(dynamic_cast<const UserBsdf*>(measured)) {}
  MeasuredLobe(const MeasuredBsdf* measured, const Wavelengths& wavelengths) requires(C == 4)
      : data_(measured), merl_(dynamic_cast<const MerlTable*>(measured)), wavelengths_(wavelengths) {
    if (merl_.table) merl_.basis = rgb_basis(wavelengths);
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    if (merl_.table) return merl_.eval(wo, wi);
    if constexpr (std::is_same_v<R, Pack> && C == 3)
      if (user_) return user_->eval(wo, wi);
    Color f;
    each_lane([&](std::size_t l) {
      const auto one = eval_one(direction(wo, l), direction(wi, l));
      for (int c = 0; c < C; ++c)
        set_lane(f[c], l, double(one[std::size_t(c)]));
    });
    return f;
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    if (merl_.table) return merl_.pdf(wo, wi);
    R p(0);
    each_lane([&](std::size_t l) { set_lane(p, l, data_->pdf(direction(wo, l), direction(wi, l))); });
    return p;
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    if (merl_.table) return merl_.sample(wo, u_lobe, u);
    Vec3<R> wi{R(0), R(0), R(0)};
    each_lane([&](std::size_t l) {
      const Vec3d w =
          data_->sample(direction(wo, l), number(u_lobe, l), Vec2d{number(u.x, l), number(u.y, l)});
      set_lane(wi.x, l, w.x), set_lane(wi.y, l, w.y), set_lane(wi.z, l, w.z);
    });
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

private:
  static constexpr bool is_scalar = std::is_arithmetic_v<R>;

  template <class F>
  static void each_lane(F f) {
    for (std::size_t l = 0; l < (is_scalar ? 1 : pack_width); ++l)
      f(l);
  }
  static double number(const R& x, std::size_t l) {
    if constexpr (is_scalar)
      return double(x);
    else
      return double(lane(x, l));
  }
  static void set_lane(R& x, std::size_t l, double value) {
    if constexpr (is_scalar) {
      x = R(value);
    } else {
      std::array<float, pack_width> lanes;
      store(lanes.data(), x);
      lanes[l] = float(value);
      x = load(lanes.data());
    }
  }
  static Vec3d direction(const Vec3<R>& w, std::size_t l) {
    return {number(w.x, l), number(w.y, l), number(w.z, l)};
  }
  auto eval_one(const Vec3d& wo, const Vec3d& wi) const {
    if constexpr (C == 3)
      return data_->rgb(wo, wi);
    else
      return data_->at(wo, wi, wavelengths_).c;
  }

  const MeasuredBsdf* data_ = nullptr;
  MerlBrdf<R, C> merl_; ///< with a table if the measurement is one
  const UserBsdf* user_ = nullptr;
  Wavelengths wavelengths_{};
};

} // namespace nacre

#pragma once
// Directional albedo of Estevez and Kulla's sheen, which layers below it need.

#include "core/dual.h"
#include "core/pack.h"

#include <vector>

namespace nacre {

/// Of `charlie` without its softened terminator, colour 1. By quadrature on first use; linear between nodes
/// in cos and sqrt(roughness); error below 0.005 (test).
class CharlieAlbedo {
public:
  static constexpr int n_cos = 48, n_roughness = 24;
  static constexpr double roughness_lo = 0.05;

  static const CharlieAlbedo& table();

  /// @param cos_theta in [0, 1], roughness in [roughness_lo, 1] (clamped)
  template <class R>
  R operator()(const R& cos_theta, const R& roughness) const {
    const auto axis = [](const R& x, int n) {
      const R scaled = select(x < R(0), R(0), select(x > R(1.000001f), R(1), x)) * R(float(n - 1));
      const value_t<R> index = min(floor(value(scaled)), value_t<R>(float(n - 2)));
      return std::pair{index, R(scaled - R(index))};
    };
    const auto [c, cf] = axis(safe_sqrt(cos_theta), n_cos);
    const auto [r, rf] =
        axis(safe_sqrt(R((roughness - constant<R>(roughness_lo)) * constant<R>(1 / (1 - roughness_lo)))),
             n_roughness);
    const value_t<R> one(1), low = r * value_t<R>(float(n_cos)) + c, high = low + value_t<R>(float(n_cos));
    const auto along = [&, cf = cf](const value_t<R>& i) {
      const R x = R(gather(table_.data(), i)), y = R(gather(table_.data(), i + one));
      return R(x + cf * (y - x));
    };
    const R x = along(low), y = along(high);
    return x + rf * (y - x);
  }

private:
  CharlieAlbedo();
  std::vector<float> table_;
};

} // namespace nacre

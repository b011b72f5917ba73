#include "optics/masking_table.h"

#include "optics/ndf_blinn_phong.h"
#include "optics/ndf_exponential_power.h"
#include "optics/ndf_gtr.h"
#include "optics/ndf_shifted_gamma.h"
#include "optics/ndf_student_t.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace nacre {
namespace {

/// Calls f(make, p, q): make(p, q) is a shape of two numbers, of whatever number type.
template <class F>
void for_each_shape(F f) {
  const auto numbers = [&](auto make, std::initializer_list<double> ps, std::initializer_list<double> qs) {
    for (const double p : ps)
      for (const double q : qs)
        f(make, p, q);
  };
  numbers([]<class R>(R a, R g) { return GtrShape<R>{a, g}; }, {1e-3, 0.02, 0.3, 0.99}, {0.1, 1.3, 2, 4.9});
  numbers([]<class R>(R g, R) { return StudentTShape<R>{g}; }, {1.6, 2, 5, 39}, {1});
  numbers([]<class R>(R p, R) { return ExponentialPowerShape<R>{p}; }, {0.21, 0.5, 1, 2, 4.9}, {1});
  numbers([]<class R>(R n, R) { return BlinnPhongShape<R>{n}; }, {0.1, 10, 1e4}, {1});
  numbers(
      []<class R>(R a, R p) {
        return ShiftedGammaShape<R>{a, p, shifted_gamma_normalisation(a, p)};
      },
      {2e-5, 1e-3, 0.1, 0.9}, {0.1, 1.1, 1.9});
}

/// Directions in the shape's own units, from all but horizontal to all but vertical.
std::vector<Vec2<double>> directions() {
  std::vector<Vec2<double>> w;
  for (double log_q = -7; log_q < 9; log_q += 0.173) {
    const double angle = std::atan(std::exp(-log_q));
    w.push_back({double(float(std::sin(angle))), double(float(std::cos(angle)))});
  }
  return w;
}

// Against double, relative to what masking compares: the projected area of all that faces the viewer.
TEST(MaskingTable, AgreesWithQuadrature) {
  for_each_shape([&](auto make, double p, double q) {
    const auto shape = make(p, q);
    const MaskingTable<Pack> table(make(constant<Pack>(p), constant<Pack>(q)));
    for (const auto& [s, z] : directions()) {
      const double exact = shape.lambda_cos(s, z);
      const double found = double(lane(table.lambda_cos(constant<Pack>(s), constant<Pack>(z)), 0));
      const double error = std::abs(found - exact) / (z + exact);
      EXPECT_LT(error, 3e-5) << fmt::format("{} {} {}, s {}, z {}: {} for {}", shape.name, p, q, s, z, found,
                                            exact);
    }
  });
}

// By both numbers of the shape and a stretch of the slopes, as dual numbers over double have it.
TEST(MaskingTable, DerivativesAgreeWithQuadrature) {
  using D = Dual<double, 3>;
  using P = Dual<Pack, 3>;
  for_each_shape([&](auto make, double p, double q) {
    const auto shape = make(D::variable(p, 0), D::variable(q, 1));
    const MaskingTable<P> table(make(P::variable(constant<Pack>(p), 0), P::variable(constant<Pack>(q), 1)));
    for (const auto& [s, z] : directions()) {
      const D exact = shape.lambda_cos(D::variable(s, 2), D(z));
      const P found = table.lambda_cos(P::variable(constant<Pack>(s), 2), P(constant<Pack>(z)));
      const double at[] = {p, q, s};
      for (std::size_t k = 0; k < 3; ++k) {
        const double d = double(lane(found.d[k], 0));
        const double error = std::abs(d - exact.d[k]) / (std::abs(exact.d[k]) + (z + exact.v) / at[k]);
        EXPECT_LT(error, 3e-4) << fmt::format("{} {} {}, s {}, z {}, by {}: {} for {}", shape.name, p, q, s,
                                              z, k, d, exact.d[k]);
      }
    }
  });
}

} // namespace
} // namespace nacre

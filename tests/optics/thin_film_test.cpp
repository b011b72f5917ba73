#include "optics/thin_film.h"

#include "core/dual.h"

#include <complex>
#include <gtest/gtest.h>

namespace nacre {
namespace {

using C = std::complex<double>;

// Reflectance by the characteristic matrix of the layer: Born and Wolf, section 1.6.2, independent of Airy's
// sum.
PolarizedReflectance<double> transfer_matrix(double cos_i, double lambda, const ThinFilm<double>& film) {
  const double sin2 = 1 - cos_i * cos_i;
  const C n1 = film.eta_film, n2(film.eta_base, film.k_base);
  C c1 = std::sqrt(1.0 - sin2 / (n1 * n1)), c2 = std::sqrt(1.0 - sin2 / (n2 * n2));
  if ((n1 * c1).imag() < 0) c1 = -c1;
  if ((n2 * c2).imag() < 0) c2 = -c2;
  const C beta = 2 * pi / lambda * film.thickness_nm * n1 * c1;
  const auto reflect = [&](const C& y0, const C& y1, const C& y2) {
    // E and H through the layer: [cos, -i sin / y; -i y sin, cos]
    const C a = std::cos(beta), b = C(0, -1) * std::sin(beta);
    const C e = a + b * y2 / y1, h = b * y1 + a * y2;
    return std::norm((y0 * e - h) / (y0 * e + h));
  };
  return {reflect(cos_i, n1 * c1, n2 * c2), reflect(1 / cos_i, n1 / c1, n2 / c2)};
}

TEST(ThinFilm, MatchesTheTransferMatrix) {
  for (const double cos_i : {1.0, 0.7, 0.2})
    for (const double eta_film : {0.6, 1.0, 1.33, 1.5, 2.4})
      for (const auto& [eta, k] : {std::pair{1.5, 0.0}, {0.7, 0.0}, {0.2, 3.4}, {3.0, 1.0}})
        for (const double thickness : {0.0, 50.0, 230.0, 900.0}) {
          const ThinFilm<double> film{thickness, eta_film, eta, k};
          const auto airy = thin_film_reflectance(cos_i, 550.0, film),
                     matrix = transfer_matrix(cos_i, 550, film);
          EXPECT_NEAR(airy.s, matrix.s, 1e-10) << cos_i << " " << eta_film << " " << eta << " " << thickness;
          EXPECT_NEAR(airy.p, matrix.p, 1e-10) << cos_i << " " << eta_film << " " << eta << " " << thickness;
        }
}

TEST(ThinFilm, OfNoThicknessIsTheBareBase) {
  for (const double cos_i : {1.0, 0.6, 0.05, 0.0})
    for (const auto& [eta, k] : {std::pair{1.5, 0.0}, {0.2, 3.4}}) {
      const ThinFilm<double> none{0, 1.8, eta, k};
      const double bare = fresnel_conductor(cos_i, eta, k);
      EXPECT_NEAR(thin_film_reflectance(cos_i, 500.0, none).unpolarized(), bare, 1e-7) << cos_i << " " << eta;
      for (const double channel : thin_film_rgb(cos_i, none).c)
        EXPECT_NEAR(channel, bare, 1e-6) << cos_i << " " << eta;
    }
}

TEST(ThinFilm, QuarterWaveOfTheRootIndexReflectsNothing) {
  const double base = 1.52, film = std::sqrt(base), lambda = 550;
  EXPECT_NEAR(thin_film_reflectance(1.0, lambda, {lambda / (4 * film), film, base}).unpolarized(), 0, 1e-20);
  // Magnesium fluoride on crown glass: the 1.26 % of ((n0 ns - n1^2) / (n0 ns + n1^2))^2.
  EXPECT_NEAR(thin_film_reflectance(1.0, lambda, {lambda / (4 * 1.38), 1.38, base}).unpolarized(), 0.0126,
              1e-4);
}

TEST(ThinFilm, HalfWaveIsAbsent) {
  const double lambda = 550;
  for (const double film : {1.38, 2.3})
    EXPECT_NEAR(thin_film_reflectance(1.0, lambda, {lambda / (2 * film), film, 1.52}).unpolarized(),
                fresnel_dielectric(1.0, 1.52).reflectance, 1e-14);
}

TEST(ThinFilm, NeverReflectsMoreThanArrives) {
  for (double cos_i = 0; cos_i <= 1; cos_i += 0.1)
    for (double thickness = 0; thickness < 2000; thickness += 97)
      for (const double eta_film : {0.5, 1.01, 1.33, 2.5})
        for (const auto& [eta, k] : {std::pair{1.5, 0.0}, {0.1, 8.0}, {2.9, 3.0}}) {
          const auto r = thin_film_reflectance(cos_i, 450.0, ThinFilm<double>{thickness, eta_film, eta, k});
          EXPECT_TRUE(r.s >= 0 && r.s <= 1 + 1e-12 && r.p >= 0 && r.p <= 1 + 1e-12)
              << cos_i << " " << thickness << " " << eta_film << ": " << r.s << " " << r.p;
        }
}

TEST(ThinFilm, SoapBubbleTurnsBlackWhereItThins) {
  const ThinFilm<double> water{5, 1.33, 1.0};
  EXPECT_LT(thin_film_reflectance(1.0, 550.0, water).unpolarized(), 0.002); // against 0.08 at its brightest
  EXPECT_NEAR(thin_film_reflectance(1.0, 550.0, {550 / (4 * 1.33), 1.33, 1.0}).unpolarized(),
              sqr((1 - 1.33 * 1.33) / (1 + 1.33 * 1.33)), 1e-12);
}

TEST(ThinFilm, IsTheSameInFloatAndDouble) {
  for (const double cos_i : {0.9, 0.3})
    for (const double thickness : {100.0, 800.0}) {
      const auto exact = thin_film_reflectance(cos_i, 600.0, ThinFilm<double>{thickness, 1.4, 0.3, 3.0});
      const auto single =
          thin_film_reflectance(float(cos_i), 600.0f, ThinFilm<float>{float(thickness), 1.4f, 0.3f, 3.0f});
      EXPECT_NEAR(single.s, exact.s, 1e-5);
      EXPECT_NEAR(single.p, exact.p, 1e-5);
      const auto rgb = thin_film_rgb(cos_i, ThinFilm<double>{thickness, 1.4, 0.3, 3.0});
      const auto rgb_single =
          thin_film_rgb(float(cos_i), ThinFilm<float>{float(thickness), 1.4f, 0.3f, 3.0f});
      for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(rgb_single[i], rgb[i], 1e-5);
    }
}

TEST(ThinFilm, HasFiniteDerivativesInEveryCorner) {
  using D = Dual<double, 5>;
  for (const double c : {0.0, 1e-20, 0.4, 1.0})
    for (const double thickness : {0.0, 10.0, 500.0})
      for (const double film : {0.5, 1.0, 1.5})
        for (const double eta : {0.01, 1.0, 1.5})
          for (const double k : {0.0, 4.0}) {
            const ThinFilm<D> layer{D::variable(thickness, 1), D::variable(film, 2), D::variable(eta, 3),
                                    D::variable(k, 4)};
            const auto r = thin_film_reflectance(D::variable(c, 0), D(500), layer);
            const auto rgb = thin_film_rgb(D::variable(c, 0), layer);
            EXPECT_TRUE(isfinite(r.s) && isfinite(r.p)) << c << " " << thickness << " " << film << " " << eta;
            for (const D& channel : rgb.c)
              EXPECT_TRUE(isfinite(channel))
                  << c << " " << thickness << " " << film << " " << eta << " " << k;
          }
}

} // namespace
} // namespace nacre

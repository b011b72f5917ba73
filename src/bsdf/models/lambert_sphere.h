#pragma once
// A deep medium of spherical Lambertian grains: asteroids, chalk, coarse powders. Single scattering exact,
// multiple scattering as the paper's fit of two Fourier orders in azimuth. Brighter towards the light than
// Lambert, saturated in colour. Reciprocal; the fits lose 1 to 2 % of a white
// surface's energy. Source: d'Eon 2021, An Analytic BRDF for Materials with Spherical Lambertian Scatterers,
// eq. 28, 37, 46 and the author's published coefficients.

#include "bsdf/hemisphere_lobes.h"
#include "bsdf/model.h"

namespace nacre {

template <class R, int C>
struct LambertSphere : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color reflectance;

  static constexpr std::string_view name = "lambert_sphere";
  static constexpr std::string_view source = "d'Eon 2021, Spherical Lambertian Scatterers";
  static constexpr std::string_view summary = "deep powder of spherical Lambertian grains";
  static constexpr auto parameters() {
    return std::tuple{Parameter{&LambertSphere::reflectance, "reflectance", "1", 0, 1, 0.5,
                                "hemispherical albedo, from which the grains' albedo follows"}};
  }

  /// Albedo of the grains that gives this hemispherical albedo of the medium, eq. 46.
  static R grain_albedo(const R& kd) {
    const R q = max(R(1) - kd, R(1e-6f)); // pow wants more than 0
    return (R(1) - pow(q, R(2.73556f))) / (R(1) - R(0.184096f) * pow(q, R(2.48423f)));
  }
  /// Phase function of a Lambertian sphere, 1/sr; `cosine` between the directions of travel.
  static R phase(const R& cosine) {
    const R c = clamp(cosine, R(-1), R(1)), s = safe_sqrt(R(R(1) - c * c));
    return constant<R>(2 / (3 * pi * pi)) * (s - c * atan2(s, c));
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto up = same_upper_side(wo, wi);
    const Vec3<R> normal{R(0), R(0), R(1)};
    const Vec3<R> o = select(up, wo, normal), i = select(up, wi, normal);
    const R cos_oi = dot(o, i), azimuth = cos_oi - o.z * i.z; // cos(phi) sin(theta_o) sin(theta_i)
    const R p = phase(R(-cos_oi));
    return select(up, reflectance.map([&](const R& kd) {
      const R c = grain_albedo(kd), C2 = max(R(1) - c, R(1e-8f)), root = sqrt(C2); // 1e-8: root varies at 0
      const R once = c * (p - mean_phase(o.z, i.z));
      const R many = zeroth(o.z, i.z, c, root) + azimuth * first(o.z, i.z, c);
      return R(max((once + many) / (o.z + i.z), R(0))); // eq. 48's guard against the fit's negative values
    }),
                  Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    return select(same_upper_side(wo, wi), diffusing_lobe(wo).pdf(wi), R(0));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& u) const {
    const Vec3<R> wi = diffusing_lobe(wo).sample(u);
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

private:
  static R real(double x) { return constant<R>(x); }
  static R cubic(const R& x, double a, double b, double c, double d) {
    return real(a) + x * (real(b) + x * (real(c) + x * real(d)));
  }

  /// The order of the phase function that is even in azimuth, to second order in its Legendre expansion.
  static R mean_phase(const R& o, const R& i) {
    const R o2 = o * o, i2 = i * i;
    return real(inv_pi / 768) * (R(207) + R(256) * o * i - R(45) * o2 + R(45) * i2 * (R(3) * o2 - R(1)));
  }
  /// H of order 0, eq. 37; `root` = sqrt(1 - c).
  static R h0(const R& u, const R& c, const R& root) {
    const R a = (real(8.216443463470172) + real(1.501116252342486) * pow(root, real(6.054351911707695))) /
                (real(4.175932557866179) - real(1.2122216865199813) * root);
    const R r2 = root * root, r7 = r2 * r2 * r2 * root;
    const R d = (real(7.773097842804312) - real(0.5658108102188075) * pow(root, real(0.9615460393324836))) /
                (real(8.659120811349371) - real(0.15997430541238322) * r7);
    const R under = R(1) - c * (real(89.0 / 144) + c * (real(59.0 / 144) - c * real(1.0 / 36)));
    const R au = a * pow(max(u, R(1e-20f)), d);
    return (R(1) + au) / (R(1) + au * sqrt(max(under, R(1e-12f))));
  }
  /// H of order 1, eq. 28.
  static R h1(const R& u, const R& c) {
    const R power =
        cubic(u, 0.45944184025347456, -1.0787917226917565, 1.8572804924335546, -1.1283119660147671);
    const R c_term = c * (real(-0.14483935877260054) + c * real(0.024285125615255733));
    return exp(R(c_term * pow(max(u, R(1e-20f)), power)));
  }
  /// Order 0 in azimuth, all scatterings, times (cos_o + cos_i).
  static R zeroth(const R& o, const R& i, const R& c, const R& r) {
    const R low_b = cubic(r, 0.9648932738041012, -0.6655015709030936, 0.1826019462608555, 0);
    const R low_c = cubic(r, 5850.602606063662, -4008.3309624647227, 1480.250743805733, 0);
    const R low_d = cubic(r, 674.1908010450103, -412.9837444306491, 596.4232294419696, 0);
    const R low_f = cubic(r, 1499.904420175135, 457.4200839912641, 215.77342164754094, 0);
    const R A = real(69.0 / 128) * c;
    const R B =
        cubic(r, -0.08446297239646791, 0.5153566145541554, -0.77757371002123, 0.34668869623791543) / low_b;
    const R Q =
        cubic(r, 682.8479477533338, -2567.7368047535556, 7487.987105705168, -5602.448801045478) / low_c;
    const R D =
        cubic(r, 0.2855294320307508, 160.39651500649123, -327.42799697993706, 166.88327184107732) / low_d;
    const R E = real(15.0 / 128) * r * r * c * (R(3) + real(4.0 / 3) * c);
    const R F =
        cubic(r, -1.9208967199948512, -242.16001167844007, -21.914139454773085, 266.06342182761813) / low_f;
    const R sum = o + i, product = o * i;
    const R polynomial = A + B * sum + product * (Q + D * sum + E * product) + F * (o * o + i * i);
    return real(0.5 * inv_pi) * h0(o, c, r) * h0(i, c, r) * polynomial;
  }
  /// Order 1 in azimuth without single scattering, times (cos_o + cos_i) / (cos(phi) sin_o sin_i).
  static R first(const R& o, const R& i, const R& c) {
    const R l = c * (real(-0.05890107167021953) - c * real(0.004740543453386809));
    const R h = h1(o, c) * h1(i, c), product = o * i;
    const R excess = c * (R(64) + R(45) * product) * real(1.0 / 48) -
                     h * c *
                         (real(15.0 / 16) * (R(1) + real(0.44) * c) * product +
                          real(4.0 / 3) * (R(1) + l * o) * (R(1) + l * i));
    return real(-0.25 * inv_pi) * excess;
  }
};

} // namespace nacre

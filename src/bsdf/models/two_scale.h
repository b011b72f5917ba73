#pragma once
// A metal rough at two scales: facets larger than the wavelength mirror light and on them a finer roughness
// diffracts it. The share that stays in the facets' mirror lobe falls with the wavelength, the rest spreads
// into a wide lobe with a power-law end, blurred by the facets' normals: the haze of real metals and its
// colour. Reciprocal, positive; loses the energy of multiple bounces.
//
// Source: Holzschuch and Pacanowski 2017, A Two-Scale Microfacet Reflectance Model Combining Reflection and
// Diffraction, ACM TOG 36(4), eq. 12 (A), 16 (S_HS), 19 (renormalisation), 25 (mirror lobe), 33 and 39 to 41
// (diffraction lobe), 34 to 38 (facets). Two things are ours. The source tabulates the convolution of S_HS
// with the facets' distribution as factors s and g of its height and width; here they follow from its two
// limits and its area. And Q is the mean over both polarisations, Fresnel's reflectance, as conservation of
// energy asks; the authors' program has their sum, twice as much.

#include "bsdf/microfacet_reflection.h"
#include "bsdf/projected_disk_lobe.h"
#include "optics/fresnel.h"
#include "optics/masking.h"
#include "optics/ndf_exponential_power.h"

namespace nacre {

template <class R, int C>
struct TwoScale : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color eta, k;
  R beta, p, sigma, b, c;
  Color wavelength;
  const MaskingTable<R>* prepared = nullptr;

  static constexpr std::string_view name = "two_scale",
                                    source = "Holzschuch and Pacanowski 2017, eq. 25, 33, 34",
                                    summary = "metal with mirror facets and diffraction by finer roughness";
  // Where the finer roughness is steep (sigma near b / 5) and most light diffracted: eq. 33 takes the masking
  // and the angle to the facets out of the integral.
  static constexpr Laws laws{.energy_gain = 0.35};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&TwoScale::eta, "eta", "1", 0.01, 20, 1.0, "real part of the complex index"},
        Parameter{&TwoScale::k, "k", "1", 0, 30, 6.0, "imaginary part of the index, absorption"},
        Parameter{&TwoScale::beta, "beta", "1", 1e-3, 0.5, 0.05, "roughness of the facets"},
        Parameter{&TwoScale::p, "p", "1", 0.2, 5, 0.7, "kurtosis of the facets' slopes, 1 Beckmann"},
        Parameter{&TwoScale::sigma, "sigma", "um", 0, 0.1, 0.02, "height of the finer roughness, RMS"},
        Parameter{&TwoScale::b, "b", "um", 0.3, 100, 2.0, "correlation length of the finer roughness"},
        Parameter{&TwoScale::c, "c", "1", 1.05, 4, 2.0, "power of its spectrum's fall"},
        Parameter{&TwoScale::wavelength, "wavelength", "um", 0.36, 0.83, 0.55,
                  "of each channel; in RGB by default those of the primaries of sRGB", false}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto [wm, valid] = UpperHalfVector<R>(wo, wi);
    const Vec3<R> up{R(0), R(0), R(1)}, o = select(valid, wo, up), i = select(valid, wi, up);
    const auto d = facets();
    const R cos_d = R(0.5f) * (dot(o, wm) + dot(i, wm)); // of both: reciprocal to the last digit
    const R G = visibility(d, o, i);
    const R mirror = d.D(wm) * G, masking = R(4) * G * o.z * i.z;
    Color f;
    for (int n = 0; n < C; ++n) {
      const R share = diffracted_share(cos_d, wavelength[n]);
      const R kept = mirrored_share(cos_d, wavelength[n], share);
      const R haze = (R(1) - kept) * masking * blurred_lobe(wm, cos_d, wavelength[n]) / share;
      f[n] = fresnel_conductor(cos_d, eta[n], k[n]) * (kept * mirror + haze);
    }
    return select(valid, f, Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const R q = mirror_probability(wo);
    return q * facet_reflection_pdf(facets(), wo, wi) + (R(1) - q) * diffraction(wo).pdf(wo, wi);
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const Vec3<R> mirrored = reflect(wo, facets().sample_visible(wo, u));
    const Vec3<R> wi = select(u_lobe < mirror_probability(wo), mirrored, diffraction(wo).sample(wo, u));
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

  MaskingTable<R> prepare() const { return MaskingTable<R>(facets().shape); }
  /// The facets larger than the wavelength, for the validator and plots.
  auto distribution() const { return facets(); }
  R masking_shadowing(const Vec3<R>& wo, const Vec3<R>& wi) const {
    return R(4) * wo.z * wi.z * visibility(facets(), wo, wi);
  }

private:
  /// G2 / (4 cos cos)
  template <class Distribution>
  static R visibility(const Distribution& d, const Vec3<R>& wo, const Vec3<R>& wi) {
    return visibility_van_ginneken(d.lambda_cos(wo), d.lambda_cos(wi), wo.z, wi.z,
                                   azimuth_difference(wo, wi));
  }
  auto facets() const {
    auto d = exponential_power(beta, beta, p);
    d.masking = prepared;
    return d;
  }

  /// sigma_rel^2 / sigma_s^2, eq. 19: the part of the finer roughness whose frequencies scatter at all, on a
  /// facet met at the angle d.
  R diffracted_share(const R& cos_d, const R& lambda) const {
    const ProjectedDiskLobe<R> spectrum{sqr(b / lambda), R(0.5f) * (c + R(1))};
    return max(spectrum.share_in_disk(R(safe_sqrt(R(1) - cos_d * cos_d))), R(1e-6f));
  }
  /// A, eq. 12 with both cosines those of the facet.
  R mirrored_share(const R& cos_d, const R& lambda, const R& share) const {
    const R phase = constant<R>(4 * pi) * sigma * cos_d / lambda;
    return exp(-phase * phase * share);
  }
  /// g^2 / cos_d^2 of eq. 41: width of the lobe, in projected directions. Facets much smoother than the
  /// spectrum leave it (g = u = b cos_d / lambda), much rougher ones give their own: then the peak is D(0).
  R narrowness(const R& cos_d, const R& lambda) const {
    const R limit = R(0.5f) * p * exp(-log_gamma(R(R(1) / p))) / ((c - R(1)) * beta * beta);
    const R b2 = sqr(b / lambda);
    return b2 * limit / (b2 * cos_d * cos_d + limit);
  }
  /// Convolution of the normalised S_HS with the facets' normals, eq. 39; its height follows from its width,
  /// since the integral stays.
  R blurred_lobe(const Vec3<R>& wm, const R& cos_d, const R& lambda) const {
    const R B = narrowness(cos_d, lambda);
    const R fall = log(R(1) + R(4) * B * cos_d * cos_d * sin2_theta(wm));
    return constant<R>(0.5 * inv_pi) * (c - R(1)) * B * wm.z * wm.z * exp(R(-0.5f) * (c + R(1)) * fall);
  }

  // For sampling: as if the facet lay in the surface, and the mean of the channels.
  R mirror_probability(const Vec3<R>& wo) const {
    R kept = R(0);
    for (int n = 0; n < C; ++n)
      kept = kept + mirrored_share(max(wo.z, R(0)), wavelength[n], R(1)) * constant<R>(1.0 / C);
    return R(0.05f) + R(0.9f) * kept;
  }
  ProjectedDiskLobe<R> diffraction(const Vec3<R>& wo) const {
    return {narrowness(wo.z, average(wavelength)), R(0.5f) * (c + R(1))};
  }
};

} // namespace nacre

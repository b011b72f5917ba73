#pragma once
// Reflectance in the adaptive parameterisation of the RGL/EPFL database: `.bsdf` tensor files, RGB or
// spectral, isotropic or anisotropic. Sources: Dupuy and Jakob 2018, An Adaptive Parameterization for
// Efficient Material Acquisition and Rendering; the conventions are those of the format's public readers,
// powitacq (brdf-loader), Mitsuba 3's `measured` and pbrt-v4, which agree.
//
// Fields: theta_i, phi_i (float32, ascending, radians); ndf and sigma [phi][theta]; vndf
// [phi_i][theta_i][phi] [theta]; luminance [phi_i][theta_i][y][x]; spectra [phi_i][theta_i][wavelength][y][x]
// with wavelengths (nm), or rgb [phi_i][theta_i][3][y][x]; description and jacobian (uint8).
// - wi and wo. The direction that tables are conditioned on, the file's omega_i, is Nacre's wo, which the
//   renderer knows, as in Mitsuba and pbrt: so the sampling is the format's own. Nothing makes such a table
//   reciprocal; that of the original files is as good as the instrument was.
// - A direction of polar angle theta and azimuth phi lies at u = sqrt(2 theta / pi), v = (phi + pi) / (2 pi).
// - The half vector wm of wo and wi lies at (u, v), v from the azimuth of wo in isotropic data (one or two
// phi_i).
//   The warp by vndf, inverted, takes it to s in the unit square; there lie spectra and luminance.
// - f cos(theta of wi) = spectra(s) D(wm) / (4 sigma(wo)), with D and sigma from ndf and sigma if `jacobian`
// is
//   set, else spectra(s) alone.
// - Anisotropic data with a symmetry hold a part of the azimuths, phi_i in [-pi, 0] (the surface looks the
// same
//   after half a turn) or [-pi, -pi/2] (mirrored about x and y).
// - Interpolation is bilinear in s, ndf and sigma, linear between phi_i, theta_i and wavelengths, constant
// beyond
//   them; of vndf and luminance the densities are blended. RGB below 0 (spectra out of gamut) counts as 0.
// - Sampling: uniform numbers -> warp by luminance -> s -> warp by vndf -> wm -> wi. A share of 1/16 goes to
// a
//   cosine lobe, which the readers do not have: where the tables' density is 0 and f is not (noise, blending)
//   an estimate stays unbiased.
// - Where luminance and f are both 0 nothing was measured: a hole.

#include "measured/marginal_warp.h"
#include "measured/measured_bsdf.h"

#include <cstdint>

namespace nacre {

/// The fields of a file as they are stored.
struct RglTables {
  std::string description;
  std::vector<float> theta_i, phi_i;  ///< rad
  std::vector<double> wavelengths_nm; ///< empty: linear RGB
  BilinearTable ndf, sigma;
  std::size_t vndf_width = 0, vndf_height = 0;
  std::vector<float> vndf;
  std::size_t width = 0, height = 0; ///< of a slice of luminance and spectra
  std::vector<float> luminance, spectra;
  bool jacobian = true;

  std::size_t channel_count() const { return wavelengths_nm.empty() ? 3 : wavelengths_nm.size(); }
};

class RglBsdf final : public MeasuredBsdf {
public:
  /// @throws Error unless the tables are as parse_rgl demands
  explicit RglBsdf(RglTables tables);

  std::string kind() const override;
  std::vector<std::pair<std::string, std::string>> facts() const override;
  const Channels& channels() const override { return channels_; }
  bool is_isotropic() const override { return isotropic_; }
  bool evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const override;
  SampledSpectrum at(const Vec3d& wo, const Vec3d& wi, const Wavelengths& wavelengths) const override;
  /// Of the nodes: phi_i, theta_i and the points of a slice; weights from the warps' Jacobian.
  MeasuredSamples samples() const override;
  double pdf(const Vec3d& wo, const Vec3d& wi) const override;
  Vec3d sample(const Vec3d& wo, double u_lobe, const Vec2d& u) const override;

  /// What a file of this would hold: vndf and luminance scaled to densities, which means the same.
  RglTables tables() const;
  /// The direction that s goes to, maybe below the horizon, and the density of that map per solid angle.
  std::pair<Vec3d, double> direction(const Vec3d& wo, const Vec2d& s) const;

private:
  /// Where a direction wo lies in the tables.
  struct Known {
    Vec3d w;               ///< turned into the azimuths that are stored
    double flip_x, flip_y; ///< 1 or -1: how it was turned
    double theta, phi;
    SliceBlend blend;
  };
  Known known(const Vec3d& wo) const;
  Vec2d chart(const Known& o, const Vec3d& wm) const;
  double scale(const Known& o, const Vec2d& u_m, double cos_i) const;
  template <class F>
  void for_each_node(const Vec2d& s, const SliceBlend& blend, F f) const;
  std::pair<Vec3d, double> direction(const Known& o, const Vec2d& s) const;

  std::string description_;
  std::vector<float> theta_i_, phi_i_;
  Channels channels_;
  bool isotropic_, jacobian_;
  int reduction_ = 1; ///< the azimuths stored are this part of a turn
  BilinearTable ndf_, sigma_;
  MarginalWarp vndf_, luminance_;
  std::vector<float> spectra_; ///< [phi_i][theta_i][y][x][channel]
};

/// Reads a `.bsdf` tensor file. @throws Error with the byte offset
RglBsdf parse_rgl(std::span<const std::uint8_t> bytes, std::string_view name);
std::vector<std::uint8_t> encode_rgl(const RglTables& tables);

/// How finely a measurement is resampled.
struct RglResolution {
  std::size_t theta_i = 32, phi_i = 1, nodes = 64;
};
/// What `tabulate_rgl` takes: 32 angles and slices of 64 x 64 for isotropic data, 17 azimuths, 16 angles and
/// 32 x 32 for others, coarser where there are many wavelengths.
RglResolution rgl_resolution(const MeasuredBsdf& measured);
/// Any measurement that reflects on the front in this parameterisation; holes become 0. The microfacet
/// distribution comes from its backscattering by power iteration (section 4.1), mixed with 5 % of a constant
/// so that no half vector is out of reach; where backscattering is a hole the nearest angle's is taken.
/// Values are exact at the nodes. Grey becomes RGB.
/// @throws Error if there is no reflection on the front
RglTables tabulate_rgl(const MeasuredBsdf& measured, const RglResolution& resolution);

} // namespace nacre

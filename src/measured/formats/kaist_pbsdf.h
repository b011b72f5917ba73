#pragma once
// Polarimetric reflectance of the KAIST database: `.pbsdf` tensor files, isotropic, Mueller matrices over
// half and difference angles and a few wavelengths. Sources: Baek et al. 2020, Image-Based Acquisition and
// Modeling of Polarimetric Reflectance; the conventions are those of Mitsuba 3's `measured_polarized`.
//
// Fields: phi_d, theta_d, theta_h (float32, 1 x n, radians, ascending); wvls (uint16, nm); M (float32)
// [phi_d][theta_d][theta_h][wavelength][row][column].
// - Angles are those of rusinkiewicz.h, phi_d in [-pi, pi]; wi is where light comes from. The database has
// 361, 91
//   and 91 nodes: phi_d and theta_d a degree apart, theta_h denser at the normal, i^2 / 90 degrees.
// - M[0][0] is f in 1/sr for unpolarised light, without the cosine: the value of this measurement. Below 0
// counts
//   as 0.
// - Stokes frames (x, y, z), right-handed, z where the light goes: -wi before and wo after. x is
// perpendicular to
//   the plane of wi and wo, along wi x wo, for both, so Q > 0 is polarised perpendicular to it, as in
//   optics/mueller.h. At wo = wi, where there is no plane, any frame is as good.
// - Interpolation is linear in phi_d (periodic), theta_d, theta_h and wavelength, constant beyond the last
// nodes.
// - A node is a hole where an M[0][0] is NaN or all are 0: below the horizon and where nothing was seen.
// Holes
//   take no part in an interpolation: the weights of the others are scaled to sum to 1.
// - Public test data at reduced resolution come with axes of no elements (0 x n): then every s-th node of the
//   database's own is meant. s follows from n: 17 for 22 phi_d, 11 for 9 theta_d or theta_h.

#include "measured/measured_bsdf.h"
#include "optics/mueller.h"

#include <array>
#include <cstdint>
#include <optional>

namespace nacre {

/// Angles in radians, ascending; entries as in the file.
struct MuellerTable {
  std::vector<double> phi_d, theta_d, theta_h, wavelengths_nm;
  std::vector<float> entries; ///< [phi_d][theta_d][theta_h][wavelength][row][column]
  bool axes_assumed = false;
};

class KaistPbsdf final : public MeasuredBsdf {
public:
  /// @throws Error if sizes disagree, an axis does not ascend or a known entry is not finite
  explicit KaistPbsdf(MuellerTable table);

  std::string kind() const override { return "isotropic polarimetric reflectance table (KAIST)"; }
  std::vector<std::pair<std::string, std::string>> facts() const override;
  const Channels& channels() const override { return channels_; }
  bool is_isotropic() const override { return true; }
  bool evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const override;
  MeasuredSamples samples() const override;

  /// What the surface does to polarised light, 1/sr, in the frames above. Nothing in a hole or below the
  /// surface.
  std::optional<Mueller<double>> mueller(const Vec3d& wo, const Vec3d& wi, double wavelength_nm) const;

  const MuellerTable& table() const { return table_; }
  std::size_t hole_count() const { return holes_; }
  bool is_known(std::size_t node) const { return known_[node] != 0; }

private:
  struct Nodes {
    std::size_t count = 0;
    std::array<std::size_t, 8> index;
    std::array<double, 8> weight; ///< of known nodes, sum 1
  };
  Nodes nodes(const Vec3d& wo, const Vec3d& wi) const;

  MuellerTable table_;
  Channels channels_;
  std::vector<std::uint8_t> known_;
  std::vector<float> intensity_; ///< the M[0][0] of a node side by side: a fifth of the memory traffic
  std::size_t holes_ = 0;
};

/// Reads a `.pbsdf` file. @throws Error with the byte offset
KaistPbsdf parse_kaist(std::span<const std::uint8_t> bytes, std::string_view name);

} // namespace nacre

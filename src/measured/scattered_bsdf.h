#pragma once
// Measured scattering as samples that lie anywhere: lists of goniophotometers, in any order.
//
// Samples are kept by side (reflection or transmission, light in front or behind) and compared in half
// vectors, where a highlight rests while the incidence moves; wo behind the surface is mirrored to wi's side
// first.
//
// Where directions of incidence repeat (four samples each or more, on average), every one of them has its own
// mesh: the samples' half vectors, seen from above, joined to triangles (Delaunay) and interpolated linearly.
// The directions of incidence are joined in the same way, over (theta_i cos phi_i, theta_i sin phi_i). A pair
// of directions takes the triangle of incidences around its wi, looks up its own half vector in each of their
// meshes, and mixes the three values. Isotropic samples are turned to phi_i = 0 first, so that the value is
// linear in theta_i at a fixed half vector; at theta_i = 0 they depend on the half vector's polar angle
// alone.
//
// Samples with as many incidences as samples form a cloud in (h, d): the half vector in polar form with
// radius sqrt(theta_h pi/2), as in MERL's tables, and wi about it with radius theta_d (Rusinkiewicz 1998).
// The 12 nearest are mixed with weights ((R - r) / (R r))^2, R the distance of the 13th (Franke and Nielson
// 1980).
//
// Both give the samples at the samples (the mean, where several share their directions), are continuous, and
// never leave the range of the samples used.
//
// Covered, so that evaluate is true: with meshes, wi within the hull of the incidences and the half vector
// within the hull of the samples of at least one of them, where both may be left by half a degree or by 0.15
// of the side of the triangle nearby (values of the border then fade out), and no side is longer than 0.5 (in
// a unit half vector, about 60 degrees of wo) unless a sample lies within half a degree. In a cloud, where
// the nearest sample is not farther than its own eighth neighbour.

#include "measured/measured_bsdf.h"

#include <array>

namespace nacre {

class ScatteredBsdf final : public MeasuredBsdf {
public:
  enum class Symmetry {
    found,     ///< isotropic where all light comes from one azimuth (or along the normal), and then
               ///< bilateral where all samples lie on one side of the plane of incidence
    none,      ///< anisotropic
    isotropic, ///< samples may be turned about the normal
    bilateral, ///< isotropic, and mirrored at the plane of incidence
  };

  /// @param samples  unit directions with z != 0, values finite; the weights are not used
  /// @throws Error where there is no sample or one is not valid
  ScatteredBsdf(MeasuredSamples samples, Channels channels, Symmetry symmetry, std::string kind,
                std::vector<std::pair<std::string, std::string>> facts = {});
  ~ScatteredBsdf() override;

  std::string kind() const override { return kind_; }
  std::vector<std::pair<std::string, std::string>> facts() const override;
  const Channels& channels() const override { return channels_; }
  bool is_isotropic() const override { return isotropic_; }
  MeasuredSides sides() const override { return sides_; }
  bool evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const override;
  MeasuredSamples samples() const override { return samples_; }

private:
  class Side;

  MeasuredSamples samples_;
  Channels channels_;
  std::string kind_;
  std::vector<std::pair<std::string, std::string>> facts_;
  bool isotropic_ = false, bilateral_ = false;
  MeasuredSides sides_;
  std::array<std::unique_ptr<const Side>, 4> side_; ///< by wo behind, wi behind
};

} // namespace nacre

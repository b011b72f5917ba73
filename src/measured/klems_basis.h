#pragma once
// Klems' division of a hemisphere into patches: rings of polar angle, each cut into equal sectors of azimuth.
// Source: Klems 1994, A New Method for Predicting the Solar Heat Gain of Complex Fenestration Systems; the
// standard bases are those of LBNL's WINDOW (Windows-CalcEngine, BSDFDirections). Conventions as in
// Radiance's bsdf library: patches are counted from the pole outwards, in a ring by azimuth from x to y, and
// the first is centred on azimuth 0.

#include "core/vec.h"

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace nacre {

class KlemsBasis {
public:
  static constexpr int max_patches = 4096;

  struct Ring {
    double lower_deg, upper_deg; ///< of the polar angle
    int sectors;
  };
  /// @throws Error unless the rings follow each other from 0 to 90 degrees and have 1 to max_patches patches
  KlemsBasis(std::string name, std::vector<Ring> rings);
  /// "LBNL/Klems Full" (145 patches), Half (77) and Quarter (41); last another Half (73), which Radiance
  /// wrote until 2022.
  static std::span<const KlemsBasis> standard();

  const std::string& name() const { return name_; }
  const std::vector<Ring>& rings() const { return rings_; }
  int size() const { return int(ring_of_.size()); }

  /// The patch of a direction in the upper hemisphere; below it counts as at the horizon.
  int patch(const Vec3d& w) const;
  /// Its direction for u in [0, 1)^2, uniform in projected solid angle: {.5, .5} is its middle.
  Vec3d direction(int patch, const Vec2d& u) const;
  /// Integral of |cos theta| over a patch, sr.
  double projected_solid_angle(int patch) const { return projected_[std::size_t(patch)]; }
  double solid_angle(int patch) const;

private:
  std::string name_;
  std::vector<Ring> rings_;
  std::vector<int> first_;   ///< patch of each ring, and the count of all
  std::vector<int> ring_of_; ///< of each patch
  std::vector<double> projected_;
  std::vector<double> lower_cos_; ///< of each ring, and 0
};

} // namespace nacre

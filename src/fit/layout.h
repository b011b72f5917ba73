#pragma once
// The vector of numbers that a fit varies, and its translation from and to a material.

#include "measured/material_spec.h"

#include <span>
#include <vector>

namespace nacre {

/// One number of a material that a fit varies, in the range its model declares.
///
/// The optimiser sees it as a coordinate: the logarithm of the value where the domain is positive and spans a
/// factor of 100 or more (roughness, index of a metal), the value itself otherwise. A step then means the
/// same share of the value everywhere, and random starts are even in scale.
struct FreeParameter {
  int lobe, parameter;
  int channel; ///< -1: one number for all channels
  double lo, hi;
  bool logarithmic;
  int tied = -1; ///< parameter of the same lobe that takes the same value; -1: none

  double coordinate(double value) const;
  double value(double coordinate) const; ///< never outside [lo, hi]
  double slope(double coordinate) const; ///< d value / d coordinate
  double coordinate_lo() const { return coordinate(lo); }
  double coordinate_hi() const { return coordinate(hi); }
};

/// The free parameters of a material: all that are declared `fitted`, a per-channel one three times.
class ParameterLayout {
public:
  /// @param start      gives the lobes and the values of parameters that are not fitted
  /// @param isotropic  parameters named alike up to a final _x and _y are one
  /// @throws Error for a measured lobe
  ParameterLayout(MaterialSpec start, bool isotropic);

  int size() const { return int(free_.size()); }
  const FreeParameter& operator[](int i) const { return free_[std::size_t(i)]; }
  const MaterialSpec& start() const { return start_; }
  /// The free parameter behind a declared one in a channel; -1 if it is not fitted.
  int index(int lobe, int parameter, int channel) const;
  /// "ggx_schlick.f0.r"
  std::string label(int i) const;

  std::vector<double> coordinates(const MaterialSpec& material) const;
  MaterialSpec material(std::span<const double> coordinates) const;

private:
  MaterialSpec start_;
  std::vector<FreeParameter> free_;
  std::vector<std::vector<std::array<int, 3>>> index_; ///< [lobe][parameter][channel]
};

} // namespace nacre

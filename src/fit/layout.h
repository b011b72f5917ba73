#pragma once
// The vector of numbers that a fit varies, and its translation from and to a material.

#include "measured/material_spec.h"

#include <optional>
#include <span>
#include <vector>

namespace nacre {

/// One number of a material that a fit varies, in the range its model declares or the user allows.
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

/// What a user says of parameters by name. A name is that of a parameter, in all lobes ("alpha"), or with its
/// model in front, numbered where the model comes twice ("ggx_schlick.alpha", "ggx_schlick#2.alpha").
struct ParameterRules {
  struct Bound {
    std::string name;
    double lo, hi;
  };
  struct Fixed {
    std::string name;
    std::optional<double> value; ///< none: as the material gives it
  };
  /// The measurement has no tangent: parameters named alike up to a final x and y, or u and v, are one, and
  /// those that stretch a highlight (anisotropic, anisotropy, ...) stay as the material has them.
  bool isotropic = true;
  std::vector<std::string> shared = {}; ///< parameters of each channel's own: one number for all channels
  std::vector<std::string> freed = {};  ///< vary too, though declared as not fitted
  std::vector<Fixed> fixed = {};        ///< stay at a value
  std::vector<Bound> bounds = {};       ///< narrower than, never beyond the declared domain
};

/// The free parameters of a material: all that are declared `fitted`, a per-channel one three times, as the
/// rules have it.
class ParameterLayout {
public:
  /// @param start  gives the lobes and the values of parameters that do not vary; values outside the bounds
  ///               are moved to the nearest end
  /// @throws Error for a measured lobe, a switch that is to vary, a rule that names no parameter (with the
  /// nearest name), one that does not apply or goes against another, bounds outside the domain, or when
  /// nothing is left to vary
  explicit ParameterLayout(MaterialSpec start, const ParameterRules& rules = {});

  int size() const { return int(free_.size()); }
  const FreeParameter& operator[](int i) const { return free_[std::size_t(i)]; }
  const MaterialSpec& start() const { return start_; }
  /// The free parameter behind a declared one in a channel; -1 if it does not vary.
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

/// Whether both lobes are of one model, of the list or of one .brdf file.
bool same_model(const LobeSpec& a, const LobeSpec& b);
/// "ggx_schlick", or the file's name; "ggx_schlick#2" where the material has several lobes of that model.
std::string lobe_label(const MaterialSpec& material, int lobe);

} // namespace nacre

#pragma once
// What the validator judges: a scattering function known by what it answers.

#include "measured/material_spec.h"

#include <functional>

namespace nacre {

/// What lies on the two sides of a surface.
struct Sides {
  bool transmits = false;
  double eta = 1; ///< index inside / index outside

  /// @throws Error if lobes that transmit disagree about eta
  static Sides of(const MaterialSpec& material);
};

/// The facets that a model is made of.
struct FacetSurface {
  std::string name;
  std::function<double(const Vec3d& wm)> D;                   ///< 1/sr
  std::function<double(const Vec3d& w, const Vec3d& wm)> G1;  ///< masking
  std::function<double(const Vec3d& wo, const Vec3d& wi)> G2; ///< masking and shadowing, at the half vector
};

/// A scattering function: a model of the list, measured, or somebody's own.
struct Scattering {
  std::function<Spectrum<double, 3>(const Vec3d& wo, const Vec3d& wi)> eval;
  std::function<double(const Vec3d& wo, const Vec3d& wi)> pdf;
  std::function<BsdfSample<double, 3>(const Vec3d& wo, double u_lobe, Vec2<double> u)> sample;
  bool stochastic = false; ///< as Laws::stochastic
  std::vector<FacetSurface> facets = {};

  static Scattering of(const Bsdf<double, 3>& bsdf);
  static Scattering of(const MaterialSpec& material);
};

} // namespace nacre

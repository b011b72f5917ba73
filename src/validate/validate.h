#pragma once
// Judges a material by the laws that reflectance obeys: how far each is kept or broken, and where.

#include "measured/material_spec.h"

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace nacre {

enum class Verdict { holds, violated };

struct LawResult {
  std::string law;      ///< "reciprocity", "energy conservation", ...
  std::string measures; ///< what `worst` is, in words
  Verdict verdict = Verdict::holds;
  double worst = 0;       ///< the largest departure found
  double error = 0;       ///< uncertainty of `worst` from quadrature or sampling; 0 where evaluation is exact
  double tolerance = 0;   ///< departures up to this one hold
  std::string where = {}; ///< directions of the worst case, degrees
  std::string command = {}; ///< a command that shows the worst case again
};

/// Directional albedo, linear RGB, over the angle of incidence.
struct AlbedoSample {
  double theta_deg;
  std::array<double, 3> albedo;
  double error;
};

struct ValidationReport {
  std::string material;
  std::vector<LawResult> laws;
  std::vector<AlbedoSample> albedo;
  double seconds = 0;
  bool holds() const;
};

struct ValidateOptions {
  int directions = 20000; ///< random pairs for positivity, reciprocity and finiteness
  int samples = 50000;    ///< per angle for the sampling laws
  std::uint64_t seed = 1;
  double significance = 0.01; ///< of the chi-square tests together, Sidak-corrected over the angles
};

/// Evaluates in double precision. Laws: finiteness at adversarial directions, positivity, Helmholtz
/// reciprocity (with the eta^2 of transmission), energy conservation, normalisation of the pdf, agreement of
/// sample with eval and pdf, chi-square of the sampled directions against the pdf, and albedo by sampling
/// against quadrature.
/// @throws Error if the material cannot be evaluated at all
ValidationReport validate(const MaterialSpec& material, const ValidateOptions& options = {});

/// What lies on the two sides of a surface.
struct Sides {
  bool transmits = false;
  double eta = 1; ///< index inside / index outside
};

/// A scattering function known by what it answers alone: a model of the list, measured, or somebody's own.
struct Scattering {
  std::function<Spectrum<double, 3>(const Vec3d& wo, const Vec3d& wi)> eval;
  std::function<double(const Vec3d& wo, const Vec3d& wi)> pdf;
  std::function<BsdfSample<double, 3>(const Vec3d& wo, double u_lobe, Vec2<double> u)> sample;
  static Scattering of(const Bsdf<double, 3>& bsdf);
};

/// The same for any scattering function, with what only its description knows.
/// @param name  a MATERIAL for the commands that show a violation again
ValidationReport validate(const Scattering& bsdf, const std::string& name, const Sides& sides,
                          const ValidateOptions& options = {});

nlohmann::json to_json(const ValidationReport& report);
/// A table for a terminal of 100 columns.
std::string to_text(const ValidationReport& report);

} // namespace nacre

#pragma once
// Judges a material by the laws that reflectance obeys: how far each is kept or broken, and where.

#include "measured/material_spec.h"
#include "validate/scattering.h"

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace nacre {

enum class Verdict {
  holds,
  violated,
  stated, ///< a property to be known, neither right nor wrong
};

struct LawResult {
  std::string law;      ///< "reciprocity", "energy conservation", ...
  std::string measures; ///< what `worst` is, in words
  Verdict verdict = Verdict::holds;
  double worst = 0;       ///< the largest departure found
  double error = 0;       ///< uncertainty of `worst` from quadrature or sampling; 0 where evaluation is exact
  double tolerance = 0;   ///< departures up to this one hold
  std::string where = {}; ///< directions or parameters of the worst case, angles in degrees
  std::string command = {};              ///< a command that shows the worst case again
  std::optional<Vec3d> wo = {}, wi = {}; ///< those directions, where the law is about one or a pair
};

/// Directional albedo, linear RGB, over the angle of incidence: directional-hemispherical reflectance, by
/// reciprocity the hemispherical-directional one too; with what is transmitted. At an azimuth of 0.4 rad.
struct AlbedoSample {
  double theta_deg;
  std::array<double, 3> albedo;
  double error;
};

struct ValidationReport {
  std::string material;
  std::vector<LawResult> laws;
  std::vector<AlbedoSample> albedo;
  /// Share of uniform diffuse light that leaves again (bihemispherical reflectance).
  std::array<double, 3> bihemispherical{}, bihemispherical_error{};
  double seconds = 0;
  bool holds() const;
};

struct ValidateOptions {
  int directions = 20000; ///< random pairs for positivity, reciprocity and finiteness
  int samples = 50000;    ///< per angle for the sampling laws
  std::uint64_t seed = 1;
  double significance = 0.01; ///< of the chi-square tests together, Sidak-corrected over the angles
  /// Shown the report each time that laws were added to it.
  std::function<void(const ValidationReport&)> on_laws = {};
  /// Asked now and then, from any thread; true ends the validation with an Error.
  std::function<bool()> stopped = {};
};

/// Evaluates in double precision, by all laws of docs/validate.md.
/// @throws Error if the material cannot be evaluated at all
ValidationReport validate(const MaterialSpec& material, const ValidateOptions& options = {});

/// The same for any scattering function; the laws that vary a model's parameters are left out.
/// @param name  a MATERIAL, as an argument of the commands that show a violation again
ValidationReport validate(const Scattering& bsdf, const std::string& name, const Sides& sides,
                          const ValidateOptions& options = {});

nlohmann::json to_json(const ValidationReport& report);
/// A table for a terminal of 100 columns.
std::string to_text(const ValidationReport& report);

} // namespace nacre

#pragma once
// Parameters of a reflectance model from a measurement, by non-linear least squares from several starts.

#include "fit/metric.h"
#include "measured/material_spec.h"

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace nacre {

struct FitOptions {
  /// One to three models of the list, "ggx_schlick+lambert", or a material with values: they are the first
  /// start, and those of parameters that are not fitted stay.
  std::string model = "ggx_schlick+lambert";
  Metric metric = Metric::log;
  int starts = 16;           ///< starting points: the material as given, then random ones inside the bounds
  int refined = 3;           ///< how many of the optima found on the coarse grid go on to the fine one
  std::uint64_t seed = 0;    ///< of the random starts
  double max_theta_deg = 80; ///< cut at grazing angles, both directions
  /// The grid of residuals: all theta_h of the table (they are dense at the peak), every n-th theta_d and
  /// phi_d. 0: such that some 30 of each are kept. The coarse grid keeps every second theta_h and every third
  /// node of this grid in theta_d and phi_d.
  int theta_d_step = 0, phi_d_step = 0;
  /// Parameters named alike up to a final _x and _y are one. The table is isotropic.
  bool isotropic = true;
  int max_iterations = 200;
};

struct FittedParameter {
  std::string label; ///< "ggx_schlick.f0.r"
  std::string model, name, unit;
  int lobe = 0;     ///< from 0
  int channel = -1; ///< 0, 1, 2: red, green, blue; -1: one number for all
  double value = 0, lo = 0, hi = 0;
  double standard_error = 0;      ///< robust against uneven noise, see fit/uncertainty.h; NaN: there is none
  double uniform_noise_error = 0; ///< for noise that is the same in every weighted residual; NaN likewise
  bool at_bound = false;          ///< held by its domain: the error bar says nothing
  bool identifiable = true;       ///< false: the data do not determine it, or not to within half its domain
  std::string partner;            ///< label of the parameter it is most correlated with
  double correlation = 0;
  std::string tied; ///< name of the parameter that takes the same value, or empty
};

struct FitStart {
  double coarse_error = 0;   ///< E reached on the coarse grid; infinite if the model had no finite value
  double refined_error = -1; ///< E reached on the fine grid; -1: not refined
  int iterations = 0;
};

struct FitResult {
  MaterialSpec material;
  std::vector<FittedParameter> parameters;
  Metric metric = Metric::log;
  MetricErrors errors;   ///< over the full table
  double fit_error = 0;  ///< E over the grid of the fit
  std::size_t nodes = 0; ///< of that grid; three residuals each
  int theta_d_step = 0, phi_d_step = 0;
  double max_theta_deg = 0;
  bool isotropic = true;
  std::vector<FitStart> starts;
  int best_start = 0;
  int iterations = 0; ///< of the best start
  bool converged = false;
  std::string message; ///< why the optimiser stopped
  double seconds = 0;
};

/// All but `seconds` depends on the arguments alone, not on the number of threads.
/// @throws Error for a model that cannot be fitted (unknown, measured, a mirror), options out of range, or a
/// table without enough entries
FitResult fit(const MeasuredBsdf& measured, const FitOptions& options = {});

/// The material as `material_from_json` reads it, and the rest under "fit"; numbers that are not finite are
/// null.
nlohmann::json to_json(const FitResult& result);

} // namespace nacre

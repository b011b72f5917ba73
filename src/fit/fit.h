#pragma once
// Parameters of a reflectance model from a measurement, by non-linear least squares from several starts.

#include "fit/layout.h"
#include "fit/lit_sphere.h"
#include "fit/metric.h"
#include "fit/robust_loss.h"
#include "measured/material_spec.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace nacre {

/// A fit on its way.
struct FitProgress {
  const MaterialSpec& material; ///< the best so far
  double error;                 ///< E over the nodes that are looked at now, in the fit's metric
  int iterations;               ///< steps taken so far, of all descents
  double share;                 ///< of the descents that ended, [0, 1]
};

struct FitOptions {
  /// One to four models of the list or .brdf files, "ggx_schlick+lambert", or a material with values: they
  /// are the first start, and those of parameters that are not fitted stay.
  std::string model = "ggx_schlick+lambert";
  FileFinder find_file = {}; ///< of the files that `model` names; none: as they are written
  Metric metric = Metric::log;
  int starts = 12;           ///< descents on the coarse grid: from the material as given, then from the best
                             ///< points of the screening
  int refined = 3;           ///< how many of the optima found on the coarse grid go on to the fine one
  std::uint64_t seed = 0;    ///< of the points of the screening
  double max_theta_deg = 80; ///< cut at grazing angles, both directions
  /// The grid of residuals: all theta_h of the table (they are dense at the peak), every n-th theta_d and
  /// phi_d. 0: such that some `kept_angles` of each are kept. The coarse grid keeps every second theta_h and
  /// every third node of this grid in theta_d and phi_d.
  int theta_d_step = 0, phi_d_step = 0;
  /// The table is isotropic, and so is the material: see ParameterRules.
  bool isotropic = true;
  int max_iterations = 200;
  int kept_angles = 30;
  int screened = 512;     ///< points of the domain that are tried before any descent
  bool every_node = true; ///< the last steps look at all nodes of a table, not those of the fit's grid alone
  RobustLoss loss = {};   ///< of a residual, in the metric's unit
  int channel = -1;       ///< 0, 1, 2: only red, green or blue; the material is then grey
  ParameterRules rules = {};    ///< what is shared, freed, fixed or bounded; its `isotropic` is the one above
  double confidence = 0.99;     ///< that all stated intervals together hold the truth
  bool images = false;          ///< compare lit spheres too
  std::string environment = {}; ///< picture whose light falls on the spheres; empty: studio_lights()
  /// Told of every state that is better than those before it; where the nodes become more, comparison begins
  /// anew. One call at a time, from any thread.
  std::function<void(const FitProgress&)> on_better = {};
  /// Asked after every step, from any thread; true ends the fit with an Error, as Ctrl-C does.
  std::function<bool()> stopped = {};
};

struct FittedParameter {
  std::string label; ///< "ggx_schlick.f0.r"
  std::string model, name, unit;
  int lobe = 0;     ///< from 0
  int channel = -1; ///< 0, 1, 2: red, green, blue; -1: one number for all
  double value = 0, lo = 0, hi = 0;
  double standard_error = 0;      ///< robust against uneven noise, see fit/uncertainty.h; NaN: there is none
  double uniform_noise_error = 0; ///< for noise that is the same in every weighted residual; NaN likewise
  bool at_bound = false;          ///< held by its domain: the standard error says nothing
  bool identifiable = true;       ///< false: the data do not determine it, or not to within half its domain
  std::string partner;            ///< label of the parameter it is most correlated with
  double correlation = 0;
  std::string tied; ///< name of the parameter that takes the same value, or empty
  /// Holds the true value, with those of all other parameters at once, with FitOptions::confidence; the whole
  /// domain where the data do not determine the parameter.
  double interval_lo = 0, interval_hi = 0;
  /// With every parameter of the fit, in their order; of the standard errors, and NaN where there is none.
  std::vector<double> covariance = {};
  double uncertainty() const { return std::max(interval_hi - value, value - interval_lo); }
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
  double fit_error = 0;  ///< E over the nodes that the last steps looked at, with the loss
  std::size_t nodes = 0; ///< of the grid of the fit; three residuals each
  int theta_d_step = 0, phi_d_step = 0;
  double max_theta_deg = 0;
  bool isotropic = true;
  std::vector<FitStart> starts;
  int best_start = 0;
  int iterations = 0; ///< of the best start
  bool converged = false;
  std::string message; ///< why the optimiser stopped
  double seconds = 0;
  RobustLoss loss; ///< with the scale that was used
  int channel = -1;
  double confidence = 0;
  ImageErrors images; ///< if they were asked for
};

/// What fits of several models to one measurement share: its nodes, picked out once. Immutable but for what
/// it makes on demand; may be used from many threads.
class FitData {
public:
  /// The measurement outlives it.
  explicit FitData(const MeasuredBsdf& measured);
  ~FitData();
  const MeasuredBsdf& measured() const { return measured_; }

private:
  friend FitResult fit(const FitData& data, const FitOptions& options);
  struct Grids;
  const MeasuredBsdf& measured_;
  std::unique_ptr<Grids> grids_;
};

/// All but `seconds` depends on the arguments alone, not on the number of threads.
/// @throws Error for a model that cannot be fitted (unknown, measured, a mirror, one whose value is an
/// estimate by chance), options out of range, or a table without enough entries
FitResult fit(const FitData& data, const FitOptions& options = {});
FitResult fit(const MeasuredBsdf& measured, const FitOptions& options = {});

/// Whether the residuals of a model are exact and it reflects on the front: what `fit` accepts, but for
/// mirrors.
bool can_be_fitted(const ModelInfo& model);
/// The materials that a fit to all models tries: every model that can be fitted, with a Lambertian beside it
/// where the model has no diffuse part of its own.
std::vector<std::string> fittable_materials();

/// Options for one of many models that are to be ranked: fewer nodes, errors to some two digits.
FitOptions ranking_options(const std::string& material, FitOptions options = {});

/// The material as `material_from_json` reads it, and the rest under "fit"; numbers that are not finite are
/// null.
nlohmann::json to_json(const FitResult& result);

} // namespace nacre

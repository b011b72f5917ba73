#pragma once
// The whole way in one call: a measured material is read, fitted, validated, rendered beside its fit, and
// reported.

#include "fit/fit.h"
#include "validate/validate.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace nacre {

struct DemoStep {
  std::string name; ///< "fit"
  std::string what; ///< what came out, in a line
  double seconds = 0;
};

struct DemoOptions {
  std::string file;                               ///< a MERL table; empty: a published material
  std::string published = "gold-metallic-paint";  ///< its name, if there is no file
  std::string folder = "nacre-demo";              ///< made if it does not exist
  std::string environment;                        ///< latitude-longitude picture; empty: sun and sky
  FitOptions fit{.starts = 8, .refined = 2};      ///< model, metric, starts
  int width = 480, height = 360;                  ///< of each render
  int samples_per_pixel = 64;                     ///< of each render
  std::uint64_t seed = 0;                         ///< of fit, validation and renders
  ValidateOptions validate;                       ///< its seed is replaced by `seed` + 1
  std::string command;                            ///< for the report: what the user typed
  bool quiet = true;                              ///< no progress on standard error
  std::function<void(const DemoStep&)> on_step{}; ///< told after each step
};

struct DemoResult {
  std::string report, picture; ///< paths of the files to look at first
  MaterialSpec measured;
  FitResult fit;
  ValidationReport measured_validation, fit_validation;
  double rmse = 0;               ///< between the renders, linear, after exposure
  double flip = 0, hdr_flip = 0; ///< means over the picture
  std::vector<DemoStep> steps;
  double seconds = 0;
};

/// Leaves in the folder: report.html, picture.png (measured, fit, difference side by side), measured.exr,
/// fit.exr, fit.json, and for a published material NAME.binary. After a failure no file is left that was not
/// there before. A measurement that breaks a law is a finding of the report, not a failure.
/// @throws Error
DemoResult run_demo(const DemoOptions& options);

} // namespace nacre

#pragma once
// Every model of the list side by side: what it keeps, what it costs, how well it is sampled.

#include "measured/material_spec.h"

#include <string>
#include <vector>

namespace nacre {

struct ModelMeasurement {
  const ModelInfo* model;
  std::vector<std::string> violated; ///< laws that the validator finds broken at the default parameters
  double float_rate, pack_rate; ///< evaluations a second on one core: float at 4 wavelengths, packs in RGB
  double pdf_rate, sample_rate; ///< the same of pdf and sample, float
  double sampling_variance;     ///< the largest of 0, 30, 60 and 80 degrees
};

/// Variance of f cos / pdf (the average channel) over its squared mean, for directions that the material
/// chooses itself: what one sample adds to a pixel under uniform light.
/// @param theta_rad  of the viewer, in [0, pi/2)
double sampling_variance(const MaterialSpec& material, double theta_rad, int samples = 20000);

/// Processor time of this thread so far: what else the machine does is not in it.
double cpu_seconds();

/// One after the other, timing alone on one thread; some half a second a model.
ModelMeasurement measure(const ModelInfo& model);

/// A page of the docs.
std::string model_table_markdown(const std::vector<ModelMeasurement>& rows);

} // namespace nacre

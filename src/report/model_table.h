#pragma once
// Every model of the list side by side: what it keeps, what it costs, how well it is sampled.

#include "bsdf/list.h"

#include <string>
#include <vector>

namespace nacre {

struct ModelMeasurement {
  const ModelInfo* model;
  std::vector<std::string> violated; ///< laws that the validator finds broken at the default parameters
  double float_rate, pack_rate; ///< evaluations a second on one core: float at 4 wavelengths, packs in RGB
  double pdf_rate, sample_rate; ///< the same of pdf and sample, float
  /// Variance of f cos / pdf over its squared mean (the average channel), largest over 0, 30, 60 and 80
  /// degrees: what one sample adds to a pixel under uniform light.
  double sampling_variance;
};

/// One after the other, timing alone on one thread; some half a second a model.
ModelMeasurement measure(const ModelInfo& model);

/// A page of the docs.
std::string model_table_markdown(const std::vector<ModelMeasurement>& rows);

} // namespace nacre

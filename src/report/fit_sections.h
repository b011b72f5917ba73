#pragma once
// A fit, its validation and its plots as sections of an HTML page.

#include "fit/fit.h"
#include "report/svg_plot.h"
#include "validate/validate.h"

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace nacre {

/// Text form of a material of listed models, values to four digits.
std::string readable_text(MaterialSpec material);
/// "ggx_schlick + lambert"
std::string model_names(const MaterialSpec& material);

std::string plots_section(const std::vector<Plot>& plots);
/// Parameters with uncertainty, errors in every metric, how the optimum was found.
std::string fit_section(const FitResult& fit);
/// Fits of several models to one measurement, as they are ordered.
std::string ranking_section(std::span<const FitResult> fits);

struct ValidatedMaterial {
  std::string name; ///< "measured"
  const ValidationReport* report;
};
/// The laws side by side for one or two materials, and what is violated where.
std::string validation_section(std::span<const ValidatedMaterial> materials);
/// Class of the page's style and text of a verdict.
std::pair<const char*, const char*> verdict_mark(Verdict verdict);
/// "holds" or how many laws are violated, in colour.
std::string html_verdict(const ValidationReport& report);

} // namespace nacre

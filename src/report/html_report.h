#pragma once
// A demo's findings as one HTML page that needs nothing else: no script from elsewhere, no font, no network.

#include "report/demo.h"
#include "report/pictures.h"
#include "report/svg_plot.h"

#include <string>
#include <vector>

namespace nacre {

struct DemoFindings {
  std::string material, source; ///< its name, and where it came from in words
  std::string environment;      ///< what lights the previews, in words
  std::string command, version;
  const FitResult* fit;
  const ValidationReport *measured_validation, *fit_validation;
  const ComparedPictures* pictures;
  int width, height, samples_per_pixel; ///< of the renders
  std::vector<Plot> plots;
  std::vector<DemoStep> steps;
};

std::string html_report(const DemoFindings& findings);

} // namespace nacre

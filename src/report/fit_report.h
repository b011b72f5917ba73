#pragma once
// A fit on one HTML page: parameters and how sure they are, errors, measured and fitted curves, pictures of
// both, the laws the result keeps, and the ranking where several models were fitted.

#include "fit/fit.h"

#include <memory>
#include <string>
#include <vector>

namespace nacre {

struct FitReport {
  std::string title;            ///< what was measured
  std::string source;           ///< the file it came from
  std::string command, version; ///< by which the page was made
  std::shared_ptr<const MeasuredBsdf> measured;
  std::vector<FitResult> fits; ///< best first; the page describes the first, and ranks all
};

/// The page; it needs nothing else.
std::string fit_report_html(const FitReport& report);

/// A file if `path` ends in .html, else a folder, made if missing, that gets report.html and fit.json, the
/// first fit as a material. Whole or not at all.
/// @return the path of the page @throws Error
std::string write_fit_report(const FitReport& report, const std::string& path);

} // namespace nacre

#pragma once
// nacre fit with several files, folders, --database or --study: many fits, kept in a database.

#include "fit/fit.h"

namespace nacre {

struct FitBatch {
  std::vector<std::string> paths;  ///< files and folders
  std::vector<std::string> models; ///< empty: those of a study
  FitOptions fit;
  std::string database;  ///< empty: fits.sqlite in the study's folder, or in the current one
  std::string study;     ///< folder for tables and figures; empty: the standings on the terminal alone
  std::string command;   ///< for the page
  bool retry = false;    ///< try again what failed before
  bool thorough = false; ///< all steps of a fit, not what a ranking needs
  bool quiet = false, json = false;
};

/// The models of Ngan et al. 2005 and later ones with as few parameters, each with a Lambertian base where it
/// has no diffuse part of its own.
std::vector<std::string> study_models();

void run_fit_batch(const FitBatch& batch);

} // namespace nacre

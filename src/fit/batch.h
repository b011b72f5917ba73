#pragma once
// Many measurements times many models.

#include "fit/fit_store.h"

namespace nacre {

struct BatchResult {
  std::size_t done = 0, skipped = 0, failed = 0; ///< skipped: were in the store already
  bool stopped = false;                          ///< by Ctrl-C; the store holds what was done
  std::vector<StoredFit> failures = {};          ///< what failed now
};

/// The measurements among files and folders, folders searched one level deep, sorted by name.
/// @throws Error for a path that is neither, or if there is none at all
std::vector<std::string> measured_files(const std::vector<std::string>& paths);

/// Fits every model to every measurement and puts each result into the store; what is there already is left
/// out. A file that cannot be read, or a fit that fails, is a row that says why and stops nothing.
/// @param models  as FitOptions::model, whose own value is ignored
BatchResult fit_all(const std::vector<std::string>& files, const std::vector<std::string>& models,
                    const FitOptions& options, FitStore& store, bool quiet);

} // namespace nacre

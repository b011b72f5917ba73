#pragma once
// Which model describes which material: the tables and figures of a study such as Ngan, Durand, Matusik 2005,
// Experimental Analysis of BRDF Models, made from a store of fits.

#include "fit/fit_store.h"
#include "report/svg_plot.h"

namespace nacre {

/// Errors of models (columns) over materials (rows).
struct Study {
  std::string metric;
  std::vector<std::string> materials; ///< from the one that is described best by its best model to the worst
  std::vector<std::string> models;    ///< from the least to the largest median error
  std::vector<std::vector<double>> error;   ///< [material][model]; NaN: no fit
  std::vector<std::vector<double>> seconds; ///< likewise

  struct Standing {
    double median = 0,
           mean_rank = 0;        ///< of the error over materials; the best model of a material has rank 1
    double median_over_best = 0; ///< of the error relative to the best model's, over materials
    int wins = 0, fits = 0;
    double median_seconds = 0;
  };
  std::vector<Standing> standings; ///< a model
};

/// The rows of a store that were fitted in, and are judged by, one metric.
/// @throws Error if there is none, naming the metrics there are
Study make_study(const std::vector<StoredFit>& fits, const std::string& metric);

/// Error of every model over the materials, sorted as Ngan's figure 5 is: by the error of one model.
/// @param by  index of the model that gives the order
Plot sorted_materials_plot(const Study& study, int by);
/// Share of the materials that a model describes with at most this error.
Plot cumulative_plot(const Study& study);
/// Share of the materials on which a model's error is at most so many times that of the best model.
/// Source: Dolan and More 2002, Benchmarking Optimization Software with Performance Profiles.
Plot performance_plot(const Study& study);

/// One line a material, one column a model, comma-separated.
std::string csv(const Study& study);
/// Standings as text for a terminal.
std::string standings_text(const Study& study);
/// Standings, winners and the table of errors as Markdown.
std::string markdown(const Study& study);
/// The study as one page that needs nothing else. @param command  by which it was made
std::string study_page(const Study& study, const std::string& command);

} // namespace nacre

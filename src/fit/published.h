#pragma once
// Published fits, read from JSON: how good they are by Nacre's evaluation, and what a fit of the same model
// gives in the same metric.
//
//   {"source": "...", "materials": {"alum-bronze": [{"model": "Lambertian", "albedo": [r, g, b]},
//                                                   {"model": "NganWard", "albedo": [r, g, b], "roughness":
//                                                   x}]}}
//
// The models are those of Ngan et al. 2005 (metric: cosine), of Loew et al. 2012 (cosine where the file's
// name ends in E1, log otherwise) and of Bagher et al. 2012 (cube_root). Each becomes a model of the list
// with the parameters shared, freed and fixed that make it the paper's: one Fresnel reflectance for all
// channels beside a coloured factor, for instance.

#include "fit/fit.h"

#include <string>
#include <vector>

namespace nacre {

struct PublishedFit {
  std::string material; ///< "alum-bronze"
  std::string model;    ///< as the file calls it: "NganWard"
  MaterialSpec published;
  FitOptions options; ///< model, metric and rules for a fit of the same
};

struct PublishedSet {
  std::string name, source; ///< name: that of the file, without its ending
  std::vector<PublishedFit> fits;
  const PublishedFit* find(std::string_view material) const;
};

/// @throws Error for a file that is no such JSON, with the material; for a model that is not known, with the
/// nearest; for a value outside the domain of its parameter
PublishedSet read_published(const std::string& path);
PublishedSet published_from_json(const nlohmann::json& json, const std::string& file);

struct PublishedComparison {
  std::string material, set, model;
  Metric metric;
  double published = 0, fitted = 0; ///< E over all nodes
  FitResult fit;
};

/// @param options  starts, seed and the like; model, metric and rules come from the published fit
PublishedComparison compare_with_published(const FitData& data, const PublishedSet& set,
                                           const PublishedFit& fit, FitOptions options);

} // namespace nacre

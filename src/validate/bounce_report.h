#pragma once
// What the ways to bring back the light of multiple surface bounces are worth: each one's albedo and lobe
// beside the random walk, over roughness and angle.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace nacre {

struct BounceOptions {
  std::vector<double> alphas = {0.1, 0.3, 0.5, 0.7, 1.0};
  std::vector<double> thetas_deg = {0, 30, 45, 60, 75, 85, 89};
  std::vector<double> lobe_thetas_deg = {0, 45, 75}; ///< where lobes are compared
  int nodes = 10946; ///< directions of the integrals over a lobe, twice: among visible normals and diffuse
  int walks = 40000; ///< per albedo of the random walk; its error is at most 0.5 / sqrt(walks)
  int pairs = 256;   ///< of walks, per direction of a compared lobe
};

/// One way at one roughness and angle, GGX facets.
struct BounceCell {
  std::string
      material;    ///< "white", "gold" (linear RGB, the channel farthest from the walk), "glass" (eta 1.5)
  std::string way; ///< name of the model
  double alpha, theta_deg;
  double albedo;    ///< reflected and transmitted together
  double reflected; ///< of that
  double walk;      ///< albedo of the random walk, same channel
  double walk_reflected;
  double lobe = -1;       ///< integral of |f - f_walk| cos over that of f_walk cos; -1: not compared
  double lobe_noise = -1; ///< the same of two estimates of f_walk, halved: what of `lobe` may be noise
};

struct BounceReport {
  std::vector<BounceCell> cells;
  std::vector<double> alphas, kept; ///< share of diffuse light that single scattering from white facets keeps
};

/// Single scattering and every way of the list, isotropic GGX. Takes some ten seconds of one core.
BounceReport compare_bounces(const BounceOptions& options = {});

/// Tables in Markdown that also read well on a terminal.
std::string to_text(const BounceReport& report);
nlohmann::json to_json(const BounceReport& report);

} // namespace nacre

#pragma once
// Where descents begin: many points of the domain are tried cheaply, and the best of different neighbourhoods
// kept.
//
// Most models are affine in some of their parameters: diffuse reflectance, the factor of a lobe, Schlick's
// reflectance at normal incidence. For given values of all others the best values of these follow from linear
// equations (variable projection: Golub and Pereyra 1973, The Differentiation of Pseudo-Inverses and
// Nonlinear Least Squares Problems Whose Variables Separate), so that only the others, roughness and index,
// have to be searched. In a compressing metric the equations are solved some times with the weights of the
// last solution's secants. Which parameters these are is found from the derivatives: no model has to say it.

#include "fit/residuals.h"

namespace nacre {

/// A start, with its error E over the nodes of the screening.
struct Candidate {
  std::vector<double> coordinates;
  double error = 0;
};

class Screening {
public:
  /// The residuals outlive it.
  explicit Screening(const Residuals& residuals);

  /// Places of the parameters that f is affine in, all together.
  const std::vector<int>& linear() const { return linear_; }

  /// The best of `points` points of a scrambled Sobol' sequence over the other parameters, best first, no two
  /// close to each other. Parameters that vary only because they were freed stay as the material gives them.
  /// @param held  coordinates that stay as in `base` (NaN: searched); empty: all are searched
  std::vector<Candidate> search(int points, int keep, std::uint64_t seed,
                                const std::vector<double>& held = {}) const;

  /// The best affine parameters for the others of `coordinates`.
  Candidate solve(std::vector<double> coordinates) const;

private:
  struct Solved {
    std::vector<double> coordinates;
    std::array<double, 3> squares; ///< of E, per channel
    double error() const { return std::sqrt(squares[0] + squares[1] + squares[2]); }
  };
  Solved solve_linear(std::vector<double> coordinates) const;
  void find_linear();

  const Residuals& residuals_;
  const ParameterLayout& layout_;
  std::vector<bool> is_linear_, is_searched_; ///< a slot of the layout each
  std::vector<int> linear_;
};

} // namespace nacre

#pragma once
// From scene-referred linear sRGB to what an sRGB display is sent.

#include "core/image.h"

#include <array>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace nacre {

struct ToneParameter {
  std::string name, meaning;
  double min, max, value; ///< domain and default
};

/// A picture on its way through an operator: linear sRGB, finite and not negative.
struct TonePicture {
  int width = 0, height = 0;
  std::vector<std::array<float, 3>> rgb;
  double exposure = 1; ///< factor the operator still has to apply
};

struct ToneOperator {
  std::string name, meaning, source;
  std::vector<ToneParameter> parameters;
  /// Leaves display-linear values; what exceeds 1 is clipped afterwards. Parameters in the order above.
  void (*apply)(TonePicture& picture, std::span<const double> parameters);
};
/// The closed list; the command line's help and its checks come from it.
std::span<const ToneOperator> tone_operators();

struct ToneMapOptions {
  std::string operator_name = "reinhard";
  double exposure_stops = 0;                ///< the picture is multiplied by 2^stops
  std::map<std::string, double> parameters; ///< by name; the others keep their defaults
};

/// @throws Error for an unknown operator or parameter (with the nearest name), or a value out of its domain
void check(const ToneMapOptions& options);

/// What was met on the way, in pixels.
struct ToneMapReport {
  std::size_t not_a_number = 0; ///< with a NaN, shown as 0
  std::size_t infinite = 0;     ///< with +Inf, shown as the largest finite value of the picture (1 if none)
  std::size_t negative = 0;     ///< with a negative value or -Inf, shown as 0
  std::size_t clipped = 0;      ///< brighter than the display in a channel after the operator
};

/// `picture` (channels R G B, or Y) to R G B coded in [0, 1] by the sRGB transfer function.
/// @throws Error for an unknown operator or parameter, a value out of its domain, or a picture without colour
Image tone_map(const Image& picture, const ToneMapOptions& options = {}, ToneMapReport* report = nullptr);

/// exp(mean of log(delta + luminance)): the luminance the picture's key is set from. Reinhard et al. 2002,
/// eq. 1 (whose 1/N stands outside the exponential by a misprint).
double log_average_luminance(const TonePicture& picture, double delta);

} // namespace nacre

#pragma once
// Values that vary over a surface. A texture is looked up at a surface point's (u, v) and the wavelengths of
// a path.

#include "core/image.h"
#include "core/vec.h"
#include "spectra/spectrum_source.h"

#include <memory>
#include <variant>

namespace nacre {

/// A picture on the surface. Colours become spectra texel by texel when the scene is read (sigmoid
/// coefficients), and the four neighbours are interpolated as spectra.
class BitmapTexture {
public:
  enum class Filter { bilinear, nearest };
  enum class Wrap { repeat, mirror, clamp };
  /// @param linear  1, 3 or 4 channels, linear values (already decoded); an alpha channel is ignored
  /// @param is_color false for data (roughness, opacity, normals): channels are used as they are
  BitmapTexture(Image linear, bool is_color, Filter filter, Wrap wrap);
  SampledSpectrum eval(Vec2f uv, const Wavelengths& wavelengths) const;
  float eval_scalar(Vec2f uv) const; ///< the only channel, or luminance
  Vec3f eval_raw(Vec2f uv) const;    ///< three stored values, as for a normal map
  Vec3f average() const;             ///< mean stored value

private:
  struct Texels;
  std::shared_ptr<const Texels> texels_;
};

struct CheckerboardTexture {
  SpectrumSource color0, color1; ///< color0 where floor(2u) + floor(2v) of the unit tile is even
};

/// A texture and its affine map: uv' = to_uv (u, v, 1).
struct Texture {
  std::variant<BitmapTexture, CheckerboardTexture> kind;
  std::array<float, 6> to_uv{1, 0, 0, 0, 1, 0}; ///< two rows of three

  SampledSpectrum eval(Vec2f uv, const Wavelengths& wavelengths) const;
  float eval_scalar(Vec2f uv) const;
  Vec3f eval_raw(Vec2f uv) const;
};

/// Where a parameter of a material comes from.
using ParameterSource = std::variant<float, SpectrumSource, std::shared_ptr<const Texture>>;

} // namespace nacre

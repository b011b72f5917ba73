#pragma once
// Values that vary over a surface. A texture is looked up at a surface point's (u, v) and the wavelengths of
// a path.

#include "core/image.h"
#include "core/vec.h"
#include "spectra/spectrum_source.h"

#include <memory>
#include <variant>

namespace nacre {

/// What a texture's values are; it decides how they become spectra.
enum class TextureUse {
  data,        ///< used as they are: roughness, opacity, normals
  reflectance, ///< colours in [0, 1]
  emission     ///< colours from 0 up, times D65 of luminance 1; negative ones count as 0
};

/// A picture on the surface. Colours become spectra texel by texel when the scene is read (sigmoid
/// coefficients), and the four neighbours are interpolated as spectra.
class BitmapTexture {
public:
  enum class Filter { bilinear, nearest };
  enum class Wrap { repeat, mirror, clamp };
  /// @param linear  1, 3 or 4 channels, linear values (already decoded); an alpha channel is ignored
  BitmapTexture(Image linear, TextureUse use, Filter filter, Wrap wrap);
  SampledSpectrum eval(Vec2f uv, const Wavelengths& wavelengths) const;
  float eval_scalar(Vec2f uv) const; ///< the only channel, or luminance
  Vec3f eval_raw(Vec2f uv) const;    ///< three stored values, as for a normal map
  Vec2f gradient(Vec2f uv) const;    ///< of eval_scalar; 0 of the nearest texel
  Vec3f average() const;             ///< mean stored value
  int width() const;                 ///< in texels
  int height() const;

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
  Vec2f gradient(Vec2f uv) const; ///< of eval_scalar along u and v; 0 of a checkerboard
  /// Mean over the unit tile of the luminance that `eval` gives under a light of luminance 1 (as emission: by
  /// itself).
  double mean_luminance() const;
  /// Texels in width and height; (1, 1) of a texture without texels.
  std::array<int, 2> resolution() const;
};

/// Where a parameter of a material comes from.
using ParameterSource = std::variant<float, SpectrumSource, std::shared_ptr<const Texture>>;

} // namespace nacre

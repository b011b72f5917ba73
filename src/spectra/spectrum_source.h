#pragma once
// A spectrum as a scene states it: a closed set of kinds, a value type, evaluated at the wavelengths of a
// path.

#include "spectra/cie.h"
#include "spectra/rgb.h"

#include <array>
#include <memory>
#include <span>
#include <variant>
#include <vector>

namespace nacre {

class SpectrumSource {
public:
  /// The zero spectrum.
  SpectrumSource() : SpectrumSource(Kind(Constant{0})) {}

  // Named constructors throw Error if a value is NaN, infinite, negative or outside the domain stated.

  static SpectrumSource constant(float value);
  /// Linear between the nodes, 0 outside them (the semantics of Mitsuba 3's irregular spectra).
  /// @param wavelengths_nm  strictly increasing, at least one; may reach beyond [360, 830]
  static SpectrumSource tabulated(std::span<const float> wavelengths_nm, std::span<const float> values);
  /// The same with nodes at equal steps from `first_nm` to `last_nm`; at least two values.
  static SpectrumSource regular(float first_nm, float last_nm, std::span<const float> values);
  /// Sigmoid spectrum of that linear sRGB colour under D65; components in [0, 1].
  static SpectrumSource rgb_reflectance(float r, float g, float b);
  /// Scaled sigmoid spectrum, for components that may exceed 1 (specular colours, coefficients of media).
  static SpectrumSource rgb_unbounded(float r, float g, float b);
  /// Scaled sigmoid times D65 of luminance 1: radiance (1, 1, 1) has Y = 1 and is white.
  static SpectrumSource rgb_illuminant(float r, float g, float b);
  /// D65 with luminance Y = `scale`.
  static SpectrumSource d65(float scale = 1);
  /// Planck radiance in W/(m^2 sr nm) times `scale`; temperature in (0, 1e6] K.
  static SpectrumSource blackbody(float temperature_k, float scale = 1);

  /// Values at the wavelengths of a path.
  SampledSpectrum eval(const Wavelengths& wavelengths) const;
  /// Value at one wavelength, by the same rules.
  float eval(float lambda_nm) const;

  /// An upper bound over [360, 830] nm, attained but for illuminants.
  float max_value() const;
  /// CIE Y by quadrature at 1 nm; a flat spectrum of value 1 has 1.
  double luminance() const;
  /// Linear sRGB of a surface with this reflectance lit by D65 of luminance 1; may leave [0, 1].
  RGB to_srgb_reflectance() const;
  /// Linear sRGB of light with this radiance; may leave [0, 1].
  RGB to_srgb_emission() const;
  /// This spectrum times `factor` >= 0.
  SpectrumSource scaled(float factor) const;

private:
  struct Constant {
    float value;
  };
  struct Table;
  using Tabulated = std::shared_ptr<const Table>; ///< immutable, shared between copies
  struct Sigmoid {
    SigmoidPolynomial polynomial;
    float scale;
  };
  struct Illuminant { ///< scale x sigmoid x D65 of luminance 1
    SigmoidPolynomial polynomial;
    float scale;
  };
  struct Daylight { ///< scale x D65 of luminance 1
    float scale;
  };
  struct Blackbody {
    float temperature_k, scale;
  };
  using Kind = std::variant<Constant, Tabulated, Sigmoid, Illuminant, Daylight, Blackbody>;

  explicit SpectrumSource(Kind kind) : kind_(std::move(kind)) {}
  static float eval(const Constant&, float lambda_nm);
  static float eval(const Tabulated&, float lambda_nm);
  static float eval(const Sigmoid&, float lambda_nm);
  static float eval(const Illuminant&, float lambda_nm);
  static float eval(const Daylight&, float lambda_nm);
  static float eval(const Blackbody&, float lambda_nm);

  Kind kind_;
};

} // namespace nacre

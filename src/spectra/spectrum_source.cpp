#include "spectra/spectrum_source.h"

#include "core/error.h"
#include "spectra/illuminants.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <string_view>

namespace nacre {
namespace {

// A range check that also refuses NaN and infinity.
bool in_range(float v, float lo, float hi) { return v >= lo && v <= hi; }
constexpr float largest = std::numeric_limits<float>::max();

void require_non_negative(std::string_view what, float v) {
  if (!in_range(v, 0, largest))
    throw Error(fmt::format("{} is {}: must be finite and not negative", what, v));
}

void require_color(std::string_view what, float r, float g, float b, float hi) {
  if (in_range(r, 0, hi) && in_range(g, 0, hi) && in_range(b, 0, hi)) return;
  throw Error(fmt::format("{} ({}, {}, {}): each component must be {}", what, r, g, b,
                          hi == 1 ? "in [0, 1]" : "finite and not negative"));
}

// A colour of any size as a scale and a sigmoid spectrum whose largest component is 1/2, far from the ends
// where sigmoids turn steep (Mitsuba 3 and pbrt-v4 split it so).
std::pair<SigmoidPolynomial, float> split(float r, float g, float b) {
  const float top = std::max({r, g, b});
  if (top == 0) return {SigmoidPolynomial{}, 0.0f};
  const auto half = [&](float v) { return v / top * 0.5f; };
  return {fit_sigmoid({half(r), half(g), half(b)}), 2 * top};
}

} // namespace

// Straight pieces, found in constant time: bucket b holds the last piece that begins at or before 360 + b nm,
// so only the pieces that begin within one nanometre are searched.
struct SpectrumSource::Table {
  struct Piece {
    float start_nm, value, slope;
  };
  std::vector<Piece> pieces;
  float last_nm;
  float largest;
  std::vector<std::uint32_t> bucket;

  Table(std::span<const float> wavelengths_nm, std::span<const float> values)
      : pieces(values.size()), last_nm(wavelengths_nm.back()), largest(0) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const bool last = i + 1 == values.size();
      const float slope =
          last ? 0 : (values[i + 1] - values[i]) / (wavelengths_nm[i + 1] - wavelengths_nm[i]);
      pieces[i] = {wavelengths_nm[i], values[i], slope};
    }
    const int count = static_cast<int>(lambda_max_nm - lambda_min_nm) + 2;
    for (int b = 0; b < count; ++b)
      bucket.push_back(piece_before(lambda_min_nm + static_cast<float>(b), 0, pieces.size()));
    for (std::size_t i = 0; i < values.size(); ++i)
      if (in_range(wavelengths_nm[i], lambda_min_nm, lambda_max_nm)) largest = std::max(largest, values[i]);
    largest = std::max({largest, (*this)(lambda_min_nm), (*this)(lambda_max_nm)});
  }

  // The last of pieces [first, end) that begins at or before lambda_nm, or `first`.
  std::uint32_t piece_before(float lambda_nm, std::size_t first, std::size_t end) const {
    const auto begin = pieces.begin() + static_cast<std::ptrdiff_t>(first);
    const auto after = std::upper_bound(begin, pieces.begin() + static_cast<std::ptrdiff_t>(end), lambda_nm,
                                        [](float v, const Piece& p) { return v < p.start_nm; });
    return static_cast<std::uint32_t>(after == begin ? first
                                                     : static_cast<std::size_t>(after - pieces.begin()) - 1);
  }

  float operator()(float lambda_nm) const {
    if (!(lambda_nm >= pieces.front().start_nm && lambda_nm <= last_nm)) return 0;
    std::size_t first = 0, end = pieces.size();
    if (in_range(lambda_nm, lambda_min_nm, lambda_max_nm)) {
      const auto b = static_cast<std::size_t>(lambda_nm - lambda_min_nm);
      first = bucket[b];
      end = bucket[b + 1] + std::size_t{1};
    }
    const Piece& p = pieces[piece_before(lambda_nm, first, end)];
    return p.value + p.slope * (lambda_nm - p.start_nm);
  }
};

SpectrumSource SpectrumSource::constant(float value) {
  require_non_negative("constant spectrum", value);
  return SpectrumSource(Kind(Constant{value}));
}

SpectrumSource SpectrumSource::tabulated(std::span<const float> wavelengths_nm,
                                         std::span<const float> values) {
  if (wavelengths_nm.size() != values.size() || values.empty())
    throw Error(
        fmt::format("tabulated spectrum: {} wavelengths and {} values; expected equally many, at least one",
                    wavelengths_nm.size(), values.size()));
  if (values.size() > std::numeric_limits<std::uint32_t>::max())
    throw Error(fmt::format("tabulated spectrum: {} nodes are too many", values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) {
    require_non_negative("wavelength of a tabulated spectrum", wavelengths_nm[i]);
    if (i > 0 && !(wavelengths_nm[i] > wavelengths_nm[i - 1]))
      throw Error(fmt::format("tabulated spectrum: wavelength {} nm after {} nm; they must increase",
                              wavelengths_nm[i], wavelengths_nm[i - 1]));
    if (!in_range(values[i], 0, largest))
      throw Error(fmt::format("tabulated spectrum: {} at {} nm: must be finite and not negative", values[i],
                              wavelengths_nm[i]));
  }
  auto table = std::make_shared<const Table>(wavelengths_nm, values);
  for (const auto& piece : table->pieces)
    if (!std::isfinite(piece.slope))
      throw Error(
          fmt::format("tabulated spectrum: too steep after {} nm for single precision", piece.start_nm));
  return SpectrumSource(Kind(std::move(table)));
}

SpectrumSource SpectrumSource::regular(float first_nm, float last_nm, std::span<const float> values) {
  if (values.size() < 2 || !in_range(first_nm, 0, largest) || !in_range(last_nm, 0, largest) ||
      first_nm >= last_nm)
    throw Error(
        fmt::format("regular spectrum: {} values from {} to {} nm; expected two or more in a growing range",
                    values.size(), first_nm, last_nm));
  std::vector<float> wavelengths_nm(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double f = static_cast<double>(i) / static_cast<double>(values.size() - 1);
    wavelengths_nm[i] =
        static_cast<float>(static_cast<double>(first_nm) * (1 - f) + static_cast<double>(last_nm) * f);
  }
  return tabulated(wavelengths_nm, values);
}

SpectrumSource SpectrumSource::rgb_reflectance(float r, float g, float b) {
  require_color("RGB reflectance", r, g, b, 1);
  return SpectrumSource(Kind(Sigmoid{fit_sigmoid({r, g, b}), 1}));
}

SpectrumSource SpectrumSource::rgb_unbounded(float r, float g, float b) {
  require_color("RGB spectrum", r, g, b, largest / 2);
  const auto [polynomial, scale] = split(r, g, b);
  return SpectrumSource(Kind(Sigmoid{polynomial, scale}));
}

SpectrumSource SpectrumSource::rgb_illuminant(float r, float g, float b) {
  require_color("RGB light", r, g, b, largest / 4);
  const auto [polynomial, scale] = split(r, g, b);
  return SpectrumSource(Kind(Illuminant{polynomial, scale}));
}

SpectrumSource SpectrumSource::d65(float scale) {
  require_non_negative("scale of D65", scale);
  return SpectrumSource(Kind(Daylight{scale}));
}

SpectrumSource SpectrumSource::blackbody(float temperature_k, float scale) {
  if (!(temperature_k > 0 && temperature_k <= 1e6f))
    throw Error(
        fmt::format("blackbody of {} K: the temperature must be above 0 and at most 1e6 K", temperature_k));
  require_non_negative("scale of a blackbody", scale);
  return SpectrumSource(Kind(Blackbody{temperature_k, scale}));
}

float SpectrumSource::eval(const Constant& s, float) { return s.value; }
float SpectrumSource::eval(const Tabulated& s, float lambda_nm) { return (*s)(lambda_nm); }
float SpectrumSource::eval(const Sigmoid& s, float lambda_nm) { return s.scale * s.polynomial(lambda_nm); }
float SpectrumSource::eval(const Illuminant& s, float lambda_nm) {
  return s.scale * s.polynomial(lambda_nm) * unit_d65()(lambda_nm);
}
float SpectrumSource::eval(const Daylight& s, float lambda_nm) { return s.scale * unit_d65()(lambda_nm); }
float SpectrumSource::eval(const Blackbody& s, float lambda_nm) {
  return s.scale * static_cast<float>(nacre::blackbody(static_cast<double>(lambda_nm),
                                                       static_cast<double>(s.temperature_k)));
}

SampledSpectrum SpectrumSource::eval(const Wavelengths& w) const {
  return std::visit(
      [&](const auto& kind) {
        using T = std::decay_t<decltype(kind)>;
        // The commonest kinds compute their four values at once.
        if constexpr (std::is_same_v<T, Sigmoid>) return kind.polynomial(w) * kind.scale;
        if constexpr (std::is_same_v<T, Illuminant>) return kind.polynomial(w) * unit_d65()(w) * kind.scale;
        if constexpr (std::is_same_v<T, Daylight>) return unit_d65()(w) * kind.scale;
        SampledSpectrum s;
        for (int i = 0; i < 4; ++i)
          s[i] = eval(kind, w.lambda_nm[i]);
        return s;
      },
      kind_);
}

float SpectrumSource::eval(float lambda_nm) const {
  return std::visit([&](const auto& kind) { return eval(kind, lambda_nm); }, kind_);
}

float SpectrumSource::max_value() const {
  const auto largest_d65 = [] {
    return *std::max_element(unit_d65().values.begin(), unit_d65().values.end());
  };
  struct Visitor {
    decltype(largest_d65) d65;
    float operator()(const Constant& s) const { return s.value; }
    float operator()(const Tabulated& s) const { return s->largest; }
    float operator()(const Sigmoid& s) const { return s.scale * s.polynomial.max_value(); }
    float operator()(const Illuminant& s) const { return s.scale * s.polynomial.max_value() * d65(); }
    float operator()(const Daylight& s) const { return s.scale * d65(); }
    float operator()(const Blackbody& s) const {
      constexpr float wien_nm_K = 2.897771955e6f;
      return eval(s, std::clamp(wien_nm_K / s.temperature_k, lambda_min_nm, lambda_max_nm));
    }
  };
  return std::visit(Visitor{largest_d65}, kind_);
}

double SpectrumSource::luminance() const {
  return integrate_xyz([&](float lambda_nm) { return eval(lambda_nm); })[1];
}

RGB SpectrumSource::to_srgb_reflectance() const {
  return xyz_to_srgb *
         integrate_xyz([&](float lambda_nm) { return eval(lambda_nm) * unit_d65()(lambda_nm); });
}

RGB SpectrumSource::to_srgb_emission() const {
  return xyz_to_srgb * integrate_xyz([&](float lambda_nm) { return eval(lambda_nm); });
}

SpectrumSource SpectrumSource::scaled(float factor) const {
  require_non_negative("factor of a spectrum", factor);
  struct Visitor {
    float factor;
    Kind operator()(Constant s) const { return Constant{s.value * factor}; }
    Kind operator()(const Tabulated& s) const {
      auto table = std::make_shared<Table>(*s);
      for (auto& piece : table->pieces) {
        piece.value *= factor;
        piece.slope *= factor;
      }
      table->largest *= factor;
      return Tabulated(std::move(table));
    }
    Kind operator()(Sigmoid s) const { return Sigmoid{s.polynomial, s.scale * factor}; }
    Kind operator()(Illuminant s) const { return Illuminant{s.polynomial, s.scale * factor}; }
    Kind operator()(Daylight s) const { return Daylight{s.scale * factor}; }
    Kind operator()(Blackbody s) const { return Blackbody{s.temperature_k, s.scale * factor}; }
  };
  SpectrumSource product(std::visit(Visitor{factor}, kind_));
  if (!std::isfinite(product.max_value()))
    throw Error(fmt::format("a spectrum times {} exceeds single precision", factor));
  return product;
}

} // namespace nacre

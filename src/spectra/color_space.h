#pragma once
// Linear colour spaces. Every matrix is derived here from published primaries and whites. XYZ is always
// relative to D65 (a D65 white of luminance 1 has Y = 1); spaces with another white are adapted by Bradford.

#include <array>

namespace nacre {

using XYZ = std::array<double, 3>; ///< CIE 1931 tristimulus values, Y = 1 for a flat spectrum of value 1
using RGB = std::array<double, 3>; ///< linear; which primaries, the name of the variable or function says

struct Matrix3 {
  std::array<std::array<double, 3>, 3> rows{};

  friend constexpr std::array<double, 3> operator*(const Matrix3& a, const std::array<double, 3>& v) {
    std::array<double, 3> y{};
    for (int i = 0; i < 3; ++i)
      y[i] = a.rows[i][0] * v[0] + a.rows[i][1] * v[1] + a.rows[i][2] * v[2];
    return y;
  }
  friend constexpr Matrix3 operator*(const Matrix3& a, const Matrix3& b) {
    Matrix3 y;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k)
          y.rows[i][j] += a.rows[i][k] * b.rows[k][j];
    return y;
  }
};
constexpr Matrix3 diagonal(const std::array<double, 3>& d) {
  return {{{{d[0], 0, 0}, {0, d[1], 0}, {0, 0, d[2]}}}};
}
constexpr Matrix3 inverse(const Matrix3& matrix) {
  const auto& m = matrix.rows;
  Matrix3 y;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
      y.rows[i][j] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
    }
  const double det = m[0][0] * y.rows[0][0] + m[0][1] * y.rows[1][0] + m[0][2] * y.rows[2][0];
  for (auto& row : y.rows)
    for (double& v : row)
      v /= det;
  return y;
}

struct Chromaticity {
  double x, y;
};
/// XYZ of luminance 1 with that chromaticity.
constexpr XYZ to_xyz(const Chromaticity& c) { return {c.x / c.y, 1, (1 - c.x - c.y) / c.y}; }
constexpr Chromaticity chromaticity(const XYZ& v) {
  const double sum = v[0] + v[1] + v[2];
  return {v[0] / sum, v[1] / sum};
}

struct Primaries {
  Chromaticity red, green, blue, white;
};
/// ITU-R BT.709 and IEC 61966-2-1 (sRGB), white D65.
inline constexpr Primaries rec709_primaries{{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.3127, 0.3290}};
/// AP1 with the ACES white near D60: SMPTE ST 2065-1 and Academy S-2014-004.
inline constexpr Primaries acescg_primaries{
    {0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, {0.32168, 0.33767}};

/// Linear RGB of `p` to XYZ relative to the white of `p`: RGB (1, 1, 1) is the white at Y = 1.
constexpr Matrix3 rgb_to_xyz(const Primaries& p) {
  const XYZ r = to_xyz(p.red), g = to_xyz(p.green), b = to_xyz(p.blue);
  const Matrix3 columns{{{{r[0], g[0], b[0]}, {r[1], g[1], b[1]}, {r[2], g[2], b[2]}}}};
  return columns * diagonal(inverse(columns) * to_xyz(p.white));
}
/// Chromatic adaptation from one white to another by scaling Bradford cone responses (Lam 1985; CIE
/// 160:2004).
constexpr Matrix3 bradford(const Chromaticity& from, const Chromaticity& to) {
  const Matrix3 cones{{{{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}}};
  const auto f = cones * to_xyz(from), t = cones * to_xyz(to);
  return inverse(cones) * diagonal({t[0] / f[0], t[1] / f[1], t[2] / f[2]}) * cones;
}

inline constexpr Matrix3 srgb_to_xyz = rgb_to_xyz(rec709_primaries);
inline constexpr Matrix3 xyz_to_srgb = inverse(srgb_to_xyz);
/// ACEScg to XYZ relative to D65, and back.
inline constexpr Matrix3 acescg_to_xyz =
    bradford(acescg_primaries.white, rec709_primaries.white) * rgb_to_xyz(acescg_primaries);
inline constexpr Matrix3 xyz_to_acescg = inverse(acescg_to_xyz);
inline constexpr Matrix3 srgb_to_acescg = xyz_to_acescg * srgb_to_xyz;
inline constexpr Matrix3 acescg_to_srgb = inverse(srgb_to_acescg);

/// Luminance of linear sRGB is the dot product with these: (0.2126, 0.7152, 0.0722).
inline constexpr std::array<double, 3> srgb_luminance_weights = srgb_to_xyz.rows[1];
inline constexpr std::array<double, 3> acescg_luminance_weights = acescg_to_xyz.rows[1];
constexpr double srgb_luminance(const RGB& rgb) {
  return srgb_luminance_weights[0] * rgb[0] + srgb_luminance_weights[1] * rgb[1] +
         srgb_luminance_weights[2] * rgb[2];
}

} // namespace nacre

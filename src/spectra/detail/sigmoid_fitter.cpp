#include "spectra/detail/sigmoid_fitter.h"

#include "core/pack.h"
#include "spectra/cie.h"
#include "spectra/illuminants.h"

#include <algorithm>
#include <cmath>

namespace nacre::detail {
namespace {

// CIE Lab (CIE 015:2018, section 8.2.1) relative to the white of linear sRGB, with derivative with respect to
// XYZ.
struct Lab {
  std::array<double, 3> value;
  Matrix3 derivative;
};
Lab to_lab(const XYZ& xyz) {
  static constexpr XYZ white = to_xyz(rec709_primaries.white);
  constexpr double delta = 6.0 / 29;
  std::array<double, 3> f, slope;
  for (int i = 0; i < 3; ++i) {
    const double t = xyz[i] / white[i];
    if (t > delta * delta * delta) {
      f[i] = std::cbrt(t);
      slope[i] = 1 / (3 * f[i] * f[i] * white[i]);
    } else {
      slope[i] = 1 / (3 * delta * delta * white[i]);
      f[i] = t / (3 * delta * delta) + 4.0 / 29;
    }
  }
  return {{116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])},
          {{{{0, 116 * slope[1], 0},
             {500 * slope[0], -500 * slope[1], 0},
             {0, 200 * slope[1], -200 * slope[2]}}}}};
}

double squared_length(const std::array<double, 3>& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

std::array<double, 3> operator-(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

// A transition steeper than the spacing of the nodes resolves is not wanted.
constexpr double largest_coefficient = 300;

} // namespace

SigmoidFitter::SigmoidFitter() {
  const double first = static_cast<double>(lambda_min_nm), last = static_cast<double>(lambda_max_nm);
  const double spacing = (last - first) / (node_count - 1);
  for (int i = 0; i < node_count; ++i)
    t_[i] = static_cast<float>(-1 + 2.0 * i / (node_count - 1));
  // Weight of a node: integral of its hat function times D65 and the response of a channel. So a spectrum
  // that is linear between nodes is integrated exactly.
  std::array<std::array<double, node_count>, 3> weight{};
  constexpr int steps_per_nm = 4;
  const int steps = static_cast<int>(last - first) * steps_per_nm;
  for (int n = 0; n <= steps; ++n) {
    const double lambda_nm = first + static_cast<double>(n) / steps_per_nm;
    const double end = n == 0 || n == steps ? 0.5 : 1;
    const auto cmf = cie_1931(static_cast<float>(lambda_nm));
    const double light = end * static_cast<double>(unit_d65()(static_cast<float>(lambda_nm)));
    const RGB rgb =
        xyz_to_srgb * XYZ{light * static_cast<double>(cmf[0]), light * static_cast<double>(cmf[1]),
                          light * static_cast<double>(cmf[2])};
    const double position = (lambda_nm - first) / spacing;
    const int i = std::min(static_cast<int>(position), node_count - 2);
    const double f = position - i;
    for (int c = 0; c < 3; ++c) {
      weight[c][i] += (1 - f) * rgb[c];
      weight[c][i + 1] += f * rgb[c];
    }
  }
  // The tabulated D65 misses the rounded white of sRGB by 3e-4; scaled so that a constant is gray exactly.
  for (int c = 0; c < 3; ++c) {
    double sum = 0;
    for (double w : weight[c])
      sum += w;
    for (int i = 0; i < node_count; ++i)
      weight_[c][i] = static_cast<float>(weight[c][i] / sum);
  }
}

const SigmoidFitter& SigmoidFitter::instance() {
  static const SigmoidFitter fitter;
  return fitter;
}

SigmoidFitter::Response SigmoidFitter::respond(const Coefficients& c) const {
  const Pack c0(static_cast<float>(c[0])), c1(static_cast<float>(c[1])), c2(static_cast<float>(c[2]));
  const Pack one(1.0f), half(0.5f);
  Pack rgb[3], slope[3][3];
  for (int j = 0; j < 3; ++j) {
    rgb[j] = Pack(0.0f);
    for (auto& s : slope[j])
      s = Pack(0.0f);
  }
  for (std::size_t i = 0; i < node_count; i += pack_width) {
    const Pack t = load(&t_[i]);
    const Pack x = (c0 * t + c1) * t + c2;
    const Pack inverse_root = one / sqrt(one + x * x);
    const Pack s = half + half * x * inverse_root; // eq. 2 of the paper
    const Pack ds_dx = half * inverse_root * inverse_root * inverse_root;
    for (int j = 0; j < 3; ++j) {
      const Pack w = load(&weight_[j][i]), d2 = w * ds_dx, d1 = d2 * t;
      rgb[j] += w * s;
      slope[j][2] += d2;
      slope[j][1] += d1;
      slope[j][0] += d1 * t;
    }
  }
  const auto sum = [](Pack p) {
    double total = 0;
    for (std::size_t i = 0; i < pack_width; ++i)
      total += static_cast<double>(lane(p, i));
    return total;
  };
  Response r;
  for (int j = 0; j < 3; ++j) {
    r.rgb[j] = sum(rgb[j]);
    for (int k = 0; k < 3; ++k)
      r.derivative.rows[j][k] = sum(slope[j][k]);
  }
  return r;
}

double SigmoidFitter::fit(const RGB& target, Coefficients& c) const {
  constexpr double close_enough = 1e-7; // squared distance in Lab: 3e-4, near the precision of the float sums
  constexpr int most_steps = 60;
  const auto goal = to_lab(srgb_to_xyz * target).value;

  Response response = respond(c);
  Lab lab = to_lab(srgb_to_xyz * response.rgb);
  auto residual = goal - lab.value;
  double error = squared_length(residual), damping = 1e-4;
  for (int step = 0; step < most_steps && error > close_enough; ++step) {
    const Matrix3 J = lab.derivative * srgb_to_xyz * response.derivative;
    Matrix3 JtJ;
    std::array<double, 3> Jtr{};
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) {
        Jtr[i] += J.rows[k][i] * residual[k];
        for (int j = 0; j < 3; ++j)
          JtJ.rows[i][j] += J.rows[k][i] * J.rows[k][j];
      }
    const double trace = JtJ.rows[0][0] + JtJ.rows[1][1] + JtJ.rows[2][2];
    if (!(trace > 0)) break;
    for (int i = 0; i < 3; ++i)
      JtJ.rows[i][i] += damping * (JtJ.rows[i][i] + 1e-6 * trace);
    const auto move = inverse(JtJ) * Jtr;
    Coefficients trial;
    bool finite = true;
    for (int i = 0; i < 3; ++i) {
      trial[i] = std::clamp(c[i] + move[i], -largest_coefficient, largest_coefficient);
      finite = finite && std::isfinite(trial[i]);
    }
    if (finite) {
      const Response trial_response = respond(trial);
      const Lab trial_lab = to_lab(srgb_to_xyz * trial_response.rgb);
      const auto trial_residual = goal - trial_lab.value;
      const double trial_error = squared_length(trial_residual);
      if (trial_error < error) {
        c = trial;
        response = trial_response;
        lab = trial_lab;
        residual = trial_residual;
        error = trial_error;
        damping = std::max(damping * 0.1, 1e-9);
        continue;
      }
    }
    damping *= 10;
    if (damping > 1e8) break;
  }
  return std::sqrt(error);
}

float constant_sigmoid(double value) {
  // s = 1/2 + x / (2 sqrt(1 + x^2)) solved for x. Beyond 1e4 the float sigmoid is 0 or 1 to the last digit.
  constexpr double end = 1e5;
  const double product = value * (1 - value);
  if (!(product > 0)) return static_cast<float>(value > 0.5 ? end : -end);
  return static_cast<float>(std::clamp((value - 0.5) / std::sqrt(product), -end, end));
}

} // namespace nacre::detail

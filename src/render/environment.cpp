#include "render/environment.h"

#include "core/error.h"
#include "spectra/illuminants.h"

#include <fmt/format.h>

namespace nacre {

EnvironmentMap::Texels EnvironmentMap::prepare(const EnvironmentLight& light) {
  const Image& image = *light.radiance;
  const int w = image.width, h = image.height;
  if (w < 2 || h < 2) throw Error(fmt::format("an environment map of {} x {} pixels is too small", w, h));
  std::array<int, 3> rgb{image.channel("R"), image.channel("G"), image.channel("B")};
  if (rgb[0] < 0 || rgb[1] < 0 || rgb[2] < 0) {
    const int y = image.channel("Y");
    if (y < 0) throw Error("an environment map needs the channels R, G, B or Y");
    rgb = {y, y, y};
  }
  if (!(light.scale >= 0) || !std::isfinite(light.scale))
    throw Error(fmt::format("the scale of an environment map is {}", light.scale));

  Texels t;
  t.width = w, t.height = h;
  const std::size_t stride = std::size_t(w) + 1;
  t.data.resize(stride * std::size_t(h));
  std::vector<float> luminance(t.data.size());
  const auto& table = RgbToSpectrumTable::instance();
  for (int y = 0; y < h; ++y) {
    const std::size_t row = std::size_t(y) * stride;
    for (int x = 0; x < w; ++x) {
      std::array<float, 3> c;
      for (std::size_t i = 0; i < 3; ++i) {
        const float value = image.at(x, y)[rgb[i]] * light.scale;
        if (!std::isfinite(value))
          throw Error(fmt::format("the environment map is not finite at ({}, {})", x, y));
        c[i] = std::max(0.0f, value);
      }
      // The colour's largest component becomes 1/2, where sigmoids are smoothest.
      const float scale = 2 * std::max({c[0], c[1], c[2]});
      Texel& texel = t.data[row + std::size_t(x)];
      texel.scale = scale;
      texel.polynomial =
          scale > 0 ? table({c[0] / scale, c[1] / scale, c[2] / scale}) : table({0.5f, 0.5f, 0.5f});
      luminance[row + std::size_t(x)] = float(srgb_luminance({c[0], c[1], c[2]}));
    }
    t.data[row + std::size_t(w)] = t.data[row];
    luminance[row + std::size_t(w)] = luminance[row];
  }
  // A cell weighs its mean luminance times its solid angle; where one corner shines it is never 0.
  t.importance.resize(std::size_t(w) * std::size_t(h - 1));
  for (int y = 0; y + 1 < h; ++y) {
    const double theta0 = pi * y / (h - 1), theta1 = pi * (y + 1) / (h - 1);
    const double solid_angle = 2 * pi / w * (std::cos(theta0) - std::cos(theta1));
    for (int x = 0; x < w; ++x) {
      const float* l = &luminance[std::size_t(y) * stride + std::size_t(x)];
      const double mean = 0.25 * (double(l[0]) + l[1] + l[stride] + l[stride + 1]);
      t.importance[std::size_t(y) * std::size_t(w) + std::size_t(x)] = float(mean * solid_angle);
      t.integral += mean * solid_angle;
    }
  }
  return t;
}

EnvironmentMap::EnvironmentMap(const EnvironmentLight& light) : EnvironmentMap(prepare(light), light) {}

EnvironmentMap::EnvironmentMap(Texels&& t, const EnvironmentLight& light)
    : width_(t.width), height_(t.height), texels_(std::move(t.data)), integral_(t.integral),
      cells_(t.importance, t.width, t.height - 1) {
  const auto axis = [&](const Vec3d& a) { return vec3<float>(normalize(light.to_world.vector(a))); };
  axes_ = {axis({1, 0, 0}), axis({0, 1, 0}), axis({0, 0, 1})};
  const auto skew = [](const Vec3f& a, const Vec3f& b) { return !(std::abs(dot(a, b)) < 1e-3f); };
  if (skew(axes_.s, axes_.t) || skew(axes_.t, axes_.n) || skew(axes_.n, axes_.s))
    throw Error("the transform of an environment map must be a rotation");
}

EnvironmentMap::Place EnvironmentMap::place(const Vec3f& d) const {
  const Vec3f l = axes_.to_local(d);
  const float sin_theta = std::hypot(l.x, l.z);
  float u = std::atan2(l.x, -l.z) * float(0.5 * inv_pi) - 0.5f / float(width_);
  u -= std::floor(u);
  return {{std::min(u, 0x1.fffffep-1f), std::atan2(sin_theta, l.y) * float(inv_pi)}, sin_theta};
}

SampledSpectrum EnvironmentMap::radiance(const Vec3f& d, const Wavelengths& w) const {
  const Vec2f uv = place(d).uv;
  const float x = uv.x * float(width_), y = uv.y * float(height_ - 1);
  const int i = std::min(int(x), width_ - 1), j = std::min(int(y), height_ - 2);
  const float a = x - float(i), b = y - float(j);
  const std::size_t stride = std::size_t(width_) + 1;
  const Texel* t = &texels_[std::size_t(j) * stride + std::size_t(i)];
  const Texel* corner[] = {t, t + 1, t + stride, t + stride + 1};
  const float weight[] = {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b};
  SampledSpectrum color;
  float scale = 0;
  for (int k = 0; k < 4; ++k) {
    color += corner[k]->polynomial(w) * weight[k];
    scale += corner[k]->scale * weight[k];
  }
  const DenseSpectrum& white = unit_d65();
  for (int k = 0; k < 4; ++k)
    color[k] *= white(w.lambda_nm[std::size_t(k)]);
  return color * scale;
}

EnvironmentMap::Sample EnvironmentMap::sample(Vec2f u) const {
  const auto s = cells_.sample(u);
  const float phi = float(2 * pi) * (s.uv.x + 0.5f / float(width_)), theta = float(pi) * s.uv.y;
  const float sin_theta = std::sin(theta);
  const Vec3f l{std::sin(phi) * sin_theta, std::cos(theta), -std::cos(phi) * sin_theta};
  const Vec3f d = axes_.to_world(l);
  return {d, sin_theta > 0 ? s.pdf / (float(2 * pi * pi) * sin_theta) : 0};
}

float EnvironmentMap::pdf(const Vec3f& d) const {
  const Place p = place(d);
  return p.sin_theta > 0 ? cells_.pdf(p.uv) / (float(2 * pi * pi) * p.sin_theta) : 0;
}

} // namespace nacre

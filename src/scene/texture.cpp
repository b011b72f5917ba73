#include "scene/texture.h"

#include "core/error.h"

#include <cmath>

namespace nacre {

struct BitmapTexture::Texels {
  int width = 0, height = 0, channels = 0; ///< channels: 1 or 3
  TextureUse use = TextureUse::data;
  Filter filter = Filter::bilinear;
  Wrap wrap = Wrap::repeat;
  std::vector<float> values;              ///< as given, without alpha
  std::vector<SigmoidPolynomial> spectra; ///< one a texel, for three-channel colours
  std::vector<float> scales;              ///< of the spectra, if an emitting texel exceeds 1
  Vec3f mean{0, 0, 0};

  /// Weights and indices of the texels that a lookup blends.
  struct Taps {
    std::array<std::size_t, 4> index;
    std::array<float, 4> weight;
    int count;
  };
  Taps taps(Vec2f uv) const;
  int wrapped(int i, int n) const;
};

namespace {

/// Position along one axis brought into [0, 1], by the wrap mode; anything that is not a number is 0.
float wrap_coordinate(float u, BitmapTexture::Wrap wrap) {
  if (!std::isfinite(u)) return 0;
  switch (wrap) {
  case BitmapTexture::Wrap::repeat:
    return u - std::floor(u);
  case BitmapTexture::Wrap::mirror: {
    const float t = u - 2 * std::floor(0.5f * u);
    return t > 1 ? 2 - t : t;
  }
  case BitmapTexture::Wrap::clamp:
    break;
  }
  return clamp(u, 0.0f, 1.0f);
}

} // namespace

int BitmapTexture::Texels::wrapped(int i, int n) const {
  if (i >= 0 && i < n) return i;
  if (wrap == Wrap::repeat) return i < 0 ? n - 1 : 0;
  return i < 0 ? 0 : n - 1; // the mirror image of the border texel is itself
}

BitmapTexture::Texels::Taps BitmapTexture::Texels::taps(Vec2f uv) const {
  const float x = wrap_coordinate(uv.x, wrap) * static_cast<float>(width);
  const float y = wrap_coordinate(uv.y, wrap) * static_cast<float>(height);
  const auto at = [&](int i, int j) {
    return static_cast<std::size_t>(wrapped(j, height)) * width + wrapped(i, width);
  };
  if (filter == Filter::nearest)
    return {{at(min(static_cast<int>(x), width - 1), min(static_cast<int>(y), height - 1))}, {1}, 1};
  const float fx = x - 0.5f, fy = y - 0.5f;
  const int i = static_cast<int>(std::floor(fx)), j = static_cast<int>(std::floor(fy));
  const float a = fx - static_cast<float>(i), b = fy - static_cast<float>(j);
  return {{at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)},
          {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b},
          4};
}

BitmapTexture::BitmapTexture(Image linear, TextureUse use, Filter filter, Wrap wrap) {
  auto texels = std::make_shared<Texels>();
  const int stored = linear.channel_count();
  if (linear.width < 1 || linear.height < 1) throw Error("a texture needs at least one texel");
  if (stored < 1 || stored > 4)
    throw Error("a texture has 1 to 4 channels, this picture has " + std::to_string(stored));
  const std::size_t count = static_cast<std::size_t>(linear.width) * linear.height;
  if (linear.data.size() != count * stored) throw Error("a texture's pixels do not match its size");
  texels->width = linear.width;
  texels->height = linear.height;
  texels->channels = stored >= 3 ? 3 : 1; // 2 and 4: the last is alpha
  texels->use = use;
  texels->filter = filter;
  texels->wrap = wrap;
  const int n = texels->channels;

  // Files name their channels; EXR keeps them in alphabetical order.
  std::array<int, 3> from{0, 1, 2};
  if (n == 3 && linear.channel("R") >= 0 && linear.channel("G") >= 0 && linear.channel("B") >= 0)
    from = {linear.channel("R"), linear.channel("G"), linear.channel("B")};
  else if (n == 1 && linear.channel("Y") >= 0)
    from[0] = linear.channel("Y");
  texels->values.resize(count * n);
  std::array<double, 3> sum{};
  bool exceeds_one = false;
  for (std::size_t i = 0; i < count; ++i)
    for (int c = 0; c < n; ++c) {
      float v = linear.data[i * stored + from[c]];
      if (!std::isfinite(v))
        throw Error("the texture's pixel (" + std::to_string(i % linear.width) + ", " +
                    std::to_string(i / linear.width) + ") is not a finite number");
      if (use == TextureUse::emission) v = max(v, 0.0f);
      exceeds_one = exceeds_one || v > 1;
      texels->values[i * n + c] = v;
      sum[c] += v;
    }
  for (int c = n; c < 3; ++c)
    sum[c] = sum[0];
  const double k = 1 / static_cast<double>(count);
  texels->mean = vec3<float>({k * sum[0], k * sum[1], k * sum[2]});

  if (use != TextureUse::data && n == 3) {
    const auto& table = RgbToSpectrumTable::instance();
    texels->spectra.resize(count);
    if (use == TextureUse::emission && exceeds_one) texels->scales.assign(count, 1.0f);
    for (std::size_t i = 0; i < count; ++i) {
      const float* rgb = &texels->values[i * 3];
      // Neighbours are often equal; the table lookup is the costly part.
      const bool same = i > 0 && std::equal(rgb, rgb + 3, rgb - 3);
      float k_rgb = 1;
      if (const float largest = max(rgb[0], max(rgb[1], rgb[2])); !texels->scales.empty() && largest > 1) {
        // As single colours of lights: twice the largest component, so the sigmoid stays smooth.
        texels->scales[i] = 2 * largest;
        k_rgb = 0.5f / largest;
      }
      texels->spectra[i] =
          same ? texels->spectra[i - 1] : table({k_rgb * rgb[0], k_rgb * rgb[1], k_rgb * rgb[2]});
    }
  }
  texels_ = std::move(texels);
}

SampledSpectrum BitmapTexture::eval(Vec2f uv, const Wavelengths& wavelengths) const {
  const auto taps = texels_->taps(uv);
  SampledSpectrum sum;
  for (int t = 0; t < taps.count; ++t) {
    const float scale = texels_->scales.empty() ? 1.0f : texels_->scales[taps.index[t]];
    if (!texels_->spectra.empty())
      sum += taps.weight[t] * scale * texels_->spectra[taps.index[t]](wavelengths);
    else
      sum += SampledSpectrum(taps.weight[t] * texels_->values[taps.index[t] * texels_->channels]);
  }
  if (texels_->use == TextureUse::emission) {
    static const SpectrumSource daylight = SpectrumSource::d65(1);
    sum = sum * daylight.eval(wavelengths);
  }
  return sum;
}

Vec3f BitmapTexture::eval_raw(Vec2f uv) const {
  const auto taps = texels_->taps(uv);
  const int n = texels_->channels;
  Vec3f sum{0, 0, 0};
  for (int t = 0; t < taps.count; ++t) {
    const float* v = &texels_->values[taps.index[t] * n];
    sum += Vec3f{v[0], v[n / 2], v[n - 1]} * taps.weight[t];
  }
  return sum;
}

float BitmapTexture::eval_scalar(Vec2f uv) const {
  const Vec3f v = eval_raw(uv);
  if (texels_->channels == 1) return v.x;
  return static_cast<float>(srgb_luminance({v.x, v.y, v.z}));
}

Vec2f BitmapTexture::gradient(Vec2f uv) const {
  const auto taps = texels_->taps(uv);
  if (taps.count < 4) return {0, 0};
  const int n = texels_->channels;
  std::array<float, 4> h;
  for (std::size_t t = 0; t < 4; ++t) {
    const float* v = &texels_->values[taps.index[t] * n];
    h[t] = n == 1 ? v[0] : static_cast<float>(srgb_luminance({v[0], v[1], v[2]}));
  }
  const float a = taps.weight[1] + taps.weight[3], b = taps.weight[2] + taps.weight[3];
  // A mirrored picture runs backwards in every other tile, and the border of a clamped one goes on for ever.
  const auto direction = [&](float t) {
    if (texels_->wrap == Wrap::repeat || (t >= 0 && t <= 1)) return 1.0f;
    if (texels_->wrap == Wrap::clamp) return 0.0f;
    return t - 2 * std::floor(0.5f * t) > 1 ? -1.0f : 1.0f;
  };
  return {
      direction(uv.x) * static_cast<float>(texels_->width) * ((1 - b) * (h[1] - h[0]) + b * (h[3] - h[2])),
      direction(uv.y) * static_cast<float>(texels_->height) * ((1 - a) * (h[2] - h[0]) + a * (h[3] - h[1]))};
}

Vec3f BitmapTexture::average() const { return texels_->mean; }
int BitmapTexture::width() const { return texels_->width; }
int BitmapTexture::height() const { return texels_->height; }

namespace {

Vec2f transformed(const std::array<float, 6>& m, Vec2f uv) {
  return {m[0] * uv.x + m[1] * uv.y + m[2], m[3] * uv.x + m[4] * uv.y + m[5]};
}

const SpectrumSource& square_of(const CheckerboardTexture& checkerboard, Vec2f uv) {
  const bool right = uv.x - std::floor(uv.x) > 0.5f, upper = uv.y - std::floor(uv.y) > 0.5f;
  return right == upper ? checkerboard.color0 : checkerboard.color1;
}

} // namespace

SampledSpectrum Texture::eval(Vec2f uv, const Wavelengths& wavelengths) const {
  uv = transformed(to_uv, uv);
  if (const auto* bitmap = std::get_if<BitmapTexture>(&kind)) return bitmap->eval(uv, wavelengths);
  return square_of(std::get<CheckerboardTexture>(kind), uv).eval(wavelengths);
}

float Texture::eval_scalar(Vec2f uv) const {
  uv = transformed(to_uv, uv);
  if (const auto* bitmap = std::get_if<BitmapTexture>(&kind)) return bitmap->eval_scalar(uv);
  // A scalar parameter's colours are constants: any wavelength will do.
  return square_of(std::get<CheckerboardTexture>(kind), uv).eval(550.0f);
}

double Texture::mean_luminance() const {
  if (const auto* bitmap = std::get_if<BitmapTexture>(&kind)) {
    const Vec3f mean = bitmap->average(); // one channel stands for all three
    return srgb_luminance({mean.x, mean.y, mean.z});
  }
  const auto& checkerboard = std::get<CheckerboardTexture>(kind);
  return 0.5 * (checkerboard.color0.luminance() + checkerboard.color1.luminance());
}

std::array<int, 2> Texture::resolution() const {
  if (const auto* bitmap = std::get_if<BitmapTexture>(&kind)) return {bitmap->width(), bitmap->height()};
  return {1, 1};
}

Vec2f Texture::gradient(Vec2f uv) const {
  const auto* bitmap = std::get_if<BitmapTexture>(&kind);
  if (bitmap == nullptr) return {0, 0};
  const Vec2f g = bitmap->gradient(transformed(to_uv, uv));
  return {to_uv[0] * g.x + to_uv[3] * g.y, to_uv[1] * g.x + to_uv[4] * g.y};
}

Vec3f Texture::eval_raw(Vec2f uv) const {
  if (const auto* bitmap = std::get_if<BitmapTexture>(&kind)) return bitmap->eval_raw(transformed(to_uv, uv));
  const float v = eval_scalar(uv);
  return {v, v, v};
}

} // namespace nacre

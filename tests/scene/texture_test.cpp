#include "core/error.h"
#include "scene/texture.h"

#include <limits>

#include <gtest/gtest.h>

namespace nacre {
namespace {

/// 2 x 2: 1 2 / 3 4 from the top.
Image numbers() {
  Image image(2, 2, {"Y"});
  image.data = {1, 2, 3, 4};
  return image;
}
BitmapTexture data(BitmapTexture::Filter filter, BitmapTexture::Wrap wrap) {
  return BitmapTexture(numbers(), TextureUse::data, filter, wrap);
}

TEST(BitmapTexture, RowZeroOfThePictureIsAtVZero) {
  const auto t = data(BitmapTexture::Filter::nearest, BitmapTexture::Wrap::repeat);
  EXPECT_EQ(t.eval_scalar({0.1f, 0.1f}), 1);
  EXPECT_EQ(t.eval_scalar({0.9f, 0.1f}), 2);
  EXPECT_EQ(t.eval_scalar({0.1f, 0.9f}), 3);
}

TEST(BitmapTexture, TexelCentresLieAtHalves) {
  const auto t = data(BitmapTexture::Filter::bilinear, BitmapTexture::Wrap::repeat);
  EXPECT_FLOAT_EQ(t.eval_scalar({0.25f, 0.25f}), 1);
  EXPECT_FLOAT_EQ(t.eval_scalar({0.75f, 0.75f}), 4);
  EXPECT_FLOAT_EQ(t.eval_scalar({0.5f, 0.25f}), 1.5f);
  EXPECT_FLOAT_EQ(t.eval_scalar({0.5f, 0.5f}), 2.5f);
}

TEST(BitmapTexture, WrapModesContinueBeyondTheEdge) {
  using Wrap = BitmapTexture::Wrap;
  const auto at = [](Wrap wrap, float u) {
    return data(BitmapTexture::Filter::bilinear, wrap).eval_scalar({u, 0.25f});
  };
  EXPECT_FLOAT_EQ(at(Wrap::repeat, 1), 1.5f);   // half of 2, half of the next tile's 1
  EXPECT_FLOAT_EQ(at(Wrap::repeat, -0.75f), 1); // u = 0.25
  EXPECT_FLOAT_EQ(at(Wrap::clamp, 1), 2);
  EXPECT_FLOAT_EQ(at(Wrap::clamp, 7), 2);
  EXPECT_FLOAT_EQ(at(Wrap::mirror, 1.25f), 2); // u = 0.75
  EXPECT_FLOAT_EQ(at(Wrap::mirror, 1.75f), 1);
  EXPECT_FLOAT_EQ(at(Wrap::mirror, 1), 2);
}

TEST(BitmapTexture, AnyCoordinateHasAValueOfThePicture) {
  for (const auto wrap :
       {BitmapTexture::Wrap::repeat, BitmapTexture::Wrap::mirror, BitmapTexture::Wrap::clamp})
    for (const auto filter : {BitmapTexture::Filter::nearest, BitmapTexture::Filter::bilinear})
      for (const float u :
           {0.0f, 1.0f, -1.0f, -1e-9f, 0.99999994f, 1e30f, -1e30f, std::numeric_limits<float>::infinity(),
            std::numeric_limits<float>::quiet_NaN()}) {
        const float v = data(filter, wrap).eval_scalar({u, u});
        EXPECT_TRUE(v >= 1 && v <= 4) << u << " gives " << v;
      }
}

TEST(BitmapTexture, ColorsComeBackUnderD65) {
  Image image(1, 1, {"B", "G", "R"}); // as an EXR file orders them
  image.data = {0.1f, 0.4f, 0.7f};
  const BitmapTexture t(image, TextureUse::reflectance, BitmapTexture::Filter::bilinear,
                        BitmapTexture::Wrap::repeat);
  EXPECT_FLOAT_EQ(t.eval_raw({0.5f, 0.5f}).x, 0.7f);
  EXPECT_FLOAT_EQ(t.average().z, 0.1f);
  const SigmoidPolynomial expected = RgbToSpectrumTable::instance()({0.7f, 0.4f, 0.1f});
  const Wavelengths w = sample_wavelengths(0.3f);
  const SampledSpectrum got = t.eval({0.2f, 0.9f}, w);
  for (int i = 0; i < 4; ++i)
    EXPECT_NEAR(got[i], expected(w.lambda_nm[i]), 1e-6);
}

TEST(BitmapTexture, GreyColorIsTheSameAtAllWavelengths) {
  const BitmapTexture t(numbers(), TextureUse::reflectance, BitmapTexture::Filter::bilinear,
                        BitmapTexture::Wrap::repeat);
  const SampledSpectrum s = t.eval({0.25f, 0.75f}, sample_wavelengths(0.6f));
  for (int i = 0; i < 4; ++i)
    EXPECT_FLOAT_EQ(s[i], 3);
}

TEST(BitmapTexture, GradientIsTheSlopeOfTheValues) {
  Image image(4, 3, {"Y"});
  for (std::size_t i = 0; i < 12; ++i)
    image.data[i] = static_cast<float>((i * 7) % 5);
  using Wrap = BitmapTexture::Wrap;
  for (const Wrap wrap : {Wrap::repeat, Wrap::mirror, Wrap::clamp}) {
    const Texture t{BitmapTexture(image, TextureUse::data, BitmapTexture::Filter::bilinear, wrap),
                    {1.5f, 0.3f, 0.2f, -0.4f, 0.8f, 0.1f}};
    // Away from the edges of cells, where the slope jumps.
    for (const Vec2f uv :
         {Vec2f{0.31f, 0.42f}, Vec2f{0.9f, 0.63f}, Vec2f{-0.77f, 1.33f}, Vec2f{1.6f, -0.7f}}) {
      const float h = 1e-3f;
      const auto slope = [&](float du, float dv) {
        return (t.eval_scalar({uv.x + du, uv.y + dv}) - t.eval_scalar({uv.x - du, uv.y - dv})) / (2 * h);
      };
      const Vec2f g = t.gradient(uv);
      EXPECT_NEAR(g.x, slope(h, 0), 2e-2f) << int(wrap) << " " << uv.x;
      EXPECT_NEAR(g.y, slope(0, h), 2e-2f) << int(wrap) << " " << uv.x;
    }
  }
  const Texture board{CheckerboardTexture{SpectrumSource::constant(0), SpectrumSource::constant(1)}};
  EXPECT_EQ(board.gradient({0.2f, 0.2f}).x, 0);
}

TEST(BitmapTexture, RejectsWhatIsNoPicture) {
  Image bad = numbers();
  bad.data[3] = std::numeric_limits<float>::quiet_NaN();
  const auto make = [](const Image& image) {
    return BitmapTexture(image, TextureUse::data, BitmapTexture::Filter::bilinear,
                         BitmapTexture::Wrap::repeat);
  };
  EXPECT_THROW(make(bad), Error);
  EXPECT_THROW(make(Image()), Error);
  EXPECT_THROW(make(Image(1, 1, {"a", "b", "c", "d", "e"})), Error);
}

TEST(Checkerboard, ColorZeroIsWhereBothHalvesAgree) {
  const CheckerboardTexture board{SpectrumSource::constant(0.4f), SpectrumSource::constant(0.2f)};
  const Texture plain{board, {1, 0, 0, 0, 1, 0}};
  EXPECT_EQ(plain.eval_scalar({0.1f, 0.1f}), 0.4f);
  EXPECT_EQ(plain.eval_scalar({0.9f, 0.9f}), 0.4f);
  EXPECT_EQ(plain.eval_scalar({0.9f, 0.1f}), 0.2f);
  EXPECT_EQ(plain.eval_scalar({-0.9f, 0.1f}), 0.4f); // -0.9 is 0.1 of its tile
  const Texture moved{board, {5, 0, 0.5f, 0, 5, 0}};
  EXPECT_EQ(moved.eval_scalar({0.02f, 0.02f}), 0.2f);
}

TEST(BitmapTexture, EmittedColoursAreThoseOfLightsAndMayExceedOne) {
  Image image(2, 1, {"R", "G", "B"});
  image.data = {3, 1.5f, 0.3f, -1, -2, 0};
  const Texture t{BitmapTexture(image, TextureUse::emission, BitmapTexture::Filter::nearest,
                                BitmapTexture::Wrap::repeat)};
  const SpectrumSource expected = SpectrumSource::rgb_illuminant(3, 1.5f, 0.3f);
  for (const float u : {0.1f, 0.4f, 0.7f}) {
    const Wavelengths w = sample_wavelengths(u);
    const SampledSpectrum a = t.eval({0.25f, 0.5f}, w), b = expected.eval(w), c = t.eval({0.75f, 0.5f}, w);
    for (int i = 0; i < 4; ++i) {
      EXPECT_NEAR(a[i], b[i], 0.02f * expected.max_value()); // a table against a fit
      EXPECT_NEAR(c[i], 0, 1e-4f);                           // negative light is none
    }
  }
  EXPECT_NEAR(t.mean_luminance(), 0.5 * srgb_luminance({3, 1.5, 0.3}), 1e-5);
}

} // namespace
} // namespace nacre

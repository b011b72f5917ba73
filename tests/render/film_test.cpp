#include "render/film.h"

#include "core/error.h"
#include "core/random.h"
#include "render/filter.h"

namespace nacre {
namespace {

class FilterOfKind : public testing::TestWithParam<FilterKind> {};

TEST_P(FilterOfKind, IntegratesToOneAndSamplesFollowIt) {
  const PixelFilter filter(GetParam(), 0, 0.5f);
  // In one dimension: sum to 1.
  double sum = 0;
  constexpr int n = 20000;
  const double r = filter.radius();
  for (int i = 0; i < n; ++i)
    sum += double(filter.eval(float(((i + 0.5) / n * 2 - 1) * r))) * 2 * r / n;
  EXPECT_NEAR(sum, 1, 1e-4);
  // By sampling: mean weight 1, and the moment of x^2 is that of the filter.
  double second = 0;
  for (int i = 0; i < n; ++i) {
    const double x = ((i + 0.5) / n * 2 - 1) * r;
    second += double(filter.eval(float(x))) * x * x * 2 * r / n;
  }
  RunningMoments weight, moment;
  for (int i = 0; i < 40000; ++i) {
    const auto s = filter.sample({uniform(3, 0, std::uint64_t(i), 0), uniform(3, 0, std::uint64_t(i), 1)});
    EXPECT_LE(std::abs(s.offset.x), filter.radius());
    EXPECT_LE(std::abs(s.offset.y), filter.radius());
    weight.add(double(s.weight));
    moment.add(double(s.weight) * double(s.offset.x) * double(s.offset.x));
  }
  EXPECT_NEAR(weight.mean(), 1, 5 * weight.standard_error() + 2e-4);
  EXPECT_NEAR(moment.mean(), second, 5 * moment.standard_error() + 2e-4);
}

TEST_P(FilterOfKind, SpreadsTheUniformPictureEvenly) {
  // A partition of unity at the pixels' spacing for box, tent and the cubics; the others nearly.
  const PixelFilter filter(GetParam(), 0, 0.5f);
  const bool exact = GetParam() != FilterKind::gaussian && GetParam() != FilterKind::lanczos;
  for (int k = 0; k < 20; ++k) {
    float sum = 0;
    for (int pixel = -5; pixel <= 5; ++pixel)
      sum += filter.eval(float(k) / 20 + 0.001f - float(pixel));
    EXPECT_NEAR(sum, 1, exact ? 1e-4 : 0.03);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, FilterOfKind,
                         testing::Values(FilterKind::box, FilterKind::tent, FilterKind::gaussian,
                                         FilterKind::mitchell, FilterKind::catmull_rom, FilterKind::lanczos));

TEST(PixelFilter, RefusesRadiiThatMakeNoFilter) {
  EXPECT_THROW(PixelFilter(FilterKind::box, -1, 0.5f), Error);
  EXPECT_THROW(PixelFilter(FilterKind::gaussian, 0, 0), Error);
}

TEST(FilmBuffer, HoldsMeanAndVarianceOfTheMean) {
  FilmBuffer film(2, 1);
  for (const double x : {1.0, 2.0, 6.0})
    film.add(1, 0, {x, 1e6 + x, 0});
  const Image image = film.to_image(true);
  EXPECT_EQ(image.channels.size(), 6u);
  EXPECT_FLOAT_EQ(image.at(1, 0)[0], 3);
  // Sample variance 7, of the mean 7/3; no digits lost beside 1e6.
  EXPECT_FLOAT_EQ(image.at(1, 0)[3], 7.0f / 3);
  EXPECT_FLOAT_EQ(image.at(1, 0)[4], 7.0f / 3);
  EXPECT_EQ(image.at(0, 0)[0], 0);
  EXPECT_EQ(film.samples(1, 0), 3u);
}

} // namespace
} // namespace nacre

#include "core/random_stream.h"
#include "core/statistics.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

Vec3f direction(int i) {
  return normalize(Vec3f{uniform(1, 0, i, 0) - 0.5f, uniform(1, 0, i, 1) - 0.5f, uniform(1, 0, i, 2)});
}

TEST(RandomStream, TheSameArgumentsGiveTheSameNumbersAndOthersGiveOthers) {
  const Vec3f a = direction(0), b = direction(1);
  RandomStream<float> one(a, b), again(a, b), swapped(b, a);
  int equal = 0;
  for (int i = 0; i < 1000; ++i) {
    const float x = one.next();
    EXPECT_EQ(x, again.next());
    EXPECT_GE(x, 0);
    EXPECT_LT(x, 1);
    equal += x == swapped.next();
  }
  EXPECT_LT(equal, 3);
}

TEST(RandomStream, PacksGiveEachLaneTheNumbersOfItsOwnKey) {
  std::array<std::array<float, pack_width>, 6> w;
  for (std::size_t l = 0; l < pack_width; ++l) {
    const Vec3f a = direction(int(2 * l)), b = direction(int(2 * l + 1));
    const float xyz[] = {a.x, a.y, a.z, b.x, b.y, b.z};
    for (std::size_t k = 0; k < 6; ++k)
      w[k][l] = xyz[k];
  }
  const auto at = [&](std::size_t k) { return load(w[k].data()); };
  RandomStream<Pack> packs({at(0), at(1), at(2)}, {at(3), at(4), at(5)});
  std::array<Pack, 20> numbers;
  for (Pack& x : numbers)
    x = packs.next();
  for (std::size_t l = 0; l < pack_width; ++l) {
    RandomStream<float> scalar(direction(int(2 * l)), direction(int(2 * l + 1)));
    for (const Pack& x : numbers)
      EXPECT_EQ(lane(x, l), scalar.next());
  }
}

// Chi-square over pairs of successive numbers and over the first numbers of neighbouring keys, 64 x 64 cells,
// 200,000 pairs; false positives 1e-4 each.
TEST(RandomStream, PairsAreUniform) {
  constexpr int side = 64, n = 200000;
  std::vector<double> within(side * side), between(side * side),
      expected(side * side, n / double(side * side));
  const auto cell = [](float x, float y) { return std::size_t(x * side) * side + std::size_t(y * side); };
  RandomStream<float> stream(direction(5), direction(6));
  float last = 0;
  for (int i = 0; i < n; ++i) {
    const float x = stream.next();
    within[cell(x, stream.next())] += 1;
    Vec3f a = direction(7);
    a.x += float(i) * 1e-6f;
    const float first = RandomStream<float>(a, direction(8)).next();
    between[cell(last, first)] += 1;
    last = first;
  }
  EXPECT_GT(chi_square_test(within, expected).p, 1e-4);
  EXPECT_GT(chi_square_test(between, expected).p, 1e-4);
}

} // namespace
} // namespace nacre

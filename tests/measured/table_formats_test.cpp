// UTIA and Ngan: binary tables over two directions.

#include "analytic.h"
#include "core/error.h"
#include "measured/formats/ngan.h"
#include "measured/formats/utia.h"
#include "mutated_files.h"

#include <cstring>
#include <gmock/gmock.h>
#include <limits>

namespace nacre {
namespace {

using testing::AllOf;
using testing::HasSubstr;

template <class T>
void append(Bytes& bytes, T x) {
  const auto* p = reinterpret_cast<const std::uint8_t*>(&x);
  bytes.insert(bytes.end(), p, p + sizeof x);
}
template <class T>
void set(Bytes& bytes, std::size_t offset, T x) {
  std::memcpy(&bytes[offset], &x, sizeof x);
}

/// The file's own order: planes, theta_i, phi_i, theta_v, phi_v.
template <class F>
Bytes utia_file(F f) {
  Bytes bytes;
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 48; ++j)
        for (int k = 0; k < 6; ++k)
          for (int l = 0; l < 48; ++l)
            append(bytes, (c + 1) * f(at_degrees(15 * k, 7.5 * l), at_degrees(15 * i, 7.5 * j)));
  return bytes;
}

TEST(UtiaFormat, NodesAreTheFilesValuesInItsOrder) {
  const Glossy brushed{0.2, 0.5};
  const auto m = parse_utia(utia_file(brushed), "x.bin");
  EXPECT_FALSE(m->is_isotropic());
  for (const int i : {0, 1, 3, 5})
    for (const int j : {0, 5, 47})
      for (const int k : {0, 2, 5})
        for (const int l : {0, 20, 47}) {
          const Vec3d wi = at_degrees(15 * i, 7.5 * j), wo = at_degrees(15 * k, 7.5 * l);
          std::array<float, 3> f;
          ASSERT_TRUE(m->evaluate(wo, wi, f));
          for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(f[c], (c + 1) * brushed(wo, wi), 1e-4 * f[c]) << i << j << k << l;
        }
}

TEST(UtiaFormat, LambertHoldsToTheHorizon) {
  const auto m = parse_utia(utia_file([](auto&&, auto&&) { return 0.25; }), "x.bin");
  for (std::uint64_t n = 0; n < 500; ++n)
    EXPECT_NEAR(grey(*m, random_direction(2 * n, 89.9), random_direction(2 * n + 1, 89.9)), 0.25, 1e-6);
}

TEST(UtiaFormat, InterpolationKeepsAHighlightBetweenAzimuths) {
  // Sheared azimuths: an isotropic material stays isotropic, which plain interpolation of both azimuths is
  // not.
  const auto m = parse_utia(utia_file(Glossy{0.15, 0.15}), "x.bin");
  const Vec3d wo = at_degrees(60, 180), wi = at_degrees(60, 0);
  for (const double turn : {1.9, 3.75, 5.0}) {
    const Vec3d o = at_degrees(60, 180 + turn), i = at_degrees(60, turn);
    EXPECT_NEAR(grey(*m, o, i), grey(*m, wo, wi), 1e-4 * grey(*m, wo, wi));
  }
}

TEST(UtiaFormat, NegativeNumbersAreZeroAndCounted) {
  Bytes bytes = utia_file([](auto&&, auto&&) { return 0.25; });
  set(bytes, 8 * ((1 * 48 + 0) * 6 * 48 + 2 * 48 + 3), -0.5);
  const auto m = parse_utia(bytes, "x.bin");
  EXPECT_EQ(grey(*m, at_degrees(30, 22.5), at_degrees(15, 0)), 0);
  EXPECT_THAT(m->facts().back().second, HasSubstr("1 at theta_i > 0"));
}

TEST(UtiaFormat, WrongFilesAreNamedWithTheirByte) {
  Bytes bytes = utia_file([](auto&&, auto&&) { return 0.25; });
  EXPECT_EQ(bytes.size(), 3u * 82944 * 8);
  EXPECT_TRUE(is_utia(bytes));
  set(bytes, 8 * 1000, std::nan(""));
  EXPECT_THAT(message_of(parse_utia, bytes), AllOf(HasSubstr("byte 8000"), HasSubstr("nan")));
  bytes.pop_back();
  EXPECT_FALSE(is_utia(bytes));
  EXPECT_THAT(message_of(parse_utia, bytes), HasSubstr("1990656"));
  EXPECT_THAT(message_of(parse_utia, {}), HasSubstr("found 0"));
}

Bytes ngan_header(std::array<std::int32_t, 4> n, bool half) {
  Bytes bytes;
  for (const std::int32_t x : {n[0], n[1], n[2], n[3], 0, 0, 1, 0, 0, half ? 1 : 0, 3, 0, 0, 0, 0, 0})
    append(bytes, x);
  return bytes;
}
/// theta_in, theta_out, phi_diff, phi_in at the middles of their bins, phi_in fastest.
template <class F>
Bytes ngan_file(std::array<std::int32_t, 4> n, bool half, F f) {
  Bytes bytes = ngan_header(n, half);
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < n[0]; ++i)
      for (int k = 0; k < n[1]; ++k)
        for (int l = 0; l < n[2]; ++l)
          for (int j = 0; j < n[3]; ++j) {
            const double phi_in = (j + 0.5) * 360 / n[3], phi_diff = (l + 0.5) * (half ? 180 : 360) / n[2];
            append(bytes, float((c + 1) * f(at_degrees((k + 0.5) * 90 / n[1], phi_in + phi_diff),
                                            at_degrees((i + 0.5) * 90 / n[0], phi_in))));
          }
  return bytes;
}

TEST(NganFormat, BinsAreReadAtTheirMiddles) {
  const Glossy brushed{0.2, 0.5};
  for (const bool half : {false, true}) {
    const auto m = parse_ngan(ngan_file({9, 6, 24, 12}, half, brushed), "x.dat");
    for (const double theta_i : {5.0, 45.0})
      for (const double phi_i : {15.0, 345.0})
        for (const double theta_o : {7.5, 67.5})
          for (const double phi_d : {3.75 * (half ? 1 : 2), 3.75 * (half ? 9 : 18)}) {
            const Vec3d wi = at_degrees(theta_i, phi_i), wo = at_degrees(theta_o, phi_i + phi_d);
            EXPECT_NEAR(grey(*m, wo, wi), brushed(wo, wi), 1e-4 * brushed(wo, wi));
            // The other half of the azimuths is the mirror image.
            const Vec3d mi = at_degrees(theta_i, -phi_i), mo = at_degrees(theta_o, -phi_i - phi_d);
            EXPECT_NEAR(grey(*m, mo, mi), brushed(mo, mi), 1e-4 * brushed(wo, wi));
          }
  }
}

TEST(NganFormat, NegativeValuesAreHoles) {
  Bytes bytes = ngan_file({2, 2, 4, 4}, false, [](auto&&, auto&&) { return 0.5; });
  const std::size_t cells = 2 * 2 * 4 * 4;
  for (std::size_t c = 0; c < cells; ++c)
    set(bytes, 64 + 4 * (cells + c), -1.0f); // green is missing everywhere
  EXPECT_EQ(grey(*parse_ngan(bytes, "x"), at_degrees(30, 50), at_degrees(20, 10)), -1);
  set(bytes, 64 + 4 * cells, 1.0f);
  EXPECT_EQ(parse_ngan(bytes, "x")->samples().size(), 1u);
}

TEST(NganFormat, WrongFilesAreNamedWithTheirByte) {
  EXPECT_THAT(message_of(parse_ngan, Bytes(63)), HasSubstr("found 63"));
  EXPECT_THAT(message_of(parse_ngan, ngan_header({4, 0, 4, 4}, false)),
              AllOf(HasSubstr("byte 4"), HasSubstr("theta_out")));
  EXPECT_THAT(message_of(parse_ngan, ngan_header({4096, 4096, 4096, 4096}, false)), HasSubstr("at most"));
  EXPECT_THAT(message_of(parse_ngan, ngan_header({4, 4, 4, 4}, false)), HasSubstr("expected 3136 bytes"));
  Bytes bytes = ngan_file({2, 2, 2, 2}, false, [](auto&&, auto&&) { return 0.5; });
  EXPECT_TRUE(is_ngan(bytes));
  set(bytes, 64 + 4 * 5, std::numeric_limits<float>::infinity());
  EXPECT_THAT(message_of(parse_ngan, bytes), AllOf(HasSubstr("byte 84"), HasSubstr("inf")));
  set(bytes, 40, std::int32_t(4));
  EXPECT_FALSE(is_ngan(bytes));
  EXPECT_THAT(message_of(parse_ngan, bytes), AllOf(HasSubstr("byte 40"), HasSubstr("channels")));
}

TEST(NganFormat, MutatedFilesGiveATableOrAnError) {
  expect_measurement_or_error(
      ngan_file({2, 3, 4, 4}, true, Glossy{}), [](const Bytes& b) { return parse_ngan(b, "mutant"); }, 10000,
      64);
}

TEST(UtiaFormat, MutatedFilesGiveATableOrAnError) {
  // Edits that keep the size, or few would be read at all.
  const Bytes whole = utia_file(Glossy{});
  int read = 0, errors = 0;
  for (std::uint64_t n = 0; n < 60; ++n) {
    Bytes bytes = whole;
    for (std::uint64_t e = 0; e < 1 + n % 40; ++e)
      bytes[hash(n, e, 0) % bytes.size()] = std::uint8_t(hash(n, e, 1));
    if (n % 8 == 0) bytes.resize(hash(n) % bytes.size());
    try {
      const auto m = parse_utia(bytes, "mutant");
      ++read;
      for (std::uint64_t k = 0; k < 50; ++k)
        EXPECT_TRUE(std::isfinite(grey(*m, random_direction(2 * k, 89), random_direction(2 * k + 1, 89))));
    } catch (const Error& e) {
      ++errors;
    }
  }
  EXPECT_GT(read, 5);
  EXPECT_GT(errors, 5);
}

} // namespace
} // namespace nacre

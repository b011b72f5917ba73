// There is no original file here: what is tested is a file built field by field as the public readers expect,
// and known materials brought into the format.
#include "measured/formats/rgl_bsdf.h"

#include "core/error.h"
#include "core/quadrature.h"
#include "core/random.h"
#include "core/statistics.h"
#include "core/warp.h"
#include "measured/analytic_bsdf.h"
#include "measured/formats.h"
#include "measured/tensor_file.h"

#include <cstring>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <iostream>
#include <map>

namespace nacre {
namespace {

using testing::HasSubstr;

double random(int i, int d) { return unit_double(hash(41, i, d)); }
Vec3d random_direction(int i, int d, double smallest_z = 0) {
  const double z = smallest_z + (1 - smallest_z) * random(i, d), phi = 2 * pi * random(i, d + 1);
  const double s = std::sqrt(1 - z * z);
  return {s * std::cos(phi), s * std::sin(phi), z};
}

/// A small file of random positive numbers.
RglTables random_tables(std::vector<float> phi_i, bool spectral, bool jacobian = true) {
  RglTables t;
  t.description = "numbers of chance";
  t.theta_i = {0.1f, 0.6f, 1.4f};
  t.phi_i = std::move(phi_i);
  if (spectral) t.wavelengths_nm = {400, 500, 650, 700};
  int count = 0;
  const auto numbers = [&](std::size_t n) {
    std::vector<float> x(n);
    for (float& v : x)
      v = float(0.2 + unit_double(hash(77, count++)));
    return x;
  };
  const std::size_t slices = t.theta_i.size() * t.phi_i.size();
  t.ndf = {6, 5, numbers(30)};
  t.sigma = {4, 3, numbers(12)};
  t.vndf_width = 7, t.vndf_height = 5;
  t.vndf = numbers(slices * 35);
  t.width = t.height = 4;
  t.luminance = numbers(slices * 16);
  t.spectra = numbers(slices * 16 * t.channel_count());
  t.jacobian = jacobian;
  return t;
}

const std::vector<float> whole_turn{-3.14159265f, -1.5f, 0.2f, 1.7f, 3.14159265f};

/// The reader again, written straight from the definition: densities integrated by brute force, no tables of
/// integrals, one slice at a time.
struct Definition {
  const RglTables& t;

  static double bilinear(const float* v, std::size_t w, std::size_t h, double x, double y) {
    const double gx = std::clamp(x, 0.0, 1.0) * double(w - 1), gy = std::clamp(y, 0.0, 1.0) * double(h - 1);
    const auto i = std::min(std::size_t(gx), w - 2), j = std::min(std::size_t(gy), h - 2);
    const double fx = gx - double(i), fy = gy - double(j);
    const auto at = [&](std::size_t a, std::size_t b) { return double(v[b * w + a]); };
    return (1 - fy) * ((1 - fx) * at(i, j) + fx * at(i + 1, j)) +
           fy * ((1 - fx) * at(i, j + 1) + fx * at(i + 1, j + 1));
  }
  static std::pair<std::size_t, double> place(const std::vector<float>& nodes, double x) {
    if (nodes.size() == 1 || x <= double(nodes[0])) return {0, 0};
    for (std::size_t i = 1; i < nodes.size(); ++i)
      if (x < double(nodes[i]))
        return {i - 1, (x - double(nodes[i - 1])) / (double(nodes[i]) - double(nodes[i - 1]))};
    return {nodes.size() - 2, 1};
  }
  template <class F>
  double blended(double phi, double theta, F slice_value) const {
    const auto [p, fp] = place(t.phi_i, phi);
    const auto [q, fq] = place(t.theta_i, theta);
    double sum = 0;
    for (int dp = 0; dp < 2; ++dp)
      for (int dq = 0; dq < 2; ++dq) {
        const double w = (dp ? fp : 1 - fp) * (dq ? fq : 1 - fq);
        if (w > 0) sum += w * slice_value((p + std::size_t(dp)) * t.theta_i.size() + q + std::size_t(dq));
      }
    return sum;
  }
  /// Integral of a bilinear table over [0, x] x [0, y], exact: the midpoint rule on the nodes' cells and
  /// parts.
  static double integral(const float* v, std::size_t w, std::size_t h, double x, double y) {
    double sum = 0;
    for (std::size_t j = 0; j + 1 < h; ++j)
      for (std::size_t i = 0; i + 1 < w; ++i) {
        const double x0 = double(i) / double(w - 1), x1 = std::min(double(i + 1) / double(w - 1), x);
        const double y0 = double(j) / double(h - 1), y1 = std::min(double(j + 1) / double(h - 1), y);
        if (x1 > x0 && y1 > y0)
          sum += (x1 - x0) * (y1 - y0) * bilinear(v, w, h, (x0 + x1) / 2, (y0 + y1) / 2);
      }
    return sum;
  }
  /// f cos and the readers' density of sampling, for these directions.
  std::pair<std::vector<double>, double> at(Vec3d wi, Vec3d wo) const { // the readers' names
    const bool isotropic = t.phi_i.size() <= 2;
    if (!isotropic) {
      const double span = double(t.phi_i.back()) - double(t.phi_i.front());
      const double sy = span < 4 ? wi.y : -1, sx = span < 2 ? wi.x : sy; // quarter: both signs of their own
      for (Vec3d* w : {&wi, &wo}) {
        w->x *= sx > 0 ? -1 : 1;
        w->y *= sy > 0 ? -1 : 1;
      }
    }
    const Vec3d m = normalize(wi + wo);
    const double theta_i = std::acos(wi.z), phi_i = std::atan2(wi.y, wi.x);
    const double theta_m = std::acos(m.z), phi_m = std::atan2(m.y, m.x);
    const double u = std::sqrt(theta_m * 2 / pi);
    double v = ((isotropic ? phi_m - phi_i : phi_m) + pi) / (2 * pi);
    v -= std::floor(v);
    const std::size_t n = t.vndf_width * t.vndf_height, slice = t.width * t.height;
    const auto vndf = [&](std::size_t s) { return &t.vndf[s * n]; };
    const auto total = [&](std::size_t s) { return integral(vndf(s), t.vndf_width, t.vndf_height, 1, 1); };
    const auto density = [&](double a, double b) {
      return blended(phi_i, theta_i, [&](std::size_t s) {
        return bilinear(vndf(s), t.vndf_width, t.vndf_height, a, b) / total(s);
      });
    };
    // s.y: share of the density below v. s.x: of the line at v, the share up to u.
    const double sy = blended(phi_i, theta_i, [&](std::size_t s) {
      return integral(vndf(s), t.vndf_width, t.vndf_height, 1, v) / total(s);
    });
    double line = 0, part = 0;
    for (std::size_t i = 0; i + 1 < t.vndf_width; ++i) {
      const double d = 1.0 / double(t.vndf_width - 1), x0 = double(i) * d;
      line += d * density(x0 + d / 2, v);
      const double x1 = std::min(x0 + d, u);
      if (x1 > x0) part += (x1 - x0) * density((x0 + x1) / 2, v);
    }
    const double sx = part / line;
    const double lum = blended(phi_i, theta_i, [&](std::size_t s) {
      const float* table = &t.luminance[s * slice];
      return bilinear(table, t.width, t.height, sx, sy) / integral(table, t.width, t.height, 1, 1);
    });
    const double jacobian = 2 * pi * pi * u * std::sin(theta_m) * 4 * dot(wi, m);
    std::vector<double> f;
    const double row = isotropic ? 0.5 : (phi_i + pi) / (2 * pi);
    const double scale = !t.jacobian ? 1
                                     : bilinear(t.ndf.values.data(), t.ndf.width, t.ndf.height, u, v) /
                                           (4 * bilinear(t.sigma.values.data(), t.sigma.width, t.sigma.height,
                                                         std::sqrt(theta_i * 2 / pi), row));
    for (std::size_t c = 0; c < t.channel_count(); ++c)
      f.push_back(scale * blended(isotropic ? 0 : phi_i, theta_i, [&](std::size_t s) {
                    return bilinear(&t.spectra[(s * t.channel_count() + c) * slice], t.width, t.height, sx,
                                    sy);
                  }));
    return {f, density(u, v) * lum / jacobian};
  }
};

TEST(RglBsdf, IsWhatTheFormatsDefinitionSays) {
  const std::vector<std::vector<float>> azimuths{
      {0.0f}, whole_turn, {-3.14159265f, -2, -0.4f, 0}, {-3.14159265f, -2.5f, -1.57079633f}};
  for (const auto& phi_i : azimuths)
    for (const bool spectral : {false, true})
      for (const bool jacobian : {true, false}) {
        const RglTables tables = random_tables(phi_i, spectral, jacobian);
        const RglBsdf bsdf = parse_rgl(encode_rgl(tables), "x.bsdf");
        const Definition definition{tables};
        EXPECT_EQ(bsdf.is_isotropic(), phi_i.size() == 1);
        for (int i = 0; i < 500; ++i) {
          const Vec3d wo = random_direction(i, 0, 0.01), wi = random_direction(i, 2, 0.01);
          std::vector<float> f(tables.channel_count());
          ASSERT_TRUE(bsdf.evaluate(wo, wi, f));
          const auto [expected, density] = definition.at(wo, wi);
          for (std::size_t c = 0; c < f.size(); ++c)
            EXPECT_NEAR(double(f[c]) * wi.z, expected[c], 2e-6 * expected[c]);
          // 15/16 of the readers' sampling, 1/16 of a cosine.
          EXPECT_NEAR(bsdf.pdf(wo, wi), 15.0 / 16 * density + wi.z * inv_pi / 16, 1e-6 * density);
        }
      }
}

TEST(RglBsdf, WavelengthsAreInterpolatedAlikeByBothWays) {
  const RglBsdf bsdf(random_tables({0}, true));
  for (int i = 0; i < 200; ++i) {
    const Wavelengths w = sample_wavelengths(float(random(i, 9)));
    const Vec3d wo = random_direction(i, 0), wi = random_direction(i, 2);
    std::array<float, 4> f;
    bsdf.evaluate(wo, wi, f);
    const auto slow = bsdf.channels().at(f, w), fast = bsdf.at(wo, wi, w);
    for (int k = 0; k < 4; ++k)
      EXPECT_NEAR(fast[k], slow[k], 1e-5f * slow[k]);
  }
}

TEST(RglBsdf, FileIsReadByEndingAndComesBackTheSame) {
  for (const bool spectral : {false, true}) {
    const RglTables tables = random_tables(whole_turn, spectral);
    const auto bytes = encode_rgl(tables);
    const auto& formats = measured_formats();
    const auto format =
        std::find_if(formats.begin(), formats.end(), [](const auto& f) { return f.name == "rgl"; });
    ASSERT_NE(format, formats.end());
    EXPECT_TRUE(format->recognises(bytes));
    const auto bsdf = format->parse(bytes, "x.bsdf");
    EXPECT_EQ(bsdf->facts()[0].second, "numbers of chance");
    const RglBsdf again = parse_rgl(format->encode(*bsdf), "y.bsdf");
    std::vector<float> f(tables.channel_count()), g(f.size());
    for (int i = 0; i < 300; ++i) {
      const Vec3d wo = random_direction(i, 0), wi = random_direction(i, 2);
      bsdf->evaluate(wo, wi, f);
      again.evaluate(wo, wi, g);
      for (std::size_t c = 0; c < f.size(); ++c)
        EXPECT_NEAR(f[c], g[c], 1e-5f * f[c]);
    }
  }
}

TEST(RglBsdf, DarkPlacesOfLuminanceAndSpectraAreHoles) {
  RglTables t = random_tables({0}, false);
  for (std::size_t s = 0; s < 3; ++s)
    for (std::size_t i = 0; i < 16; ++i)
      if (i % 4 >= 2) {
        t.luminance[s * 16 + i] = 0;
        for (std::size_t c = 0; c < 3; ++c)
          t.spectra[(s * 3 + c) * 16 + i] = 0;
      }
  const RglBsdf bsdf(t);
  int holes = 0;
  for (int i = 0; i < 2000; ++i) {
    std::array<float, 3> f;
    const Vec3d wo = random_direction(i, 0), wi = random_direction(i, 2);
    const bool known = bsdf.evaluate(wo, wi, f);
    EXPECT_EQ(known, f[0] > 0);
    holes += !known;
  }
  EXPECT_GT(holes, 100);
  EXPECT_LT(holes, 1900);
}

std::string message_of(std::span<const std::uint8_t> bytes) {
  try {
    parse_rgl(bytes, "x.bsdf");
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST(RglBsdf, TablesThatDoNotFitTogetherAreErrorsWithTheirPlace) {
  const auto broken = [](auto change) {
    RglTables t = random_tables(whole_turn, true);
    change(t);
    return message_of(encode_rgl(t));
  };
  EXPECT_EQ(broken([](RglTables&) {}), "no error");
  EXPECT_THAT(broken([](RglTables& t) { std::swap(t.theta_i[0], t.theta_i[1]); }), HasSubstr("'theta_i'"));
  EXPECT_THAT(broken([](RglTables& t) { t.theta_i[2] = 3; }), HasSubstr("increase within"));
  EXPECT_THAT(broken([](RglTables& t) { t.phi_i.back() = -0.9f, t.phi_i[3] = -1, t.phi_i[2] = -1.1f; }),
              HasSubstr("'phi_i': spans"));
  EXPECT_THAT(broken([](RglTables& t) { t.vndf[7] = -1; }), HasSubstr("'vndf': holds a negative"));
  EXPECT_THAT(broken([](RglTables& t) { std::fill_n(t.vndf.begin() + 35, 35, 0.0f); }),
              HasSubstr("slice 1 is 0"));
  EXPECT_THAT(broken([](RglTables& t) { t.ndf.values[3] = 1e30f; }), HasSubstr("'ndf': holds 1e+30"));
  EXPECT_THAT(broken([](RglTables& t) { t.wavelengths_nm[1] = 400; }), HasSubstr("'wavelengths'"));
  EXPECT_THAT(broken([](RglTables& t) { t.ndf = {30, 1, t.ndf.values}; }), HasSubstr("at least 2 x 2"));
  EXPECT_THAT(broken([](RglTables& t) {
                t.width = 8, t.height = 2;
                t.spectra.assign(t.spectra.size(), 1);
                t.luminance.assign(t.luminance.size(), std::nanf(""));
              }),
              HasSubstr("'luminance': expected a finite number"));

  const auto fields = [](std::vector<Tensor> list) { return message_of(encode_tensor_file(list)); };
  const std::vector<float> one{0.5f};
  EXPECT_THAT(fields({}), HasSubstr("no field 'description'"));
  EXPECT_THAT(fields({tensor("description", "x"), tensor("theta", {1}, one)}),
              HasSubstr("did you mean 'theta'"));
  EXPECT_THAT(fields({tensor("description", "x"), tensor("theta_i", {1, 1}, one)}),
              HasSubstr("in 1 dimension"));
}

TEST(RglBsdf, NoTruncationAndNoFlippedBitDoesHarm) {
  const auto bytes = encode_rgl(random_tables(whole_turn, false));
  for (std::size_t n = 0; n < bytes.size(); n += n < 900 ? 1 : 97)
    EXPECT_THAT(message_of(std::span(bytes).first(n)), HasSubstr("byte")) << n;
  int accepted = 0;
  for (int i = 0; i < 4000; ++i) {
    auto broken = bytes;
    const std::size_t reach = i % 2 ? 600 : bytes.size(); // the header mostly
    for (int k = 0; k < 1 + i % 3; ++k)
      broken[hash(6, i, 2 * k) % reach] ^= std::uint8_t(1u << (hash(6, i, 2 * k + 1) % 8));
    try {
      const RglBsdf bsdf = parse_rgl(broken, "x.bsdf");
      ++accepted;
      const Vec3d wo = random_direction(i, 0), wi = random_direction(i, 2);
      std::vector<float> f(std::size_t(bsdf.channels().count()));
      bsdf.evaluate(wo, wi, f);
      for (const float x : f)
        EXPECT_TRUE(std::isfinite(x));
      EXPECT_TRUE(std::isfinite(bsdf.pdf(wo, wi)));
      bsdf.sample(wo, random(i, 4), {random(i, 5), random(i, 6)});
    } catch (const Error& e) {
      EXPECT_THAT(std::string(e.what()), HasSubstr("x.bsdf: byte "));
    }
  }
  EXPECT_GT(accepted, 500);
}

TEST(RglBsdf, DirectionsThatAreNoNumbersReadNothingOutsideTheTables) {
  const RglBsdf flat(random_tables({0}, false)), turned(random_tables(whole_turn, true));
  for (const RglBsdf* b : {&flat, &turned})
    for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e300, 0.0})
      for (int c = 0; c < 3; ++c) {
        Vec3d wo{0.6, 0, 0.8};
        (c == 0 ? wo.x : c == 1 ? wo.y : wo.z) = bad;
        std::array<float, 4> f{};
        const std::span used(f.data(), std::size_t(b->channels().count()));
        b->evaluate(wo, {0, 0.6, 0.8}, used);
        b->evaluate({0, 0.6, 0.8}, wo, used);
        b->pdf(wo, {0, 0.6, 0.8});
        b->sample(wo, 0.9, {0.3, 0.4}); // the test is that the sanitizer build, or a crash, says nothing
      }
}

/// Known materials in the format; each made once.
struct Case {
  std::string name, material;
  bool isotropic;
  double rms;    ///< bound on the root of the mean squared relative error, both directions within 75 degrees
  double albedo; ///< bound on the error of the albedo at angles up to 75 degrees
};
const std::vector<Case> cases{
    {"rough metal", "ggx_conductor:metal=Au,alpha_x=0.3,alpha_y=0.3", true, 0.02, 0.01},
    {"glossy metal", "ggx_conductor:metal=Cu,alpha_x=0.08,alpha_y=0.08", true, 0.02, 0.01},
    {"brushed metal", "ggx_conductor:metal=Al,alpha_x=0.15,alpha_y=0.4", false, 0.08, 0.01},
    {"diffuse", "lambert:reflectance=0.7/0.4/0.2", true, 0.02, 0.01},
    {"plastic", "0.04*ggx_schlick:f0=1,alpha=0.15+lambert:reflectance=0.5/0.2/0.1", true, 0.03, 0.01}};

const AnalyticBsdf& source(const Case& c) {
  static std::map<std::string, AnalyticBsdf> made;
  auto found = made.find(c.name);
  if (found == made.end()) found = made.try_emplace(c.name, c.material, c.isotropic).first;
  return found->second;
}
const RglBsdf& encoded(const Case& c) {
  static std::map<std::string, RglBsdf> made;
  auto found = made.find(c.name);
  if (found == made.end()) {
    const AnalyticBsdf& s = source(c);
    found = made.emplace(c.name, parse_rgl(encode_rgl(tabulate_rgl(s, rgl_resolution(s))), c.name)).first;
  }
  return found->second;
}
Vec3d at_angle(double theta_deg, double phi = 0.7) { return spherical_direction(theta_deg * pi / 180, phi); }

TEST(RglTabulation, IsTheMaterialAtTheNodes) {
  for (const Case& c : cases) {
    const RglBsdf& bsdf = encoded(c);
    const auto [theta_i, phi_i, nodes] = rgl_resolution(source(c));
    const RglTables tables = bsdf.tables();
    int compared = 0;
    for (int i = 0; i < 4000; ++i) {
      const std::size_t t = hash(1, i, 0) % theta_i, p = hash(1, i, 1) % phi_i;
      const Vec3d wo = spherical_direction(double(tables.theta_i[t]), double(tables.phi_i[p]));
      const Vec2d s{double(hash(1, i, 2) % nodes) / double(nodes - 1),
                    double(hash(1, i, 3) % nodes) / double(nodes - 1)};
      const Vec3d wi = bsdf.direction(wo, s).first;
      if (!(wi.z > 0.02) || s.x == 0) continue; // at s.x = 0 every azimuth is the same direction
      std::array<float, 3> f, truth;
      ASSERT_TRUE(bsdf.evaluate(wo, wi, f));
      source(c).evaluate(wo, wi, truth);
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(f[k], truth[k], 2e-3f * truth[k])
            << c.name << " theta " << tables.theta_i[t] << " s " << s.x << ' ' << s.y;
      ++compared;
    }
    EXPECT_GT(compared, 1000);
  }
}

TEST(RglTabulation, IsNearTheMaterialBetweenTheNodes) {
  for (const Case& c : cases) {
    double squares = 0, worst = 0;
    int n = 0;
    for (int i = 0; i < 20000; ++i) {
      const Vec3d wo = random_direction(i, 0, std::cos(75 * pi / 180));
      // Half from the material's own lobe, half anywhere.
      const Vec3d wi = i % 2 ? random_direction(i, 2, std::cos(75 * pi / 180))
                             : encoded(c).sample(wo, 0.9, {random(i, 2), random(i, 3)});
      if (wi.z < std::cos(75 * pi / 180)) continue;
      std::array<float, 3> f, truth;
      encoded(c).evaluate(wo, wi, f);
      source(c).evaluate(wo, wi, truth);
      const double e = double(f[1]) / double(truth[1]) - 1;
      squares += e * e, ++n;
      worst = std::max(worst, std::abs(e));
    }
    const double rms = std::sqrt(squares / n);
    std::cout << c.name << ": relative error rms " << rms << ", worst " << worst << '\n';
    EXPECT_LT(rms, c.rms) << c.name;
  }
}

/// The upper hemisphere in polar coordinates about the mirror direction of wo, to the horizon at t = 1: fine
/// where the lobe is, and no cell straddles the horizon.
struct MirrorChart {
  Vec3d axis;
  Frame<double> frame;

  explicit MirrorChart(const Vec3d& wo) : axis{-wo.x, -wo.y, wo.z}, frame(Frame<double>::around(axis)) {}
  double horizon(double azimuth) const {
    return std::atan2(axis.z, -(frame.s.z * std::cos(azimuth) + frame.t.z * std::sin(azimuth)));
  }
  /// Direction at t and azimuth in [0, 1], and solid angle a unit of their square.
  DirectionNode at(double t, double azimuth) const {
    const double a = 2 * pi * azimuth, range = horizon(a), angle = range * t * t * t;
    return {axis * std::cos(angle) + (frame.s * std::cos(a) + frame.t * std::sin(a)) * std::sin(angle),
            std::sin(angle) * 3 * range * t * t * 2 * pi};
  }
  Vec2d find(const Vec3d& w) const {
    const double x = dot(w, frame.s), y = dot(w, frame.t), a = std::atan2(y, x);
    const double angle = std::atan2(std::sqrt(x * x + y * y), dot(w, axis));
    return {std::min(std::cbrt(angle / horizon(a)), 1 - 1e-9),
            std::min(a / (2 * pi) + (a < 0 ? 1 : 0), 1 - 1e-9)};
  }
};

/// Of f and of the density over wi.
std::pair<double, double> albedo_and_probability(const RglBsdf& b, const MeasuredBsdf& f, const Vec3d& wo) {
  double albedo = 0, probability = 0;
  const int n = 200;
  const MirrorChart chart(wo);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const auto [wi, weight] = chart.at((i + 0.5) / n, (j + 0.5) / n);
      albedo += f.rgb(wo, wi)[1] * wi.z * weight / (n * n);
      probability += b.pdf(wo, wi) * weight / (n * n);
    }
  return {albedo, probability};
}

TEST(RglTabulation, KeepsTheAlbedoAndTheDensityIntegratesToAtMostOne) {
  for (const Case& c : cases)
    for (const double theta : {0.0, 20.0, 45.0, 60.0, 75.0, 85.0}) {
      const Vec3d wo = at_angle(theta);
      const auto [albedo, probability] = albedo_and_probability(encoded(c), encoded(c), wo);
      const double truth = albedo_and_probability(encoded(c), source(c), wo).first;
      std::cout << c.name << " at " << theta << ": albedo " << albedo << " of " << truth << ", density "
                << probability << '\n';
      EXPECT_NEAR(albedo, truth, theta <= 75 ? c.albedo : 0.05) << c.name << " at " << theta;
      EXPECT_LT(albedo, 1.01) << c.name;
      // What is missing are samples below the horizon, half a cell of luminance around it.
      EXPECT_LT(probability, 1.003) << c.name << " at " << theta;
      EXPECT_GT(probability, theta <= 75 ? 0.95 : 0.85) << c.name << " at " << theta;
    }
}

TEST(RglTabulation, IsAsReciprocalAsTheMaterialButForInterpolation) {
  for (const Case& c : cases) {
    double squares = 0;
    int n = 0;
    for (int i = 0; i < 10000; ++i) {
      const Vec3d a = random_direction(i, 0, std::cos(70 * pi / 180)),
                  b = random_direction(i, 2, std::cos(70 * pi / 180));
      const double x = encoded(c).rgb(a, b)[1], y = encoded(c).rgb(b, a)[1];
      squares += sqr(2 * (x - y) / (x + y)), ++n;
    }
    std::cout << c.name << ": reciprocity error rms " << std::sqrt(squares / n) << '\n';
    EXPECT_LT(std::sqrt(squares / n), 2 * c.rms) << c.name;
  }
}

TEST(RglTabulation, MeanOfFCosOverPdfIsTheAlbedoAndVariesLittle) {
  for (const Case& c : cases)
    for (const double theta : {10.0, 50.0, 80.0}) {
      const Vec3d wo = at_angle(theta);
      RunningMoments estimate;
      for (int i = 0; i < 40000; ++i) {
        const Vec3d wi = encoded(c).sample(wo, random(i, 0), {random(i, 1), random(i, 2)});
        const double p = encoded(c).pdf(wo, wi);
        estimate.add(wi.z > 0 && p > 0 ? encoded(c).rgb(wo, wi)[1] * wi.z / p : 0);
      }
      const double albedo = albedo_and_probability(encoded(c), encoded(c), wo).first;
      // Five deviations of the mean, and what the quadrature leaves.
      EXPECT_NEAR(estimate.mean(), albedo, 5 * estimate.standard_error() + 2e-3 * albedo)
          << c.name << " at " << theta;
      const double spread = std::sqrt(estimate.variance()) / estimate.mean();
      std::cout << c.name << " at " << theta << ": deviation of an estimate / mean " << spread << '\n';
      EXPECT_LT(spread, theta > 70 ? 0.8 : 0.5) << c.name << " at " << theta;
    }
}

TEST(RglTabulation, SpectraAreKeptWavelengthByWavelength) {
  const AnalyticBsdf metal("ggx_conductor:metal=Au,alpha_x=0.3,alpha_y=0.3", true, {450, 500, 550, 600});
  const RglBsdf bsdf = parse_rgl(encode_rgl(tabulate_rgl(metal, {16, 1, 32})), "x.bsdf");
  EXPECT_EQ(bsdf.channels().wavelengths_nm(), metal.channels().wavelengths_nm());
  for (int i = 0; i < 500; ++i) {
    const Vec3d wo = random_direction(i, 0, 0.4);
    const Vec3d wi = bsdf.sample(wo, 0.9, {random(i, 2), random(i, 3)});
    if (wi.z < 0.3) continue;
    std::array<float, 4> f, truth;
    bsdf.evaluate(wo, wi, f);
    metal.evaluate(wo, wi, truth);
    for (std::size_t k = 0; k < 4; ++k) // the lobe's error of interpolation is common to all
      EXPECT_NEAR(f[k] / f[0], truth[k] / truth[0], 0.025f * truth[k] / truth[0]);
  }
}

TEST(RglBsdf, SamplesStandForAllPairsOfDirections) {
  for (const Case& c : {cases[0], cases[2]}) {
    const MeasuredSamples s = encoded(c).samples();
    double total = 0, albedo = 0;
    for (std::size_t i = 0; i < s.size(); ++i) {
      total += s.weight[i];
      albedo += s.weight[i] * double(s.f[3 * i + 1]) * double(s.wi[i].z) * double(s.wo[i].z);
    }
    // The weights of one wo sum to the hemisphere; the mean over wo of albedo cos is that of the material.
    double truth = 0, sphere = 0;
    for (const auto& [wo, weight] : hemisphere_rule(3, 3)) {
      truth += weight * wo.z * albedo_and_probability(encoded(c), source(c), wo).first;
      sphere += weight * 2 * pi;
    }
    EXPECT_NEAR(albedo / total * sphere, truth, 0.05 * truth) << c.name;
  }
}

/// Sampling against density, in cells about the mirror direction, and the share above the horizon.
void expect_sampling_fits(const RglBsdf& bsdf, const Vec3d& wo, int n, double significance) {
  const int cells = 16, fine = 20, size = cells * fine;
  const MirrorChart chart(wo);
  std::vector<double> found(cells * cells), expected(cells * cells);
  int above = 0;
  for (int i = 0; i < n; ++i) {
    const Vec3d w = bsdf.sample(wo, random(i, 3), {random(i, 4), random(i, 5)});
    if (!(w.z > 0)) continue;
    const Vec2d at = chart.find(w);
    ++found[std::size_t(int(at.x * cells) * cells + int(at.y * cells))];
    ++above;
  }
  double total = 0;
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j) {
      const auto [w, weight] = chart.at((i + 0.5) / size, (j + 0.5) / size);
      const double p = bsdf.pdf(wo, w) * weight / (size * size);
      expected[std::size_t((i / fine) * cells + j / fine)] += p;
      total += p;
    }
  EXPECT_NEAR(above / double(n), total, 5 * std::sqrt(total * std::max(1 - total, 0.0) / n) + 3e-3);
  for (double& e : expected)
    e *= above / total;
  const ChiSquareResult result = chi_square_test(found, expected);
  EXPECT_GT(result.p, significance) << "wo " << wo.x << ' ' << wo.y << ' ' << wo.z << ", statistic "
                                    << result.statistic << " of " << result.degrees_of_freedom;
}

TEST(RglBsdf, SamplesFollowTheDensity) {
  const RglBsdf rough(random_tables({0}, false)), turned(random_tables(whole_turn, true)),
      half(random_tables({-3.14159265f, -2, -0.4f, 0}, false)),
      quarter(random_tables({-3.14159265f, -2.5f, -1.57079633f}, false));
  for (const RglBsdf* b : {&rough, &turned, &half, &quarter})
    for (const double phi : {0.4, 2.5, -2.0})
      expect_sampling_fits(*b, at_angle(50, phi), 30000, sidak_significance(1e-4, 17));
  for (const Case& c : cases)
    expect_sampling_fits(encoded(c), at_angle(40), 30000, sidak_significance(1e-4, 17));
}

} // namespace
} // namespace nacre

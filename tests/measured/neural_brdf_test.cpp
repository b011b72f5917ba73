#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "core/random.h"
#include "measured/formats/nbrdf.h"
#include "measured/hdf5_file.h"
#include "measured/merl_table.h"
#include "measured/mutated_files.h"
#include "measured/rusinkiewicz.h"

#include <cstring>
#include <filesystem>

namespace nacre {
namespace {

using testing::AllOf;
using testing::HasSubstr;
namespace fs = std::filesystem;

const fs::path data = fs::path(NACRE_SOURCE_DIR) / "../shared/data/measured";

/// A network with weights of a seed, shaped as the published ones.
NeuralBrdf random_network(std::uint64_t seed) {
  std::vector<NeuralBrdf::Layer> layers;
  for (const auto& [in, out] : {std::pair{6, 21}, std::pair{21, 21}, std::pair{21, 3}}) {
    NeuralBrdf::Layer l{std::size_t(in), std::size_t(out), {}, {}};
    for (int i = 0; i < in * out; ++i)
      l.kernel.push_back(uniform(seed, layers.size(), std::uint64_t(i), 0) - 0.4f);
    for (int i = 0; i < out; ++i)
      l.bias.push_back(uniform(seed, layers.size(), std::uint64_t(i), 1) - 0.5f);
    layers.push_back(l);
  }
  return NeuralBrdf(layers);
}

std::string message_of(std::span<const std::uint8_t> bytes, bool hdf5 = false) {
  try {
    if (hdf5)
      parse_nbrdf_h5(bytes, "x.h5");
    else
      parse_nbrdf_npy(bytes, "x.npy");
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

/// f of the definition, in double, without packs.
std::array<double, 3> by_definition(const NeuralBrdf& n, double h, double d, double phi) {
  std::vector<double> x{std::sin(h), 0, std::cos(h), std::sin(d) * std::cos(phi), std::sin(d) * std::sin(phi),
                        std::cos(d)};
  for (std::size_t l = 0; l < n.layers().size(); ++l) {
    const auto& layer = n.layers()[l];
    std::vector<double> y(layer.bias.begin(), layer.bias.end());
    for (std::size_t i = 0; i < layer.inputs; ++i)
      for (std::size_t o = 0; o < layer.outputs; ++o)
        y[o] += x[i] * double(layer.kernel[i * layer.outputs + o]);
    if (l + 1 < n.layers().size())
      for (double& v : y)
        v = std::max(v, 0.0);
    x = y;
  }
  return {std::max(std::exp(x[0]) - 1, 0.0), std::max(std::exp(x[1]) - 1, 0.0),
          std::max(std::exp(x[2]) - 1, 0.0)};
}

TEST(NeuralBrdf, PacksGiveWhatTheDefinitionGives) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const NeuralBrdf n = random_network(seed);
    for (std::uint64_t i = 0; i < 20; ++i) {
      const double h = 1.5 * double(uniform(seed, i, 0, 0)), d = 1.5 * double(uniform(seed, i, 1, 0)),
                   phi = 3 * double(uniform(seed, i, 2, 0));
      const auto expected = by_definition(n, h, d, phi);
      const auto found = n.value(h, d, phi);
      // Sums of some 500 products of floats in three layers.
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(double(found[c]), expected[c], 3e-5 * (1 + expected[c])) << seed << ' ' << h << ' ' << d;
    }
  }
}

TEST(NeuralBrdf, IsReciprocalAndZeroBelowTheSurface) {
  const NeuralBrdf n = random_network(3);
  std::array<float, 3> f, g;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const auto up = [&](std::uint64_t k) {
      return normalize(Vec3d{double(uniform(7, i, k, 0)) - 0.5, double(uniform(7, i, k, 1)) - 0.5,
                             0.02 + double(uniform(7, i, k, 2))});
    };
    const Vec3d wo = up(0), wi = up(1);
    EXPECT_TRUE(n.evaluate(wo, wi, f));
    EXPECT_TRUE(n.evaluate(wi, wo, g));
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(double(f[c]), double(g[c]), 1e-4 * (1 + double(f[c])));
    EXPECT_FALSE(n.evaluate(wo, -wi, f));
    EXPECT_EQ(f[0], 0);
  }
}

TEST(NeuralBrdf, SamplesAreTheNetworksValues) {
  const NeuralBrdf n = random_network(5);
  const MeasuredSamples s = n.samples();
  EXPECT_GT(s.size(), 10000u);
  ASSERT_EQ(s.f.size(), 3 * s.size());
  std::array<float, 3> f;
  for (std::size_t i = 0; i < s.size(); i += 101) {
    const auto wide = [](const Vec3f& w) { return normalize(Vec3d{double(w.x), double(w.y), double(w.z)}); };
    const Vec3d wo = wide(s.wo[i]), wi = wide(s.wi[i]);
    if (half_difference(wo, wi).theta_h < 1e-3) continue; // phi_d is arbitrary
    ASSERT_TRUE(n.evaluate(wo, wi, f));
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(double(f[c]), double(s.f[3 * i + c]), 2e-3 * (1 + double(f[c])));
    EXPECT_GT(s.weight[i], 0);
  }
}

TEST(NeuralBrdf, PublishedWeightsGiveTheTablesMadeFromThem) {
  if (!fs::exists(data / "nbrdf")) GTEST_SKIP() << "no ../shared/data/measured/nbrdf";
  for (const char* material : {"alum-bronze", "gold-metallic-paint"}) {
    const std::string network_path = (data / "nbrdf" / (std::string(material) + ".h5")).string(),
                      table_path = (data / "merl" / (std::string(material) + ".binary")).string();
    const auto network = read_measured(network_path);
    const auto& n = dynamic_cast<const NeuralBrdf&>(*network);
    const auto table = read_merl(table_path);
    double worst = 0;
    std::size_t compared = 0;
    for (int i = 0; i < 90; ++i)
      for (int j = 0; j < 90; ++j)
        for (int k = 0; k < 180; k += 7) {
          if (table->is_hole(i, j, k)) continue;
          const auto a = table->node(i, j, k);
          const auto f = n.value(a.theta_h, a.theta_d, a.phi_d);
          for (std::size_t c = 0; c < 3; ++c) {
            const double t = double(table->cell(i, j, k)[c]);
            worst = std::max(worst, std::abs(double(f[c]) - t) / (t + 1e-3));
          }
          ++compared;
        }
    EXPECT_GT(compared, 100000u);
    EXPECT_LT(worst, 1e-3) << material; // both in float
    // And through directions, where the table has its own nodes.
    const auto a = table->node(12, 30, 44);
    const auto [wo, wi] = directions(a);
    std::array<float, 3> f;
    ASSERT_TRUE(n.evaluate(wo, wi, f));
    EXPECT_NEAR(double(f[0]), double(table->cell(12, 30, 44)[0]), 1e-3 * double(f[0]));
  }
}

TEST(NeuralBrdf, AllPublishedFilesAreRead) {
  if (!fs::exists(data / "nbrdf")) GTEST_SKIP() << "no ../shared/data/measured/nbrdf";
  int read = 0;
  for (const auto& entry : fs::directory_iterator(data / "nbrdf")) {
    const auto m = read_measured(entry.path().string());
    const auto rgb = m->rgb({0, 0, 1}, normalize(Vec3d{0.3, 0, 1}));
    EXPECT_TRUE(rgb[0] > 0 && rgb[0] < 1e4) << entry.path();
    ++read;
  }
  EXPECT_EQ(read, 53);
}

TEST(NeuralFormat, KerasFilesSurviveTheRoundTrip) {
  const NeuralBrdf n = random_network(11), back = parse_nbrdf_h5(encode_nbrdf_h5(n), "x.h5");
  ASSERT_EQ(back.layers().size(), 3u);
  for (std::size_t l = 0; l < 3; ++l) {
    EXPECT_EQ(back.layers()[l].kernel, n.layers()[l].kernel);
    EXPECT_EQ(back.layers()[l].bias, n.layers()[l].bias);
  }
}

TEST(NeuralFormat, ArraysOfNumpySurviveTheRoundTrip) {
  const NeuralBrdf n = random_network(11), back = parse_nbrdf_npy(encode_nbrdf_npy(n), "x.npy");
  ASSERT_EQ(back.layers().size(), 3u);
  for (std::size_t l = 0; l < 3; ++l) {
    EXPECT_EQ(back.layers()[l].kernel, n.layers()[l].kernel);
    EXPECT_EQ(back.layers()[l].bias, n.layers()[l].bias);
  }
}

TEST(NeuralFormat, SixFilesOfNumpyAreReadByTheNameOfAny) {
  const NeuralBrdf n = random_network(12);
  const auto all = encode_nbrdf_npy(n);
  // Cut where each array begins.
  std::vector<std::size_t> begins;
  for (std::size_t i = 0; i + 6 < all.size(); ++i)
    if (std::memcmp(&all[i], "\x93NUMPY", 6) == 0) begins.push_back(i);
  ASSERT_EQ(begins.size(), 6u);
  begins.push_back(all.size());
  const std::array<const char*, 6> parts{"fc1", "b1", "fc2", "b2", "fc3", "b3"};
  const fs::path folder = fs::path(testing::TempDir()) / "nacre_six_npy";
  fs::create_directories(folder);
  for (std::size_t i = 0; i < 6; ++i)
    write_file_atomically((folder / ("gold_" + std::string(parts[i]) + ".npy")).string(),
                          std::span(all).subspan(begins[i], begins[i + 1] - begins[i]));
  for (const char* part : parts) {
    const auto m = read_measured((folder / ("gold_" + std::string(part) + ".npy")).string());
    EXPECT_EQ(dynamic_cast<const NeuralBrdf&>(*m).layers()[1].kernel, n.layers()[1].kernel);
  }
  fs::remove(folder / "gold_b2.npy");
  try {
    read_measured((folder / "gold_fc1.npy").string());
    ADD_FAILURE() << "no error";
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("gold_b2.npy"), HasSubstr("no such file")));
  }
  fs::remove_all(folder);
}

TEST(NeuralFormat, WhatIsWrongIsNamedWithItsPlace) {
  const auto whole = encode_nbrdf_npy(random_network(1));
  EXPECT_THAT(message_of({}), HasSubstr("byte 0"));
  EXPECT_THAT(message_of(std::span(whole).first(100)), HasSubstr("byte"));
  auto bytes = whole;
  bytes[0] = 'x';
  EXPECT_THAT(message_of(bytes), AllOf(HasSubstr("byte 0"), HasSubstr("NUMPY")));
  bytes = whole;
  const float nan = std::nanf("");
  std::memcpy(&bytes[128 + 40], &nan, 4);
  EXPECT_THAT(message_of(bytes), AllOf(HasSubstr("byte 168"), HasSubstr("nan")));
  bytes.assign(whole.begin(), whole.begin() + 128 + 6 * 21 * 4);
  EXPECT_THAT(message_of(bytes), AllOf(HasSubstr("byte 632"), HasSubstr("bias")));
  auto layers = random_network(1).layers();
  EXPECT_NO_THROW(NeuralBrdf({layers[0], layers[2]}));
  EXPECT_THROW(NeuralBrdf({layers[0], layers[1]}), Error);
  layers[2].bias.pop_back();
  EXPECT_THROW(NeuralBrdf{layers}, Error);
}

TEST(NeuralFormat, MutatedArraysGiveANetworkOrAnError) {
  const auto whole = encode_nbrdf_npy(random_network(1));
  int networks = 0, errors = 0;
  for (int n = 0; n < 10000; ++n) {
    auto bytes = whole;
    auto random = [&, d = 0](std::size_t below) mutable { return hash(42, n, d++) % below; };
    for (std::size_t edits = 1 + random(3); edits > 0; --edits)
      switch (random(4)) {
      case 0:
        bytes.resize(random(bytes.size() + 1));
        break;
      case 1:
        if (!bytes.empty())
          bytes[random(std::min<std::size_t>(bytes.size(), 128))] = std::uint8_t(random(256));
        break;
      case 2:
        if (!bytes.empty()) bytes[random(bytes.size())] ^= std::uint8_t(1u << random(8));
        break;
      default:
        if (!bytes.empty()) bytes.erase(bytes.begin() + std::ptrdiff_t(random(bytes.size())));
      }
    try {
      const NeuralBrdf network = parse_nbrdf_npy(bytes, "mutant");
      for (const float x : network.value(0.3, 0.4, 0.5))
        ASSERT_TRUE(std::isfinite(x) && x >= 0) << "mutant " << n;
      ++networks;
    } catch (const Error&) {
      ++errors;
    }
  }
  EXPECT_GT(networks, 500);
  EXPECT_GT(errors, 500);
}

TEST(NeuralFormat, MutatedHdf5FilesGiveANetworkOrAnError) {
  const auto whole = encode_nbrdf_h5(random_network(1));
  int networks = 0, errors = 0;
  for (int n = 0; n < 20000; ++n) {
    const auto bytes = mutated_hdf5(whole, 43, std::size_t(n));
    try {
      parse_nbrdf_h5(bytes, "mutant");
      ++networks;
    } catch (const Error&) {
      ++errors;
    }
  }
  EXPECT_GT(networks, 1000);
  EXPECT_GT(errors, 1000);
}

TEST(Hdf5, CutFilesAreErrorsWithAnOffset) {
  const auto whole = encode_nbrdf_h5(random_network(1));
  for (std::size_t size = 0; size < whole.size(); size += size < 1000 ? 1 : 97)
    EXPECT_THAT(message_of(std::span(whole).first(size), true), HasSubstr("byte"));
}

} // namespace
} // namespace nacre

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "core/random.h"
#include "core/warp.h"
#include "measured/formats.h"
#include "measured/formats/container.h"
#include "measured/formats/hdf5_writer.h"
#include "measured/formats/nbrdf.h"
#include "measured/formats/window_xml.h"
#include "measured/hdf5_file.h"
#include "measured/merl_table.h"
#include "measured/mutated_files.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <thread>

namespace nacre {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Pair;
namespace fs = std::filesystem;

/// Random floats of many magnitudes, a tenth of them holes.
MerlTable random_table(int n_theta_h, int n_theta_d, int n_phi_d) {
  std::vector<MerlTable::Cell> cells(std::size_t(n_theta_h) * std::size_t(n_theta_d) * std::size_t(n_phi_d));
  for (std::size_t c = 0; c < cells.size(); ++c)
    if (uniform(1, c, 0, 0) > 0.1f)
      cells[c] = {std::pow(10.0f, 12 * uniform(1, c, 1, 0) - 8), uniform(1, c, 2, 0), 0.0f, 1.0f};
  return MerlTable(n_theta_h, n_theta_d, n_phi_d, std::move(cells));
}

NeuralBrdf small_network() {
  std::vector<NeuralBrdf::Layer> layers;
  for (const auto& [in, out] : {std::pair{6, 5}, std::pair{5, 3}}) {
    NeuralBrdf::Layer l{std::size_t(in), std::size_t(out), {}, std::vector<float>(std::size_t(out), 0.1f)};
    for (int i = 0; i < in * out; ++i)
      l.kernel.push_back(uniform(9, layers.size(), std::uint64_t(i), 0) - 0.3f);
    layers.push_back(l);
  }
  return NeuralBrdf(layers);
}

/// Spectral samples that are no file.
class Scattered final : public MeasuredBsdf {
public:
  std::string kind() const override { return "scattered"; }
  std::vector<std::pair<std::string, std::string>> facts() const override {
    return {{"instrument", "none: a test"}};
  }
  const Channels& channels() const override {
    static const Channels c = Channels::spectral({400, 500.5, 700});
    return c;
  }
  bool is_isotropic() const override { return true; }
  bool evaluate(const Vec3d&, const Vec3d&, std::span<float>) const override { return false; }
  MeasuredSamples samples() const override {
    MeasuredSamples s;
    for (std::uint64_t i = 0; i < 50; ++i) {
      const auto w = [&](std::uint64_t k) {
        const Vec3d d =
            square_to_cosine_hemisphere(Vec2d{double(uniform(3, i, k, 0)), double(uniform(3, i, k, 1))});
        return Vec3f{float(d.x), float(d.y), float(d.z)};
      };
      s.wo.push_back(w(0));
      s.wi.push_back(w(1));
      for (int c = 0; c < 3; ++c)
        s.f.push_back(uniform(3, i, 2, std::uint64_t(c)) - 0.1f);
      s.weight.push_back(1.0 / double(i + 3));
    }
    return s;
  }
};

std::string message_of(std::span<const std::uint8_t> bytes) {
  try {
    parse_container(bytes, "x.nbsdf");
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

struct Folder {
  fs::path path = fs::path(testing::TempDir()) / "nacre_container";
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
  std::string operator/(const std::string& name) const { return (path / name).string(); }
};

TEST(Container, TablesAreKeptBitForBitWithTheirHoles) {
  for (const auto& n : std::vector<std::array<int, 3>>{{1, 1, 1}, {3, 1, 5}, {7, 9, 12}, {4, 5, 360}}) {
    const MerlTable table = random_table(n[0], n[1], n[2]);
    const auto back = parse_container(encode_container(table), "x.nbsdf");
    const auto& t = dynamic_cast<const MerlTable&>(*back);
    EXPECT_EQ(t.n_theta_h(), n[0]);
    EXPECT_EQ(t.n_theta_d(), n[1]);
    EXPECT_EQ(t.n_phi_d(), n[2]);
    EXPECT_EQ(t.hole_count(), table.hole_count());
    EXPECT_TRUE(std::equal(table.cells().begin(), table.cells().end(), t.cells().begin(), t.cells().end()));
  }
}

TEST(Container, WhatWasReadFromAFileIsKeptAsThatFile) {
  const Folder folder;
  const NeuralBrdf network = small_network();
  const auto npy = encode_nbrdf_npy(network);
  write_file_atomically(folder / "gold.npy", npy);
  const auto xml = encode_window_xml(make_klems(network, KlemsBasis::standard()[2]));
  write_file_atomically(folder / "blind.xml", xml);
  for (const auto& [name, format, original] :
       {std::tuple{"gold.npy", "nbrdf-npy", npy}, {"blind.xml", "window", xml}}) {
    const auto read = read_measured(folder / name);
    ASSERT_TRUE(read->source());
    EXPECT_EQ(read->source()->format, format);
    const auto container = encode_container(*read);
    write_file_atomically(folder / "c.nbsdf", container);
    const auto back = read_measured(folder / "c.nbsdf");
    EXPECT_EQ(back->kind(), read->kind());
    const auto facts = container_facts(container, "c.nbsdf");
    EXPECT_THAT(facts, Contains(Pair("source_file", name)));
    EXPECT_THAT(facts, Contains(Pair("source_format", format)));
    EXPECT_THAT(facts, Contains(Pair("kind", read->kind())));
    const Hdf5File file(container, "c.nbsdf");
    const auto bytes = file.array("file/bytes").bytes;
    EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), original.begin(), original.end()));
    for (std::uint64_t k = 0; k < 200; ++k) {
      const Vec3d wo = square_to_cosine_hemisphere(
                      Vec2d{double(uniform(1, k, 0, 0)), double(uniform(1, k, 1, 0))}),
                  wi = square_to_cosine_hemisphere(
                      Vec2d{double(uniform(1, k, 2, 0)), double(uniform(1, k, 3, 0))});
      std::array<float, 3> f{}, g{};
      EXPECT_EQ(read->evaluate(wo, wi, f), back->evaluate(wo, wi, g));
      EXPECT_EQ(f, g);
    }
    // What was read from a container becomes the same container again.
    EXPECT_EQ(encode_container(*back), container);
  }
  const auto read = read_measured(folder / "gold.npy");
  write_file_atomically(folder / "gold.npy", std::span(npy).first(npy.size() - 1));
  EXPECT_THROW(encode_container(*read), Error); // it is another file now
}

TEST(Container, NetworksMadeInMemoryAreKept) {
  const NeuralBrdf network = small_network();
  const auto back = parse_container(encode_container(network), "x");
  EXPECT_EQ(dynamic_cast<const NeuralBrdf&>(*back).layers()[1].kernel, network.layers()[1].kernel);
}

TEST(Container, SamplesAreKeptBitForBitWithTheirChannels) {
  const Scattered scattered;
  const auto container = encode_container(scattered);
  const auto back = parse_container(container, "x.nbsdf");
  const MeasuredSamples s = scattered.samples(), kept = back->samples();
  EXPECT_EQ(back->channels().wavelengths_nm(), scattered.channels().wavelengths_nm());
  EXPECT_EQ(kept.f, s.f);
  EXPECT_EQ(Hdf5File(container, "x.nbsdf").doubles("samples/weight"), s.weight);
  ASSERT_EQ(kept.size(), s.size());
  EXPECT_EQ(std::memcmp(kept.wo.data(), s.wo.data(), s.size() * sizeof(Vec3f)), 0);
  EXPECT_EQ(std::memcmp(kept.wi.data(), s.wi.data(), s.size() * sizeof(Vec3f)), 0);
  EXPECT_TRUE(back->is_isotropic());
  EXPECT_EQ(back->kind(), "scattered");
  EXPECT_THAT(back->facts(), Contains(Pair("instrument", "none: a test")));
}

TEST(Container, EntriesThatWereFilledStayMarked) {
  std::vector<MerlTable::Cell> cells(12, {1, 2, 3, 1});
  cells[5] = {};
  std::vector<bool> filled(12);
  filled[3] = filled[7] = true;
  const auto back = parse_container(encode_container(MerlTable(2, 3, 2, cells, filled)), "x.nbsdf");
  const auto& t = dynamic_cast<const MerlTable&>(*back);
  EXPECT_EQ(t.filled_count(), 2u);
  EXPECT_TRUE(t.is_filled(0, 1, 1) && t.is_filled(1, 0, 1) && t.is_hole(0, 2, 1));
}

TEST(Container, TheSameMeasurementGivesTheSameBytes) {
  const MerlTable table = random_table(4, 5, 6);
  const auto first = encode_container(table);
  std::this_thread::sleep_for(std::chrono::milliseconds(1100)); // times of files count seconds
  EXPECT_EQ(encode_container(table), first);
}

TEST(Container, ManyThreadsMayWrite) {
  const MerlTable table = random_table(4, 5, 6);
  const auto first = encode_container(table);
  std::vector<std::thread> threads;
  std::atomic<int> same = 0;
  for (int t = 0; t < 8; ++t)
    threads.emplace_back([&] {
      for (int n = 0; n < 10; ++n)
        same += encode_container(table) == first;
    });
  for (std::thread& t : threads)
    t.join();
  EXPECT_EQ(same, 80);
}

TEST(Container, WhatIsWrongIsNamed) {
  EXPECT_THAT(message_of({}), HasSubstr("byte 0"));
  const auto build = [](const std::function<void(Hdf5Writer&)>& more, int version = 1,
                        const char* content = "merl") {
    Hdf5Writer file;
    file.attribute("/", "format", "nacre-nbsdf");
    file.attribute("/", "version", version);
    file.attribute("/", "content", content);
    more(file);
    return file.finish();
  };
  const auto nothing = [](Hdf5Writer&) {};
  EXPECT_THAT(message_of(build(nothing)), HasSubstr("no array 'merl/rgb'"));
  EXPECT_THAT(message_of(build(nothing, 2)), AllOf(HasSubstr("version 2"), HasSubstr("reads version 1")));
  EXPECT_THAT(message_of(build(nothing, 1, "melr")), HasSubstr("melr"));
  {
    Hdf5Writer other;
    other.attribute("/", "format", "something");
    EXPECT_THAT(message_of(other.finish()), AllOf(HasSubstr("not a container"), HasSubstr("something")));
  }
  const std::array<std::uint64_t, 4> shape{1, 1, 2, 3};
  const auto table = [&](std::vector<float> rgb, std::vector<std::uint8_t> state) {
    return build([&](Hdf5Writer& file) {
      file.group("merl");
      file.array("merl/rgb", shape, rgb.data());
      const std::array<std::uint64_t, 3> states{1, 1, state.size()};
      file.array("merl/state", states, state.data());
    });
  };
  EXPECT_EQ(message_of(table({1, 2, 3, 4, 5, 6}, {1, 2})), "no error");
  EXPECT_THAT(message_of(table({1, 2, 3, 4, 5, 6}, {1, 3})),
              AllOf(HasSubstr("byte"), HasSubstr("0, 1 or 2")));
  EXPECT_THAT(message_of(table({1, 2, 3, 4, 5, 6}, {1})), HasSubstr("1 x 1 x 1, expected 1 x 1 x 2"));
  EXPECT_THAT(message_of(table({1, 2, -3, 4, 5, 6}, {1, 1})), HasSubstr("-3"));
  EXPECT_THAT(message_of(table({1, 2, 3, 4, 5, NAN}, {1, 0})), HasSubstr("finite"));
  EXPECT_THAT(message_of(build(
                  [](Hdf5Writer& file) {
                    const std::array<std::uint64_t, 1> one{1};
                    const std::uint8_t byte = 7;
                    file.group("file");
                    file.array("file/bytes", one, &byte);
                    file.attribute("file", "format", "merll");
                  },
                  1, "file")),
              HasSubstr("did you mean 'merl'"));
  // A container in a container would be read by a reader that may call itself.
  EXPECT_THAT(message_of(build(
                  [&](Hdf5Writer& file) {
                    const auto inner = encode_container(random_table(1, 1, 1));
                    const std::array<std::uint64_t, 1> size{inner.size()};
                    file.group("file");
                    file.array("file/bytes", size, inner.data());
                    file.attribute("file", "format", "nbsdf");
                  },
                  1, "file")),
              HasSubstr("not read"));
}

TEST(Container, MutatedFilesGiveAMeasurementOrAnError) {
  std::vector<std::vector<std::uint8_t>> seeds;
  seeds.push_back(encode_container(random_table(3, 4, 5)));
  seeds.push_back(encode_container(small_network()));
  seeds.push_back(encode_container(Scattered()));
  int read = 0, errors = 0;
  for (int n = 0; n < 30000; ++n) {
    const auto bytes = mutated_hdf5(seeds[std::size_t(n) % seeds.size()], 44, std::size_t(n));
    try {
      parse_container(bytes, "mutant");
      ++read;
    } catch (const Error&) {
      ++errors;
    }
  }
  EXPECT_GT(read, 1000);
  EXPECT_GT(errors, 1000);
}

TEST(Hdf5, WrittenArraysAndAttributesAreReadBack) {
  Hdf5Writer writer;
  writer.group("a");
  writer.group("a/b");
  std::vector<float> x{1, 2, 3, 4, 5, 6};
  const std::vector<double> y{0.1, 1e-300};
  const std::array<std::uint64_t, 2> shape{2, 3};
  const std::array<std::uint64_t, 1> two{2}, none{0};
  writer.array("a/b/x", shape, x.data());
  writer.array("a/y", two, y.data());
  writer.array("empty", none, x.data());
  for (int i = 0; i < 100; ++i) // a group of many leaves of its tree
    writer.array("a/b/n" + std::to_string(i), two, y.data());
  for (int i = 0; i < 40; ++i) // headers of several pieces
    writer.attribute("a/y", "note" + std::to_string(i), "text " + std::to_string(i));
  const auto bytes = writer.finish();
  const Hdf5File file(bytes, "f.h5");
  EXPECT_EQ(file.floats("a/b/x"), x);
  EXPECT_EQ(file.array("a/b/x").shape, (std::vector<std::uint64_t>{2, 3}));
  EXPECT_EQ(file.doubles("a/y"), y);
  EXPECT_EQ(file.doubles("a/b/n99"), y);
  EXPECT_EQ(file.floats("empty").size(), 0u);
  EXPECT_EQ(file.arrays().size(), 103u);
  EXPECT_EQ(file.text("a/y@note39"), "text 39");
  EXPECT_THROW(file.array("a/b/xx"), Error);
}

} // namespace
} // namespace nacre

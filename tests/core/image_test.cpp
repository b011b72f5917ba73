#include "core/image.h"

#include "core/error.h"
#include "core/file.h"
#include "core/jpeg.h"
#include "core/scratch_folder.h"

#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <cmath>
#include <csignal>
#include <cstring>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <sys/resource.h>

namespace nacre {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Image noise(int width, int height, std::vector<std::string> channels, std::uint32_t seed = 1) {
  Image image(width, height, std::move(channels));
  std::mt19937 random(seed);
  for (float& x : image.data)
    x = std::ldexp(static_cast<float>(random() % 4096) / 2048 - 1, static_cast<int>(random() % 20) - 10);
  return image;
}

/// A Radiance picture of 9 x 2 pixels with the runs of either kind.
std::string hdr_header(const char* more = "") {
  return fmt::format("#?RADIANCE\n# by a test\n{}FORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 9\n", more);
}
const std::string hdr_row = std::string("\x02\x02\x00\x09", 4) + "\x89\x40" + // 9 times 64
                            "\x88\x20\x01\x60" +                              // 8 times 32, and 96
                            std::string("\x89\x00", 2) + "\x89\x81";          // 0; exponent 1
const std::string hdr_old_row = std::string("\x40\x20\x00\x81", 4) + std::string("\x01\x01\x01\x07", 4) +
                                std::string("\x40\x60\x00\x81", 4);

TEST(Hdr, RunsOfBothKindsAreTheSamePicture) {
  const ScratchFolder folder;
  const std::string path = folder / "a.hdr";
  for (const char* exposure : {"", "EXPOSURE=2\nEXPOSURE= 2\n"}) {
    write_file_atomically(path, hdr_header(exposure) + hdr_row + hdr_old_row);
    const Image image = read_hdr(path);
    ASSERT_EQ(image.width, 9);
    ASSERT_EQ(image.height, 2);
    // Ward 1991: (m + 1/2) / 256 2^(e - 128), here e = 129; exposures are divided out.
    const float scale = *exposure ? 2.0f / 256 / 4 : 2.0f / 256;
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 9; ++x)
        EXPECT_THAT(std::vector<float>(image.at(x, y), image.at(x, y) + 3),
                    ElementsAre(64.5f * scale, (x < 8 ? 32.5f : 96.5f) * scale, 0.5f * scale))
            << x << ", " << y;
    EXPECT_EQ(read_image_linear(path).data, image.data);
  }
}

TEST(Hdr, DamagedFilesAreErrorsWithTheirPlace) {
  const ScratchFolder folder;
  const std::string path = folder / "a.hdr", whole = hdr_header() + hdr_row + hdr_old_row;
  const auto error = [&](const std::string& bytes) {
    write_file_atomically(path, bytes);
    try {
      read_hdr(path);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  for (std::size_t n = 0; n < whole.size(); ++n)
    EXPECT_FALSE(error(whole.substr(0, n)).empty()) << "of the first " << n << " bytes";
  EXPECT_THAT(error("P6\n"), HasSubstr("#?RADIANCE"));
  EXPECT_THAT(error("#?RADIANCE\n\n-Y 2 +X 9\n"), HasSubstr("FORMAT"));
  EXPECT_THAT(error("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n"), HasSubstr("xyze"));
  EXPECT_THAT(error("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n+X 9 -Y 2\n"), HasSubstr("+X 9 -Y 2"));
  EXPECT_THAT(error("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 99999999 +X 99999999\n"), HasSubstr("at most"));
  EXPECT_THAT(error(hdr_header("EXPOSURE=0\n") + hdr_row), HasSubstr("EXPOSURE"));
  const std::string row = std::string("\x02\x02\x00\x09", 4);
  EXPECT_THAT(error(hdr_header() + row + std::string(60, '\0')), HasSubstr("run of 0"));
  EXPECT_THAT(error(hdr_header() + row + "\x8a" + std::string(60, '\x40')), HasSubstr("run of 10"));
  EXPECT_THAT(error(hdr_header() + std::string("\x01\x01\x01\x07", 4) + std::string(60, 'x')),
              HasSubstr("repeat"));
}

/// Without the care for a lost power line that makes write_file_atomically slow a thousand times over.
void put_file(const std::string& path, const std::uint8_t* bytes, std::size_t n) {
  std::filesystem::remove(path);
  std::FILE* file = std::fopen(path.c_str(), "wb");
  ASSERT_NE(file, nullptr);
  if (n > 0) {
    EXPECT_EQ(std::fwrite(bytes, 1, n, file), n);
  }
  std::fclose(file);
}

std::string read_error(const std::string& path) {
  return message_of<Error>([&] { read_exr(path); });
}

/// A file written by the library itself, of one channel "Y" whose value at (x, y) of the data window is
/// 100 y + x, so that tests do not depend on Nacre's own writer.
struct Foreign {
  Imath::Box2i window{{0, 0}, {6, 4}};
  Imf::Compression compression = Imf::ZIP_COMPRESSION;
  int x_sampling = 1;

  std::string scanlines(const std::string& path) const {
    Imf::Header header = make_header();
    std::vector<float> data = values();
    Imf::FrameBuffer pixels;
    pixels.insert("Y", slice(data));
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(pixels);
    file.writePixels(window.max.y - window.min.y + 1);
    return path;
  }
  std::string tiles(const std::string& path, Imf::LevelMode levels) const {
    Imf::Header header = make_header();
    header.setTileDescription(Imf::TileDescription(2, 3, levels));
    std::vector<float> data = values();
    Imf::TiledOutputFile file(path.c_str(), header);
    for (int level = 0; level < file.numLevels(); ++level) {
      Imf::FrameBuffer pixels;
      pixels.insert("Y", slice(data)); // coarser levels repeat the corner of the finest
      file.setFrameBuffer(pixels);
      file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
    }
    return path;
  }
  void expect_same(const Image& image) const {
    ASSERT_EQ(image.width, window.max.x - window.min.x + 1);
    ASSERT_EQ(image.height, window.max.y - window.min.y + 1);
    ASSERT_THAT(image.channels, ElementsAre("Y"));
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        ASSERT_EQ(*image.at(x, y), static_cast<float>(100 * y + x)) << x << ", " << y;
  }

private:
  Imf::Header make_header() const {
    Imf::Header header(Imath::Box2i({0, 0}, {99, 99}), window);
    header.compression() = compression;
    header.channels().insert("Y", Imf::Channel(Imf::FLOAT, x_sampling, 1));
    return header;
  }
  std::vector<float> values() const {
    const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
    std::vector<float> data(static_cast<std::size_t>(width * height));
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        data[static_cast<std::size_t>(y * width + x)] = static_cast<float>(100 * y + x);
    return data;
  }
  Imf::Slice slice(std::vector<float>& data) const {
    return Imf::Slice::Make(Imf::FLOAT, data.data(), window, sizeof(float),
                            sizeof(float) * static_cast<std::size_t>(window.max.x - window.min.x + 1),
                            x_sampling, 1);
  }
};

TEST(Exr, FloatsMetadataAndChannelOrderComeBackUnchanged) {
  const ScratchFolder folder;
  Image image = noise(37, 23, {"R", "G", "B", "A", "variance.R", "variance.G", "variance.B"});
  image.data[0] = std::numeric_limits<float>::infinity();
  image.data[1] = std::numeric_limits<float>::quiet_NaN();
  image.data[2] = std::numeric_limits<float>::denorm_min();
  image.metadata = {{"nacre.seed", "7"},
                    {"nacre.a_name_longer_than_thirty_one_characters", "long"},
                    {"comments", "two\nlines"},
                    {"empty", ""}};
  write_exr(image, folder / "a.exr");
  const Image back = read_exr(folder / "a.exr");
  EXPECT_EQ(back.width, 37);
  EXPECT_EQ(back.height, 23);
  EXPECT_EQ(back.channels, image.channels);
  EXPECT_EQ(back.metadata, image.metadata);
  ASSERT_EQ(back.data.size(), image.data.size());
  EXPECT_EQ(std::memcmp(back.data.data(), image.data.data(), image.data.size() * sizeof(float)), 0);
  EXPECT_EQ(back.channel("G"), 1);
  EXPECT_EQ(back.channel("Z"), -1);
  EXPECT_THAT(folder.contents(), ElementsAre("a.exr"));
}

TEST(Exr, FilesAreZipCompressedWithChannelsSortedByName) {
  const ScratchFolder folder;
  write_exr(noise(4, 4, {"R", "G", "B"}), folder / "a.exr");
  Imf::InputFile file((folder / "a.exr").c_str());
  EXPECT_EQ(file.header().compression(), Imf::ZIP_COMPRESSION);
  std::vector<std::string> names;
  for (auto c = file.header().channels().begin(); c != file.header().channels().end(); ++c)
    names.emplace_back(c.name());
  EXPECT_THAT(names, ElementsAre("B", "G", "R"));
}

TEST(Exr, HalvesAreRoundedAndLargeValuesStayFinite) {
  const ScratchFolder folder;
  Image image = noise(16, 16, {"Y"});
  image.data[0] = 1e6f;
  image.data[1] = -1e6f;
  image.data[2] = std::numeric_limits<float>::infinity();
  write_exr(image, folder / "a.exr", true);
  const Image back = read_exr(folder / "a.exr");
  EXPECT_EQ(back.data[0], 65504.0f);
  EXPECT_EQ(back.data[1], -65504.0f);
  EXPECT_EQ(back.data[2], std::numeric_limits<float>::infinity());
  for (std::size_t i = 3; i < image.data.size(); ++i) // 11 significant bits, rounded to nearest
    EXPECT_NEAR(back.data[i], image.data[i], std::abs(image.data[i]) / 2048 + 1e-7);
}

TEST(Exr, ReadsTheDataWindowWhereverItLies) {
  const ScratchFolder folder;
  for (const Imath::V2i& corner : {Imath::V2i(0, 0), Imath::V2i(13, 57), Imath::V2i(-200, -3)}) {
    const Foreign foreign{.window = {corner, corner + Imath::V2i(6, 4)}};
    foreign.expect_same(read_exr(foreign.scanlines(folder / "a.exr")));
    foreign.expect_same(read_exr(foreign.tiles(folder / "a.exr", Imf::ONE_LEVEL)));
  }
}

TEST(Exr, ReadsEveryLosslessCompression) {
  const ScratchFolder folder;
  for (const Imf::Compression c : {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION,
                                   Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
    const Foreign foreign{.window = {{0, 0}, {20, 70}}, .compression = c};
    foreign.expect_same(read_exr(foreign.scanlines(folder / "a.exr")));
    foreign.expect_same(read_exr(foreign.tiles(folder / "a.exr", Imf::ONE_LEVEL)));
  }
}

TEST(Exr, OfSeveralLevelsTheFinestIsRead) {
  const ScratchFolder folder;
  const Foreign foreign;
  foreign.expect_same(read_exr(foreign.tiles(folder / "a.exr", Imf::MIPMAP_LEVELS)));
}

TEST(Exr, ReadsWholeNumberAndMixedChannels) {
  const ScratchFolder folder;
  Imf::Header header(2, 1);
  header.channels().insert("id", Imf::Channel(Imf::UINT));
  header.channels().insert("R", Imf::Channel(Imf::HALF));
  header.insert("nacre.number", Imf::FloatAttribute(1));
  std::uint32_t ids[2] = {3, 70000};
  half red[2] = {0.5f, -2.0f};
  Imf::FrameBuffer pixels;
  pixels.insert("id", Imf::Slice(Imf::UINT, reinterpret_cast<char*>(ids), 4, 8));
  pixels.insert("R", Imf::Slice(Imf::HALF, reinterpret_cast<char*>(red), 2, 4));
  {
    Imf::OutputFile file((folder / "a.exr").c_str(), header);
    file.setFrameBuffer(pixels);
    file.writePixels(1);
  }
  const Image image = read_exr(folder / "a.exr");
  EXPECT_THAT(image.channels, ElementsAre("R", "id"));
  EXPECT_THAT(image.data, ElementsAre(0.5f, 3.0f, -2.0f, 70000.0f));
  EXPECT_THAT(image.metadata, IsEmpty()) << "only text becomes metadata";
}

TEST(Exr, MetadataNeverOverwritesWhatTheFormatNeeds) {
  const ScratchFolder folder;
  Image image = noise(2, 2, {"Y"});
  image.metadata = {{"channels", "x"}, {"dataWindow", "x"},     {"type", "x"},
                    {"tiles", "x"},    {"chromaticities", "x"}, {"owner", "me"}};
  write_exr(image, folder / "a.exr");
  EXPECT_EQ(read_exr(folder / "a.exr").metadata, (std::map<std::string, std::string>{{"owner", "me"}}));
}

TEST(Exr, WhatNacreDoesNotReadIsSaid) {
  const ScratchFolder folder;
  const Foreign chroma{.window = {{0, 0}, {7, 4}}, .x_sampling = 2};
  EXPECT_THAT(read_error(chroma.scanlines(folder / "a.exr")), HasSubstr("subsampled 2 x 1"));
  EXPECT_THAT(read_error(folder / "none.exr"), HasSubstr("no such file"));
  EXPECT_THAT(read_error(folder.path()), HasSubstr("is a directory"));
  write_file_atomically(folder / "text.exr", "This is not an image at all, but text.");
  EXPECT_EQ(read_error(folder / "text.exr"),
            folder / "text.exr" + ": byte 0: not an OpenEXR file: it begins with another magic number");
  std::vector<std::uint8_t> bytes = read_file(Foreign().scanlines(folder / "b.exr"));
  bytes[5] |= 0x10;
  write_file_atomically(folder / "parts.exr", bytes);
  EXPECT_THAT(read_error(folder / "parts.exr"), AllOf(HasSubstr("byte 4"), HasSubstr("multi-part")));
}

TEST(Exr, ATruncatedFileIsAnErrorAtEveryLength) {
  const ScratchFolder folder;
  const Foreign foreign{.window = {{0, 0}, {9, 39}}};
  for (const bool tiled : {false, true}) {
    const std::vector<std::uint8_t> whole = read_file(tiled ? foreign.tiles(folder / "a.exr", Imf::ONE_LEVEL)
                                                            : foreign.scanlines(folder / "a.exr"));
    for (std::size_t n = 0; n < whole.size(); n += n < 700 ? 1 : 7) {
      put_file(folder / "b.exr", whole.data(), n);
      ASSERT_THAT(read_error(folder / "b.exr"), HasSubstr("b.exr: byte "))
          << n << " of " << whole.size() << " bytes";
    }
  }
}

/// Where the value of attribute `name` begins.
std::size_t value_offset(const std::vector<std::uint8_t>& bytes, const std::string& name) {
  const std::string text(bytes.begin(), bytes.end());
  const std::size_t at = text.find(name + '\0');
  return text.find('\0', at + name.size() + 1) + 1 + 4;
}
void put_32(std::vector<std::uint8_t>& bytes, std::size_t at, std::uint32_t x) {
  for (int i = 0; i < 4; ++i)
    bytes[at + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(x >> (8 * i));
}

TEST(Exr, HostileSizesAreRefusedBeforeAnythingIsAllocated) {
  const ScratchFolder folder;
  const std::vector<std::uint8_t> whole = read_file(Foreign().scanlines(folder / "a.exr"));
  const auto with = [&](std::size_t at, std::vector<std::uint32_t> values) {
    std::vector<std::uint8_t> bytes = whole;
    for (std::size_t i = 0; i < values.size(); ++i)
      put_32(bytes, at + 4 * i, values[i]);
    write_file_atomically(folder / "b.exr", bytes);
    return read_error(folder / "b.exr");
  };
  const std::size_t window = value_offset(whole, "dataWindow"), channels = value_offset(whole, "channels");
  const std::uint32_t lowest = 0x80000000u, highest = 0x7fffffffu;
  EXPECT_THAT(with(window, {lowest, lowest, highest, highest}), HasSubstr("claims 4294967296 x 4294967296"));
  EXPECT_THAT(with(window, {0, 0, 99999, 99999}), HasSubstr("claims 100000 x 100000"));
  EXPECT_THAT(with(window, {0, 0, 0, 99999999}), HasSubstr("the file ends before its pixels"));
  EXPECT_THAT(with(window, {0, 0, 99999999, 0}), HasSubstr("claims blocks of more than"));
  EXPECT_THAT(with(window, {0, 0, 999'999, 4}), HasSubstr("more than its"));
  EXPECT_THAT(with(window, {5, 5, 4, 4}), HasSubstr("the data window is 0 x 0 pixels"));
  EXPECT_THAT(with(window, {highest, 0, lowest, 0}), HasSubstr("pixels"));
  EXPECT_THAT(with(window - 4, {0xffffffffu}), HasSubstr("the file ends within an attribute"));
  EXPECT_THAT(with(channels - 4, {0x7fffffffu}), HasSubstr("the file ends within an attribute"));
  EXPECT_THAT(with(channels + 2, {77}), HasSubstr("pixel type 77"));
  EXPECT_THAT(with(0, {0}), HasSubstr("magic number"));
}

TEST(Exr, AnImageOfOneColourIsNotTakenForAFalseClaim) {
  const ScratchFolder folder;
  for (int c = Imf::NO_COMPRESSION; c < Imf::NUM_COMPRESSION_METHODS; ++c) {
    Imf::Header header(2048, 512);
    header.compression() = static_cast<Imf::Compression>(c);
    header.channels().insert("Y", Imf::Channel(Imf::HALF));
    std::vector<half> data(2048 * 512, half(0));
    Imf::FrameBuffer pixels;
    pixels.insert("Y", Imf::Slice(Imf::HALF, reinterpret_cast<char*>(data.data()), 2, 4096));
    {
      Imf::OutputFile file((folder / "a.exr").c_str(), header);
      file.setFrameBuffer(pixels);
      file.writePixels(512);
    }
    EXPECT_EQ(read_exr(folder / "a.exr").data, std::vector<float>(2048 * 512)) << "compression " << c;
  }
}

TEST(Exr, NotANumberInTheHeaderIsHarmless) {
  const ScratchFolder folder;
  std::vector<std::uint8_t> bytes = read_file(Foreign().scanlines(folder / "a.exr"));
  put_32(bytes, value_offset(bytes, "pixelAspectRatio"), 0x7fc00000u);
  put_32(bytes, value_offset(bytes, "screenWindowWidth"), 0x7fc00000u);
  write_file_atomically(folder / "b.exr", bytes);
  EXPECT_THAT(read_error(folder / "b.exr"), HasSubstr("b.exr: not a readable OpenEXR image"));
}

TEST(Exr, DamagedBytesGiveAnErrorOrAnImageNeverACrash) {
  const ScratchFolder folder;
  std::mt19937 random(5);
  for (const Imf::Compression c :
       {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
    const Foreign foreign{.window = {{0, 0}, {9, 39}}, .compression = c};
    const std::vector<std::uint8_t> whole = read_file(foreign.scanlines(folder / "a.exr"));
    int errors = 0;
    for (int trial = 0; trial < 500; ++trial) {
      std::vector<std::uint8_t> bytes = whole;
      for (int flips = 0; flips < 3; ++flips)
        bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
      put_file(folder / "b.exr", bytes.data(), bytes.size());
      try {
        read_exr(folder / "b.exr");
      } catch (const Error&) {
        ++errors;
      }
    }
    EXPECT_GT(errors, 0) << "the damage never reached anything that is checked";
  }
}

TEST(Exr, WhatCannotBeWrittenIsSaidAndLeavesNothing) {
  const ScratchFolder folder;
  const auto error = [&](const Image& image) {
    return message_of<Error>([&] { write_exr(image, folder / "a.exr"); });
  };
  EXPECT_THAT(error(Image()), HasSubstr("0 x 0 pixels"));
  EXPECT_THAT(error(Image(2, 2, {"R", "R"})), HasSubstr("two channels 'R'"));
  EXPECT_THAT(error(Image(2, 2, {""})), HasSubstr("cannot name an EXR channel"));
  Image image(2, 2, {"Y"});
  image.data.pop_back();
  EXPECT_THAT(error(image), HasSubstr("holds 3"));
  image = Image(2, 2, {"Y"});
  image.metadata[""] = "x";
  EXPECT_THAT(error(image), HasSubstr("cannot name an EXR attribute"));
  EXPECT_THAT(message_of<Error>([&] { write_exr(Image(2, 2, {"Y"}), folder / "none/a.exr"); }),
              HasSubstr("there is no folder"));
  {
    rlimit before{};
    ::getrlimit(RLIMIT_FSIZE, &before);
    rlimit limit = before;
    limit.rlim_cur = 1000;
    const auto signal = std::signal(SIGXFSZ, SIG_IGN);
    ::setrlimit(RLIMIT_FSIZE, &limit);
    const std::string message = error(noise(100, 100, {"Y"}));
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, signal);
    EXPECT_THAT(message, AllOf(HasSubstr("a.exr"), HasSubstr("File too large")));
  }
  EXPECT_THAT(folder.contents(), IsEmpty());
}

Image ramp(int width, int height, std::vector<std::string> channels) {
  Image image(width, height, std::move(channels));
  for (std::size_t i = 0; i < image.data.size(); ++i)
    image.data[i] = static_cast<float>(i * 37 % 256) / 255;
  return image;
}

TEST(Png, EightBitValuesComeBackUnchanged) {
  const ScratchFolder folder;
  for (const auto& channels : {std::vector<std::string>{"Y"}, std::vector<std::string>{"R", "G", "B"}}) {
    const Image image = ramp(33, 17, channels);
    write_png(image, folder / "a.png");
    const Image back = read_ldr(folder / "a.png");
    EXPECT_EQ(back.width, 33);
    EXPECT_EQ(back.height, 17);
    EXPECT_EQ(back.channels, channels);
    EXPECT_EQ(back.data, image.data);
    EXPECT_EQ(read_file(folder / "a.png"), encode_png(image));
  }
}

TEST(Png, ValuesOutsideTheRangeAreClampedAndOthersRounded) {
  const ScratchFolder folder;
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  Image image(7, 1, {"Y"});
  image.data = {-1, 2, inf, -inf, nan, 100.4f / 255, 100.6f / 255};
  write_png(image, folder / "a.png");
  EXPECT_THAT(read_ldr(folder / "a.png").data, ElementsAre(0, 1, 1, 0, 0, 100.0f / 255, 101.0f / 255));
}

TEST(Png, OtherChannelCountsAreRefused) {
  const ScratchFolder folder;
  EXPECT_THAT(message_of<Error>([&] {
                write_png(Image(2, 2, {"Y", "A"}), folder / "a.png");
              }),
              AllOf(HasSubstr("a.png"), HasSubstr("1 or 3 channels")));
  EXPECT_THROW(encode_png(Image()), Error);
  EXPECT_THAT(folder.contents(), IsEmpty());
}

TEST(Png, TruncationAndDamageAreErrors) {
  const ScratchFolder folder;
  const std::vector<std::uint8_t> whole = encode_png(ramp(9, 9, {"R", "G", "B"}));
  const auto damaged = [&](const std::vector<std::uint8_t>& bytes) {
    put_file(folder / "a.png", bytes.data(), bytes.size());
    return message_of<Error>([&] { read_ldr(folder / "a.png"); });
  };
  for (std::size_t n = 0; n < whole.size(); n += 3)
    ASSERT_THAT(damaged({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n)}), HasSubstr("a.png"));
  for (std::size_t i = 0; i < whole.size(); i += 5) {
    std::vector<std::uint8_t> bytes = whole;
    bytes[i] ^= 4;
    ASSERT_THAT(damaged(bytes), HasSubstr("a.png")) << "byte " << i;
  }
}

// A smooth picture loses little: quantisation at quality 90 is below 3 of 255 a coefficient near the mean.
TEST(Jpeg, ASmoothPictureComesBackNearly) {
  const ScratchFolder folder;
  Image image(40, 24, {"R", "G", "B"});
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      image.at(x, y)[0] = x / 40.0f, image.at(x, y)[1] = y / 24.0f, image.at(x, y)[2] = 0.5f;
  write_jpeg(image, folder / "a.jpg");
  const Image back = read_ldr(folder / "a.jpg");
  ASSERT_EQ(back.data.size(), image.data.size());
  double sum = 0;
  for (std::size_t i = 0; i < image.data.size(); ++i)
    sum += std::abs(back.data[i] - image.data[i]);
  EXPECT_LT(sum / double(image.data.size()), 3.0 / 255);
}

TEST(Jpeg, WhatItCannotHoldIsRefused) {
  const ScratchFolder folder;
  EXPECT_THAT(message_of<Error>([&] {
                write_jpeg(Image(70000, 1, {"R", "G", "B"}), folder / "a.jpg");
              }),
              AllOf(HasSubstr("a.jpg"), HasSubstr("65535 a side")));
  EXPECT_THROW(write_jpeg(Image(2, 2, {"Y", "A"}), folder / "a.jpg"), Error);
}

TEST(Png, SixteenBitsAreReadWithFullPrecision) {
  // 2 x 1 pixels of grey 0x8001 and 0x0102: IHDR, IDAT holding a stored zlib block, IEND.
  const std::vector<std::uint8_t> png = {
      0x89, 'P',  'N',  'G',  '\r', '\n', 0x1a, '\n', 0,    0,    0,    13,   'I',  'H',  'D',
      'R',  0,    0,    0,    2,    0,    0,    0,    1,    16,   0,    0,    0,    0,    0x81,
      0xd9, 0xfc, 0x15, 0,    0,    0,    16,   'I',  'D',  'A',  'T',  0x78, 0x01, 0x01, 0x05,
      0x00, 0xfa, 0xff, 0x00, 0x80, 0x01, 0x01, 0x02, 0x02, 0x0c, 0x00, 0x85, 0x6f, 0xa5, 0x2f,
      0xae, 0,    0,    0,    0,    'I',  'E',  'N',  'D',  0xae, 0x42, 0x60, 0x82};
  const ScratchFolder folder;
  write_file_atomically(folder / "a.png", png);
  EXPECT_THAT(read_ldr(folder / "a.png").data, ElementsAre(0x8001 / 65535.0f, 0x0102 / 65535.0f));
}

/// A 2 x 2 BMP of 24 bits, rows from the bottom up (or from the top down if `height` is -2): the first row in
/// the file is blue, green, the second red, white.
std::vector<std::uint8_t> bmp(std::int32_t height) {
  std::vector<std::uint8_t> b(54 + 16);
  b[0] = 'B', b[1] = 'M';
  put_32(b, 2, 70);
  put_32(b, 10, 54);
  put_32(b, 14, 40);
  put_32(b, 18, 2);
  put_32(b, 22, static_cast<std::uint32_t>(height));
  b[26] = 1, b[28] = 24;
  b[54] = 255;                 // blue
  b[58] = 255;                 // green
  b[64] = 255;                 // red
  b[65] = b[66] = b[67] = 255; // white
  return b;
}

TEST(Bmp, ReadsRowsOfEitherOrderAndRefusesATruncatedFile) {
  const ScratchFolder folder;
  write_file_atomically(folder / "a.bmp", bmp(2));
  EXPECT_THAT(read_ldr(folder / "a.bmp").data, ElementsAre(1, 0, 0, 1, 1, 1, 0, 0, 1, 0, 1, 0));
  write_file_atomically(folder / "a.bmp", bmp(-2));
  EXPECT_THAT(read_ldr(folder / "a.bmp").data, ElementsAre(0, 0, 1, 0, 1, 0, 1, 0, 0, 1, 1, 1));
  for (std::size_t n = 0; n < 70; ++n) {
    std::vector<std::uint8_t> bytes = bmp(2);
    bytes.resize(n);
    put_file(folder / "a.bmp", bytes.data(), n);
    EXPECT_THROW(read_ldr(folder / "a.bmp"), Error) << n;
  }
  for (const std::uint32_t huge : {0x7fffffffu, 0x80000000u, 0xffffffffu, 100'000'000u}) {
    std::vector<std::uint8_t> bytes = bmp(2);
    put_32(bytes, 18, huge);
    put_32(bytes, 22, huge);
    write_file_atomically(folder / "a.bmp", bytes);
    EXPECT_THROW(read_ldr(folder / "a.bmp"), Error) << huge;
  }
}

TEST(ReadImageLinear, DecodesSrgbOfPicturesAndLeavesExrAlone) {
  const ScratchFolder folder;
  Image image(4, 1, {"Y"});
  image.data = {0, 10.0f / 255, 0.5f, 1};
  write_png(image, folder / "a.PNG");
  const Image linear = read_image_linear(folder / "a.PNG");
  EXPECT_EQ(linear.data[0], 0);
  EXPECT_FLOAT_EQ(linear.data[1], 10.0f / 255 / 12.92f);
  EXPECT_NEAR(linear.data[2], 0.2158605, 1e-6) << "128 / 255 through IEC 61966-2-1";
  EXPECT_EQ(linear.data[3], 1);
  write_exr(image, folder / "a.exr");
  EXPECT_EQ(read_image_linear(folder / "a.exr").data, image.data);
}

TEST(ReadImageLinear, AnUnknownExtensionIsAnError) {
  for (const std::string name : {"a.tif", "a", "dir.exr/a", ""})
    EXPECT_THAT(message_of<Error>([&] { read_image_linear(name); }), HasSubstr(".png")) << name;
}

} // namespace
} // namespace nacre

#include "core/error.h"
#include "core/file.h"
#include "core/image.h"
#include "core/jpeg.h"
#include "core/srgb.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <limits>
#include <memory>
#include <string_view>

// The single definition of the picture library; warnings about its code are not ours to heed.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wsign-compare"
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_ONLY_BMP
#define STBI_NO_STDIO
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#include <stb/stb_image.h>
#define STBI_WRITE_NO_STDIO
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace nacre {
namespace {

using Bytes = std::vector<std::uint8_t>;

// 1 GiB of float values.
constexpr std::uint64_t most_values = std::uint64_t(1) << 28;
constexpr int most_height = 1 << 24;

std::uint32_t big_endian_32(const Bytes& b, std::size_t at) {
  return std::uint32_t(b[at]) << 24 | std::uint32_t(b[at + 1]) << 16 | std::uint32_t(b[at + 2]) << 8 |
         b[at + 3];
}
std::uint32_t little_endian_32(const Bytes& b, std::size_t at) {
  return std::uint32_t(b[at + 3]) << 24 | std::uint32_t(b[at + 2]) << 16 | std::uint32_t(b[at + 1]) << 8 |
         b[at];
}

/// CRC-32 of ISO 3309, as the PNG specification (W3C, annex D) demands for every chunk.
std::uint32_t crc32(const Bytes& b, std::size_t begin, std::size_t end) {
  static const auto table = [] {
    std::array<std::uint32_t, 256> t{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      t[i] = i;
      for (int bit = 0; bit < 8; ++bit)
        t[i] = (t[i] & 1 ? 0xedb88320u : 0u) ^ (t[i] >> 1);
    }
    return t;
  }();
  std::uint32_t crc = 0xffffffffu;
  for (std::size_t i = begin; i < end; ++i)
    crc = table[(crc ^ b[i]) & 0xff] ^ (crc >> 8);
  return ~crc;
}

// The decoder takes some damaged files for whole ones and invents the missing pixels; the following three
// checks find what it lets pass.

void check_png(const Bytes& b, const std::string& path) {
  for (std::size_t at = 8;;) {
    if (b.size() - at < 12) throw Error::in_binary(path, at, "the PNG file ends before its IEND chunk");
    const std::uint64_t size = big_endian_32(b, at);
    if (size > b.size() - at - 12)
      throw Error::in_binary(
          path, at, fmt::format("a PNG chunk of {} bytes, {} left in the file", size, b.size() - at - 12));
    const std::size_t end = at + 8 + size;
    if (crc32(b, at + 4, end) != big_endian_32(b, end))
      throw Error::in_binary(path, at, "a PNG chunk is damaged: its checksum is wrong");
    if (std::memcmp(&b[at + 4], "IEND", 4) == 0) return;
    at = end + 4;
  }
}

void check_jpeg(const Bytes& b, const std::string& path) {
  // Within the coded pixels 0xff is always followed by 0 or a restart marker, so the last start-of-scan is
  // the picture's own and the end-of-image must follow it.
  const auto last = [&](std::uint8_t marker) {
    for (std::size_t i = b.size() - 1; i > 0; --i)
      if (b[i - 1] == 0xff && b[i] == marker) return i;
    return std::size_t(0);
  };
  constexpr std::uint8_t start_of_scan = 0xda, end_of_image = 0xd9;
  if (last(end_of_image) < last(start_of_scan))
    throw Error::in_binary(path, b.size(), "the JPEG file ends before its end-of-image marker");
}

void check_bmp(const Bytes& b, const std::string& path, int width, int height) {
  if (b.size() < 54) throw Error::in_binary(path, b.size(), "the BMP file ends within its header");
  const bool old_header = little_endian_32(b, 14) == 12;
  const std::uint64_t bits = b[old_header ? 24 : 28], row = (bits * std::uint64_t(width) + 31) / 32 * 4;
  const std::uint64_t needed = little_endian_32(b, 10) + row * std::uint64_t(height);
  if (needed > b.size())
    throw Error::in_binary(path, b.size(),
                           fmt::format("the BMP file is truncated: {} bytes expected", needed));
}

bool begins_with(const Bytes& b, std::string_view magic) {
  return b.size() > magic.size() && std::memcmp(b.data(), magic.data(), magic.size()) == 0;
}

} // namespace

Image read_ldr(const std::string& path) {
  const Bytes bytes = read_file(path);
  if (bytes.size() > std::size_t(std::numeric_limits<int>::max()))
    throw Error::in_file(path, "a PNG, JPEG or BMP file of more than 2 GiB is not read");
  const bool png = begins_with(bytes, "\x89PNG\r\n\x1a\n"), jpeg = begins_with(bytes, "\xff\xd8\xff"),
             bmp = begins_with(bytes, "BM");
  if (!png && !jpeg && !bmp)
    throw Error::in_file(path, "neither a PNG nor a JPEG nor a BMP file: its first bytes are another's");
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  const auto decoder_error = [&] {
    const char* why = stbi_failure_reason();
    return Error::in_file(path, fmt::format("not a readable {} file: {}",
                                            png    ? "PNG"
                                            : jpeg ? "JPEG"
                                                   : "BMP",
                                            why ? why : "unknown reason"));
  };
  if (png) check_png(bytes, path);
  if (jpeg) check_jpeg(bytes, path);
  if (!stbi_info_from_memory(bytes.data(), size, &width, &height, &channels)) throw decoder_error();
  if (bmp && height < 0 && height > -most_height) height = -height; // rows from the top down
  if (width < 1 || height < 1 || std::uint64_t(width) * std::uint64_t(height) > most_values / 4)
    throw Error::in_file(
        path, fmt::format("claims {} x {} pixels; at most {} are read", width, height, most_values / 4));
  if (bmp) check_bmp(bytes, path, width, height);

  struct Release {
    void operator()(void* p) const { stbi_image_free(p); }
  };
  const bool deep = stbi_is_16_bit_from_memory(bytes.data(), size) != 0;
  const std::unique_ptr<void, Release> pixels(
      deep ? static_cast<void*>(stbi_load_16_from_memory(bytes.data(), size, &width, &height, &channels, 0))
           : stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, 0));
  if (!pixels) throw decoder_error();
  static const std::vector<std::string> names[] = {{"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}};
  Image image(width, height, names[channels - 1]);
  for (std::size_t i = 0; i < image.data.size(); ++i)
    image.data[i] = deep ? static_cast<float>(static_cast<const std::uint16_t*>(pixels.get())[i]) / 65535.0f
                         : static_cast<float>(static_cast<const std::uint8_t*>(pixels.get())[i]) / 255.0f;
  return image;
}

namespace {

/// Values in [0, 1] as bytes. @throws Error if `format` cannot hold them, or at most `largest` a side
Bytes bytes_of(const Image& image, std::string_view format, int largest) {
  const int channels = image.channel_count();
  if ((channels != 1 && channels != 3) || image.width < 1 || image.height < 1 || image.width > largest ||
      image.height > largest || std::uint64_t(image.width) * std::uint64_t(image.height) > most_values / 4 ||
      image.data.size() != std::size_t(image.width) * image.height * channels)
    throw Error(fmt::format("an image of {} x {} pixels and {} channels cannot be written as {}: 1 or 3 "
                            "channels and at most {} pixels, {} a side, are expected",
                            image.width, image.height, channels, format, most_values / 4, largest));
  Bytes pixels(image.data.size());
  std::transform(image.data.begin(), image.data.end(), pixels.begin(), [](float x) {
    // A NaN compares false and becomes 0.
    return static_cast<std::uint8_t>(x > 0 ? std::lround(std::min(x, 1.0f) * 255) : 0);
  });
  return pixels;
}

} // namespace

std::vector<std::uint8_t> encode_png(const Image& image) {
  const int channels = image.channel_count();
  const Bytes pixels = bytes_of(image, "PNG", std::numeric_limits<int>::max());
  Bytes png;
  const auto append = [](void* out, void* data, int size) {
    const auto* begin = static_cast<const std::uint8_t*>(data);
    static_cast<Bytes*>(out)->assign(begin, begin + size);
  };
  if (!stbi_write_png_to_func(append, &png, image.width, image.height, channels, pixels.data(),
                              image.width * channels))
    throw Error("the image cannot be encoded as PNG: not enough memory");
  return png;
}

void write_png(const Image& image, const std::string& path) {
  Bytes png;
  try {
    png = encode_png(image);
  } catch (const Error& e) {
    throw Error::in_file(path, e.what());
  }
  write_file_atomically(path, png);
}

void write_jpeg(const Image& image, const std::string& path, int quality) {
  Bytes jpeg;
  // The writer's pieces are small, and come one after the other.
  const auto append = [](void* out, void* data, int size) {
    const auto* begin = static_cast<const std::uint8_t*>(data);
    static_cast<Bytes*>(out)->insert(static_cast<Bytes*>(out)->end(), begin, begin + size);
  };
  try {
    const Bytes pixels = bytes_of(image, "JPEG", 65535);
    if (!stbi_write_jpg_to_func(append, &jpeg, image.width, image.height, image.channel_count(),
                                pixels.data(), std::clamp(quality, 1, 100)))
      throw Error("the image cannot be encoded as JPEG");
  } catch (const Error& e) {
    throw Error::in_file(path, e.what());
  }
  write_file_atomically(path, jpeg);
}

Image read_image_linear(const std::string& path) {
  const std::size_t dot = path.find_last_of("./");
  std::string extension = dot == std::string::npos || path[dot] == '/' ? "" : path.substr(dot);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".exr") return read_exr(path);
  if (extension == ".hdr") return read_hdr(path);
  static const std::string known[] = {".exr", ".hdr", ".png", ".jpg", ".jpeg", ".bmp"};
  if (std::find(std::begin(known), std::end(known), extension) == std::end(known))
    throw Error::in_file(path, fmt::format("not an image Nacre reads: the extension '{}' is none of .exr "
                                           ".hdr .png .jpg .jpeg .bmp",
                                           extension));
  Image image = read_ldr(path);
  const std::size_t n = image.channels.size();
  for (std::size_t i = 0; i < image.data.size(); ++i)
    if (image.channels[i % n] != "A") image.data[i] = static_cast<float>(srgb_decode(double(image.data[i])));
  return image;
}

} // namespace nacre

#include "core/exr/plausibility.h"

#include "core/error.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <fmt/format.h>
#include <optional>
#include <string_view>

namespace nacre {
namespace {

// 2 GiB of float values: a 16k x 8k RGB environment fits.
constexpr std::uint64_t most_values = std::uint64_t(1) << 29;
// The largest block of scanlines or tile the decoder holds at once.
constexpr std::uint64_t most_block_bytes = std::uint64_t(1) << 30;
constexpr std::int64_t most_channels = 4096;

/// Reads little-endian numbers and zero-ended names, never past the end.
class Cursor {
public:
  Cursor(std::span<const std::uint8_t> bytes, const std::string& path) : bytes_(bytes), path_(path) {}

  std::uint64_t position = 0;

  std::uint64_t size() const { return bytes_.size(); }
  std::uint64_t left() const { return bytes_.size() - position; }
  [[noreturn]] void fail(std::uint64_t offset, const std::string& message) const {
    throw Error::in_binary(path_, offset, message);
  }
  void require(std::uint64_t n, const char* what) const {
    if (n > left())
      fail(position, fmt::format("the file ends within {}: {} bytes expected, {} left", what, n, left()));
  }
  template <class T>
  T number(const char* what) {
    require(sizeof(T), what);
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i)
      value |= std::uint64_t(bytes_[position + i]) << (8 * i);
    position += sizeof(T);
    return static_cast<T>(value);
  }
  std::string_view name(const char* what) {
    constexpr std::uint64_t longest = 255;
    const auto* begin = bytes_.data() + position;
    const std::uint64_t reach = std::min(left(), longest + 1);
    const auto* end = static_cast<const std::uint8_t*>(std::memchr(begin, 0, reach));
    if (!end && left() <= longest) fail(position, fmt::format("the file ends within {}", what));
    if (!end) fail(position, fmt::format("{} is longer than {} bytes", what, longest));
    position += static_cast<std::uint64_t>(end - begin) + 1;
    return {reinterpret_cast<const char*>(begin), static_cast<std::size_t>(end - begin)};
  }

private:
  std::span<const std::uint8_t> bytes_;
  const std::string& path_;
};

struct Layout {
  std::int64_t width = 0, height = 0, channels = 0, bytes_per_pixel = 0;
  std::int64_t tile_width = 0, tile_height = 0; ///< 0: scanlines
  int compression = -1;
};

/// Scanlines in one block, by the number that names the compression in the file: none, rle, zips, zip, piz,
/// pxr24, b44, b44a, dwaa, dwab.
constexpr std::array<std::int64_t, 10> lines_per_block = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};

void read_channels(Cursor& in, std::uint64_t end, Layout& layout) {
  layout.channels = layout.bytes_per_pixel = 0;
  while (in.position < end) {
    const std::uint64_t at = in.position;
    const std::string_view name = in.name("a channel name");
    if (name.empty()) return;
    const auto type = in.number<std::uint32_t>("a channel");
    in.number<std::uint32_t>("a channel"); // perceptual linearity, a hint to lossy compression
    const auto x_sampling = in.number<std::int32_t>("a channel"),
               y_sampling = in.number<std::int32_t>("a channel");
    if (type > 2) in.fail(at, fmt::format("channel '{}' has pixel type {}, expected 0 to 2", name, type));
    if (x_sampling != 1 || y_sampling != 1)
      in.fail(at, fmt::format("channel '{}' is subsampled {} x {}; Nacre reads channels of full resolution",
                              name, x_sampling, y_sampling));
    layout.bytes_per_pixel += type == 1 ? 2 : 4;
    if (++layout.channels > most_channels) in.fail(at, fmt::format("more than {} channels", most_channels));
  }
  in.fail(in.position, "the channel list does not end where its size says");
}

void read_attribute(Cursor& in, std::string_view name, std::string_view type, std::uint64_t end,
                    Layout& layout) {
  const std::uint64_t at = in.position, size = end - at;
  const auto expect = [&](std::string_view right_type, std::uint64_t right_size) {
    if (type != right_type || (right_size > 0 && size != right_size))
      in.fail(at, fmt::format("attribute '{}' is a {} of {} bytes, expected a {}{}", name, type, size,
                              right_type, right_size > 0 ? fmt::format(" of {}", right_size) : ""));
  };
  if (name == "dataWindow") {
    expect("box2i", 16);
    std::array<std::int64_t, 4> box;
    for (auto& b : box)
      b = in.number<std::int32_t>("the data window");
    layout.width = box[2] - box[0] + 1;
    layout.height = box[3] - box[1] + 1;
    if (layout.width < 1 || layout.height < 1)
      in.fail(at, fmt::format("the data window is {} x {} pixels", layout.width, layout.height));
  } else if (name == "channels") {
    expect("chlist", 0);
    read_channels(in, end, layout);
  } else if (name == "compression") {
    expect("compression", 1);
    layout.compression = in.number<std::uint8_t>("the compression");
    if (layout.compression >= static_cast<int>(lines_per_block.size()))
      in.fail(at, fmt::format("unknown compression {}", layout.compression));
  } else if (name == "tiles") {
    expect("tiledesc", 9);
    layout.tile_width = in.number<std::uint32_t>("the tile size");
    layout.tile_height = in.number<std::uint32_t>("the tile size");
    if (layout.tile_width < 1 || layout.tile_height < 1)
      in.fail(at, fmt::format("tiles of {} x {} pixels", layout.tile_width, layout.tile_height));
  }
}

void check_size(const Cursor& in, const Layout& layout) {
  // No product here overflows: width and height are below 2^33, channels at most 2^12.
  const auto pixels = static_cast<unsigned __int128>(layout.width) * layout.height;
  if (pixels * layout.channels > most_values)
    in.fail(0, fmt::format("claims {} x {} pixels of {} channels; at most {} values are read", layout.width,
                           layout.height, layout.channels, most_values));
  const bool tiled = layout.tile_width > 0;
  const auto block = static_cast<unsigned __int128>(tiled ? layout.tile_width : layout.width) *
                     (tiled ? layout.tile_height : lines_per_block[layout.compression]) *
                     layout.bytes_per_pixel;
  if (block > most_block_bytes)
    in.fail(0, fmt::format("claims blocks of more than {} bytes; such a file is not read", most_block_bytes));
}

/// Bytes of pixels that one byte of a chunk can stand for at most: 1 uncompressed, 64 in runs of 128, 1032
/// deflated (and 4/3 of that with the 24-bit floats of pxr24), about 400 in piz's runs of Huffman codes; the
/// two dwa leave almost nothing of a constant image.
std::uint64_t most_expansion(int compression) {
  if (compression == 0) return 1;
  constexpr int dwaa = 8;
  return compression < dwaa ? 2048 : std::uint64_t(1) << 18;
}

std::uint64_t chunks_of_full_image(const Layout& layout) {
  const auto parts = [](std::int64_t size, std::int64_t step) { return (size + step - 1) / step; };
  if (layout.tile_width > 0)
    return parts(layout.width, layout.tile_width) * parts(layout.height, layout.tile_height);
  return parts(layout.height, lines_per_block[layout.compression]);
}

void check_chunks(Cursor& in, const Layout& layout) {
  const std::uint64_t chunks = chunks_of_full_image(layout), table = in.position;
  // Each chunk has an entry of 8 bytes here and begins with its coordinates and its size.
  const std::uint64_t head = layout.tile_width > 0 ? 20 : 8;
  if (chunks > in.left() / (8 + head))
    in.fail(table, fmt::format("the file ends before its pixels: {} chunks expected in {} bytes", chunks,
                               in.left()));
  std::uint64_t coded_bytes = 0;
  for (std::uint64_t i = 0; i < chunks; ++i) {
    in.position = table + 8 * i;
    const std::uint64_t entry = in.position;
    const auto offset = in.number<std::uint64_t>("the chunk table");
    if (offset < table + 8 * chunks)
      in.fail(entry, fmt::format("chunk {} of {} was never written: the file is incomplete", i + 1, chunks));
    if (offset > in.size() - head)
      in.fail(entry, fmt::format("chunk {} of {} lies beyond the end of the file, which is truncated", i + 1,
                                 chunks));
    in.position = offset + head - 4;
    const auto size = in.number<std::uint32_t>("a chunk");
    if (size > in.left())
      in.fail(offset, fmt::format("chunk {} of {} has {} bytes, the file only {} more: it is truncated",
                                  i + 1, chunks, size, in.left()));
    coded_bytes += size;
  }
  const auto pixel_bytes =
      static_cast<unsigned __int128>(layout.width) * layout.height * layout.bytes_per_pixel;
  if (pixel_bytes > static_cast<unsigned __int128>(coded_bytes) * most_expansion(layout.compression))
    in.fail(0,
            fmt::format("claims {} x {} pixels of {} channels, more than its {} bytes of pixel data can hold",
                        layout.width, layout.height, layout.channels, coded_bytes));
}

} // namespace

void check_exr_plausible(std::span<const std::uint8_t> bytes, const std::string& path) {
  Cursor in(bytes, path);
  if (in.number<std::uint32_t>("the magic number") != 20000630)
    in.fail(0, "not an OpenEXR file: it begins with another magic number");
  const auto version = in.number<std::uint32_t>("the version");
  if ((version & 0xff) != 2) in.fail(4, fmt::format("OpenEXR version {}, expected 2", version & 0xff));
  constexpr std::uint32_t tiled = 0x200, deep = 0x800, multi_part = 0x1000;
  if (version & deep) in.fail(4, "a deep image; Nacre reads images with one value a pixel and channel");
  if (version & multi_part) in.fail(4, "a multi-part file; Nacre reads files of one part");

  Layout layout;
  for (;;) {
    const std::string_view name = in.name("an attribute name");
    if (name.empty()) break;
    const std::string_view type = in.name("an attribute type");
    const auto size = in.number<std::uint32_t>("an attribute size");
    in.require(size, "an attribute");
    const std::uint64_t end = in.position + size;
    read_attribute(in, name, type, end, layout);
    in.position = end;
  }
  if (layout.width == 0) in.fail(in.position, "the header has no data window");
  if (layout.channels == 0) in.fail(in.position, "the header has no channels");
  if (layout.compression < 0) in.fail(in.position, "the header has no compression");
  if (!(version & tiled)) layout.tile_width = layout.tile_height = 0;
  if ((version & tiled) && layout.tile_width == 0) in.fail(in.position, "tiled, but without a tile size");
  check_size(in, layout);
  check_chunks(in, layout);
}

bool is_reserved_exr_attribute(const std::string& name) {
  // The required attributes, and the standard ones whose type is not text.
  static constexpr std::string_view reserved[] = {"adoptedNeutral",
                                                  "altitude",
                                                  "aperture",
                                                  "channels",
                                                  "chromaticities",
                                                  "chunkCount",
                                                  "compression",
                                                  "dataWindow",
                                                  "deepImageState",
                                                  "displayWindow",
                                                  "dwaCompressionLevel",
                                                  "envmap",
                                                  "expTime",
                                                  "focus",
                                                  "framesPerSecond",
                                                  "isoSpeed",
                                                  "keyCode",
                                                  "latitude",
                                                  "lineOrder",
                                                  "longitude",
                                                  "lookModTransform",
                                                  "maxSamplesPerPixel",
                                                  "multiView",
                                                  "name",
                                                  "originalDataWindow",
                                                  "pixelAspectRatio",
                                                  "preview",
                                                  "renderingTransform",
                                                  "screenWindowCenter",
                                                  "screenWindowWidth",
                                                  "tiles",
                                                  "timeCode",
                                                  "type",
                                                  "utcOffset",
                                                  "version",
                                                  "view",
                                                  "whiteLuminance",
                                                  "worldToCamera",
                                                  "worldToNDC",
                                                  "wrapmodes",
                                                  "xDensity"};
  return std::find(std::begin(reserved), std::end(reserved), name) != std::end(reserved);
}

} // namespace nacre

#pragma once
// Images: linear scene-referred float pixels in memory, EXR files with metadata, and 8-bit pictures.

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace nacre {

/// Float pixels, interleaved: data[(y * width + x) * channels.size() + c]; row 0 is the top.
struct Image {
  int width = 0, height = 0;
  std::vector<std::string> channels; ///< names as in the file: "R", "G", "B", "variance.R", ...
  std::vector<float> data;
  std::map<std::string, std::string> metadata; ///< text attributes of the file

  Image() = default;
  Image(int w, int h, std::vector<std::string> channel_names)
      : width(w), height(h), channels(std::move(channel_names)),
        data(static_cast<std::size_t>(w) * h * channels.size()) {}
  int channel_count() const { return static_cast<int>(channels.size()); }
  float* at(int x, int y) { return &data[(static_cast<std::size_t>(y) * width + x) * channels.size()]; }
  const float* at(int x, int y) const {
    return &data[(static_cast<std::size_t>(y) * width + x) * channels.size()];
  }
  /// Index of a channel, or -1.
  int channel(const std::string& name) const;
};

/// Reads an OpenEXR file of one part, scanlines or tiles (of several levels the finest): the pixels of its
/// data window, all channels as float, text attributes as metadata. Channels come in the order R G B A, then
/// others by name, layer by layer; the file keeps them sorted by name. A file of only luminance "Y" comes
/// back with that one channel. @throws Error, also for deep, multi-part and chroma-subsampled files
Image read_exr(const std::string& path);
/// Writes channels as 32-bit float (or 16-bit half, finite values clamped to +-65504), zip compressed, whole
/// or not at all. Metadata whose name means something else to the format ("channels", "type") is left out.
/// @throws Error
void write_exr(const Image& image, const std::string& path, bool half = false);

/// Radiance picture, .hdr or .pic, as radiance: the exposures of its header are divided out. @throws Error
Image read_hdr(const std::string& path);

/// 8- or 16-bit PNG, JPEG or BMP as stored values in [0, 1], 1 to 4 channels named R G B A (or Y, Y A), not
/// linearised. @throws Error, also for a truncated file or a wrong checksum
Image read_ldr(const std::string& path);
/// `image` has 1 or 3 channels already encoded for display in [0, 1]; rounds to 8 bits, clamps values outside
/// and takes NaN for 0. @throws Error
void write_png(const Image& image, const std::string& path);
/// The bytes of that PNG, to embed in a report.
std::vector<std::uint8_t> encode_png(const Image& image);

/// By extension: .exr, .hdr, or .png .jpg .jpeg .bmp converted from sRGB to linear (alpha is kept as it is).
/// @throws Error
Image read_image_linear(const std::string& path);

} // namespace nacre

// Radiance pictures (.hdr, .pic): three mantissas that share an exponent a pixel.
// Source: Ward 1991, Real Pixels, Graphics Gems II; run lengths as in Radiance's colour library since 2.0.
#include "core/error.h"
#include "core/file.h"
#include "core/image.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <string_view>

namespace nacre {
namespace {

// 1 GiB of float values.
constexpr std::uint64_t most_pixels = (std::uint64_t(1) << 28) / 3;

class HdrReader {
public:
  HdrReader(const std::vector<std::uint8_t>& bytes, const std::string& path) : bytes_(bytes), path_(path) {}

  Image read() {
    const std::string magic = line();
    if (magic != "#?RADIANCE" && magic != "#?RGBE")
      throw Error::in_binary(path_, 0, "not a Radiance picture: it does not begin with #?RADIANCE");
    double exposure = 1;
    bool known_format = false;
    for (std::string text = line(); !text.empty(); text = line()) {
      if (text.starts_with("FORMAT=")) {
        known_format = text == "FORMAT=32-bit_rle_rgbe";
        if (!known_format)
          throw Error::in_binary(
              path_, at_, fmt::format("expected FORMAT=32-bit_rle_rgbe, found '{}'", text.substr(0, 60)));
      } else if (text.starts_with("EXPOSURE=")) {
        exposure *= number(std::string_view(text).substr(9));
      }
    }
    if (!known_format) throw Error::in_binary(path_, at_, "the header names no FORMAT");
    read_size();
    // Every exposure that was applied is in the header: divided out, what is left is radiance.
    const float scale = float(1 / exposure);
    Image image(width_, height_, {"R", "G", "B"});
    std::vector<std::uint8_t> row(4 * std::size_t(width_));
    for (int y = 0; y < height_; ++y) {
      read_row(row);
      float* out = image.at(0, y);
      for (std::size_t i = 0; i < row.size(); i += 4, out += 3) {
        const float f = row[i + 3] ? std::ldexp(scale, int(row[i + 3]) - 136) : 0;
        // A mantissa was rounded down: half a step more is the middle of what it stands for.
        for (std::size_t c = 0; c < 3; ++c)
          out[c] = (float(row[i + c]) + 0.5f) * f;
      }
    }
    return image;
  }

private:
  [[noreturn]] void truncated() const {
    throw Error::in_binary(path_, bytes_.size(),
                           fmt::format("the picture of {} x {} pixels ends too early", width_, height_));
  }
  std::uint8_t byte() {
    if (at_ == bytes_.size()) truncated();
    return bytes_[at_++];
  }
  std::string line() {
    constexpr std::size_t longest = 4096;
    std::string text;
    while (at_ < bytes_.size() && bytes_[at_] != '\n') {
      text += char(bytes_[at_++]);
      if (text.size() > longest) throw Error::in_binary(path_, at_, "a header line without an end");
    }
    if (at_ == bytes_.size()) throw Error::in_binary(path_, at_, "the file ends within its header");
    ++at_;
    if (text.ends_with('\r')) text.pop_back();
    return text;
  }
  double number(std::string_view text) const {
    while (text.starts_with(' '))
      text.remove_prefix(1);
    double x = 0;
    const auto r = std::from_chars(text.data(), text.data() + text.size(), x);
    if (r.ec != std::errc() || !(x > 1e-30 && x < 1e30))
      throw Error::in_binary(path_, at_,
                             fmt::format("expected EXPOSURE=number, found '{}'", text.substr(0, 60)));
    return x;
  }
  void read_size() {
    const std::string text = line();
    const std::size_t x = text.find(" +X ");
    const char* end = text.data() + text.size();
    bool good = text.starts_with("-Y ") && x != std::string::npos;
    if (good) {
      const auto h = std::from_chars(text.data() + 3, end, height_);
      const auto w = std::from_chars(text.data() + x + 4, end, width_);
      good = h.ec == std::errc() && h.ptr == text.data() + x && w.ec == std::errc() && w.ptr == end;
    }
    if (!good)
      throw Error::in_binary(
          path_, at_,
          fmt::format("expected the size as '-Y height +X width', rows from the top, found '{}'",
                      text.substr(0, 60)));
    if (width_ < 1 || height_ < 1 || std::uint64_t(width_) * std::uint64_t(height_) > most_pixels)
      throw Error::in_binary(
          path_, at_,
          fmt::format("claims {} x {} pixels; at most {} are read", width_, height_, most_pixels));
    // A run of 127 takes two bytes in each of four planes: less than that cannot hold the picture. Runs of
    // the older kind can repeat a pixel without bound.
    const bool new_runs = width_ >= 8 && width_ < 32768 && bytes_.size() - at_ > 2 && bytes_[at_] == 2;
    if (new_runs && (bytes_.size() - at_) / std::size_t(height_) < 4 + 8 * std::size_t(width_ / 128))
      truncated();
  }
  void read_row(std::vector<std::uint8_t>& row) {
    const bool new_runs = width_ >= 8 && width_ < 32768 && bytes_.size() - at_ >= 4 && bytes_[at_] == 2 &&
                          bytes_[at_ + 1] == 2 && !(bytes_[at_ + 2] & 0x80);
    if (!new_runs) return read_old_row(row);
    const int length = bytes_[at_ + 2] << 8 | bytes_[at_ + 3];
    if (length != width_)
      throw Error::in_binary(path_, at_,
                             fmt::format("a row of {} pixels in a picture of {}", length, width_));
    at_ += 4;
    for (std::size_t plane = 0; plane < 4; ++plane)
      for (int x = 0; x < width_;) {
        const std::size_t begin = at_;
        int count = byte();
        const bool run = count > 128;
        if (run) count -= 128;
        if (count == 0 || count > width_ - x)
          throw Error::in_binary(path_, begin,
                                 fmt::format("a run of {} where {} pixels are left", count, width_ - x));
        std::uint8_t value = run ? byte() : 0;
        for (; count > 0; --count, ++x) {
          if (!run) value = byte();
          row[4 * std::size_t(x) + plane] = value;
        }
      }
  }
  /// Pixel by pixel; 1 1 1 n repeats the one before n times, or n 256^k times after k other repeats.
  void read_old_row(std::vector<std::uint8_t>& row) {
    int shift = 0;
    for (int x = 0; x < width_;) {
      const std::size_t begin = at_;
      std::array<std::uint8_t, 4> p;
      for (auto& v : p)
        v = byte();
      if (p[0] == 1 && p[1] == 1 && p[2] == 1) {
        const std::uint64_t count = shift < 32 ? std::uint64_t(p[3]) << shift : ~std::uint64_t(0);
        if (x == 0 || count > std::uint64_t(width_ - x))
          throw Error::in_binary(path_, begin, "a repeat that leaves its row");
        for (std::uint64_t k = 0; k < count; ++k, ++x)
          std::copy_n(&row[4 * std::size_t(x - 1)], 4, &row[4 * std::size_t(x)]);
        shift += 8;
      } else {
        std::copy(p.begin(), p.end(), &row[4 * std::size_t(x++)]);
        shift = 0;
      }
    }
  }

  const std::vector<std::uint8_t>& bytes_;
  const std::string& path_;
  std::size_t at_ = 0;
  int width_ = 0, height_ = 0;
};

} // namespace

Image read_hdr(const std::string& path) {
  const auto bytes = read_file(path);
  return HdrReader(bytes, path).read();
}

} // namespace nacre

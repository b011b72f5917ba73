#include "core/error.h"
#include "core/exr/plausibility.h"
#include "core/file.h"
#include "core/image.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <half.h>
#include <limits>
#include <set>
#include <tuple>

namespace nacre {
namespace {

class MemoryInput : public Imf::IStream {
public:
  MemoryInput(const std::vector<std::uint8_t>& bytes, const std::string& path)
      : IStream(path.c_str()), bytes_(bytes) {}
  bool read(char out[], int n) override {
    if (n < 0 || position_ > bytes_.size() || static_cast<std::uint64_t>(n) > bytes_.size() - position_)
      throw Error(
          fmt::format("the file ends at byte {}, within data that begins at {}", bytes_.size(), position_));
    std::memcpy(out, bytes_.data() + position_, static_cast<std::size_t>(n));
    position_ += static_cast<std::uint64_t>(n);
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override { position_ = position; }

private:
  const std::vector<std::uint8_t>& bytes_;
  std::uint64_t position_ = 0;
};

class MemoryOutput : public Imf::OStream {
public:
  explicit MemoryOutput(const std::string& path) : OStream(path.c_str()) {}
  void write(const char in[], int n) override {
    const std::size_t end = position_ + static_cast<std::size_t>(n);
    if (end > bytes.size()) bytes.resize(end);
    std::memcpy(bytes.data() + position_, in, static_cast<std::size_t>(n));
    position_ = end;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }

  std::vector<std::uint8_t> bytes;

private:
  std::size_t position_ = 0;
};

/// Sorts R G B A before other names, layer by layer: the key of "diffuse.G" is ("diffuse", 1, "G").
std::tuple<std::string, std::size_t, std::string> order_key(const std::string& channel) {
  static const std::string colours = "RGBA";
  const std::size_t dot = channel.rfind('.');
  const std::string layer = dot == std::string::npos ? "" : channel.substr(0, dot);
  const std::string name = dot == std::string::npos ? channel : channel.substr(dot + 1);
  const std::size_t rank = name.size() == 1 ? colours.find(name) : std::string::npos;
  return {layer, std::min(rank, colours.size()), name};
}

Image decode_exr(const std::vector<std::uint8_t>& bytes, const std::string& path) {
  MemoryInput stream(bytes, path);
  Imf::InputFile file(stream);
  const Imf::Header& header = file.header();
  const Imath::Box2i window = header.dataWindow();

  std::vector<std::string> names;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    names.emplace_back(c.name());
  std::sort(names.begin(), names.end(),
            [](const std::string& a, const std::string& b) { return order_key(a) < order_key(b); });
  Image image(window.max.x - window.min.x + 1, window.max.y - window.min.y + 1, std::move(names));

  Imf::FrameBuffer pixels;
  const std::size_t step = sizeof(float) * image.channels.size();
  for (std::size_t c = 0; c < image.channels.size(); ++c)
    pixels.insert(image.channels[c], Imf::Slice::Make(Imf::FLOAT, image.data.data() + c, window, step,
                                                      step * static_cast<std::size_t>(image.width)));
  file.setFrameBuffer(pixels);
  file.readPixels(window.min.y, window.max.y);

  for (auto a = header.begin(); a != header.end(); ++a)
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute()))
      if (!is_reserved_exr_attribute(a.name())) image.metadata[a.name()] = text->value();
  return image;
}

void check_writable(const Image& image, const std::string& path) {
  if (image.width < 1 || image.height < 1 || image.channels.empty())
    throw Error::in_file(path, fmt::format("an image of {} x {} pixels and {} channels cannot be written",
                                           image.width, image.height, image.channels.size()));
  if (image.data.size() != static_cast<std::size_t>(image.width) * image.height * image.channels.size())
    throw Error::in_file(path, fmt::format("an image of {} x {} x {} values holds {}", image.width,
                                           image.height, image.channels.size(), image.data.size()));
  const auto is_name = [](const std::string& name) {
    return !name.empty() && name.size() <= 255 && name.find('\0') == std::string::npos;
  };
  std::set<std::string> seen;
  for (const std::string& name : image.channels) {
    if (!is_name(name)) throw Error::in_file(path, fmt::format("'{}' cannot name an EXR channel", name));
    if (!seen.insert(name).second) throw Error::in_file(path, fmt::format("two channels '{}'", name));
  }
  for (const auto& [name, text] : image.metadata)
    if (!is_name(name)) throw Error::in_file(path, fmt::format("'{}' cannot name an EXR attribute", name));
}

std::vector<std::uint8_t> encode_exr(const Image& image, const std::string& path, bool as_half) {
  Imf::Header header(image.width, image.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const auto& [name, text] : image.metadata)
    if (!is_reserved_exr_attribute(name)) header.insert(name, Imf::StringAttribute(text));

  std::vector<half> halves;
  if (as_half) {
    const auto largest = static_cast<float>(std::numeric_limits<half>::max());
    halves.reserve(image.data.size());
    for (const float x : image.data)
      halves.emplace_back(std::isfinite(x) ? std::clamp(x, -largest, largest) : x);
  }
  const char* base = as_half ? reinterpret_cast<const char*>(halves.data())
                             : reinterpret_cast<const char*>(image.data.data());
  const Imf::PixelType type = as_half ? Imf::HALF : Imf::FLOAT;
  const std::size_t size = as_half ? sizeof(half) : sizeof(float), step = size * image.channels.size();
  Imf::FrameBuffer pixels;
  for (std::size_t c = 0; c < image.channels.size(); ++c) {
    header.channels().insert(image.channels[c], Imf::Channel(type));
    pixels.insert(image.channels[c], Imf::Slice::Make(type, base + c * size, header.dataWindow(), step,
                                                      step * static_cast<std::size_t>(image.width)));
  }
  MemoryOutput stream(path);
  {
    Imf::OutputFile file(stream, header);
    file.setFrameBuffer(pixels);
    file.writePixels(image.height);
  } // the table of chunks is written on closing
  return std::move(stream.bytes);
}

} // namespace

int Image::channel(const std::string& name) const {
  const auto found = std::find(channels.begin(), channels.end(), name);
  return found == channels.end() ? -1 : static_cast<int>(found - channels.begin());
}

Image read_exr(const std::string& path) {
  const std::vector<std::uint8_t> bytes = read_file(path);
  check_exr_plausible(bytes, path);
  try {
    return decode_exr(bytes, path);
  } catch (const std::exception& e) {
    throw Error::in_file(path, fmt::format("not a readable OpenEXR image: {}", e.what()));
  }
}

void write_exr(const Image& image, const std::string& path, bool half) {
  check_writable(image, path);
  std::vector<std::uint8_t> bytes;
  try {
    bytes = encode_exr(image, path, half);
  } catch (const std::exception& e) {
    throw Error::in_file(path, fmt::format("cannot be encoded as OpenEXR: {}", e.what()));
  }
  write_file_atomically(path, bytes);
}

} // namespace nacre

// Textures: bitmap and checkerboard.

#include "core/error.h"
#include "scene/mitsuba/context.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace nacre::mitsuba {
namespace {

Image read_picture(const std::string& path, bool raw) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return raw && extension != ".exr" ? read_ldr(path) : read_image_linear(path);
}

BitmapTexture bitmap(Parameters& p, TextureUse use) {
  bool raw = p.boolean("raw", false);
  p.ignore({"format", "accel", "cache", "max_anisotropy", "channel"});
  if (p.has("gamma")) { // Mitsuba 0.x: -1 leaves it to the file, 1 is linear
    const double gamma = p.number("gamma", -1);
    if (gamma != -1 && gamma != 1)
      p.at("gamma").fail("a gamma other than 1 (linear) or -1 (the file's own) is not supported");
    raw = raw || gamma == 1;
  }
  const std::string filter = p.choice("filter_type", "bilinear", {"bilinear", "nearest", "trilinear", "ewa"});
  const std::string wrap = p.choice("wrap_mode", "repeat", {"repeat", "mirror", "clamp"});
  for (const std::string_view other : {"wrap_mode_u", "wrap_mode_v"})
    if (p.text(other, wrap) != wrap)
      p.at(other).fail("a wrap mode of its own for each axis is not supported");
  Image image = read_picture(p.file(), raw);
  return BitmapTexture(std::move(image), use,
                       filter == "nearest" ? BitmapTexture::Filter::nearest : BitmapTexture::Filter::bilinear,
                       wrap == "repeat"   ? BitmapTexture::Wrap::repeat
                       : wrap == "mirror" ? BitmapTexture::Wrap::mirror
                                          : BitmapTexture::Wrap::clamp);
}

/// The linear part and the offset of (u, v), from a transform or from Mitsuba 0.x's scales and offsets.
std::array<float, 6> uv_map(Parameters& p) {
  const Transform t = p.transform("to_uv");
  const double su = p.number("uscale", 1), sv = p.number("vscale", 1);
  const double ou = p.number("uoffset", 0), ov = p.number("voffset", 0);
  const auto f = [](double v) { return static_cast<float>(v); };
  return {f(su * t.m[0][0]), f(su * t.m[0][1]), f(su * t.m[0][3] + ou),
          f(sv * t.m[1][0]), f(sv * t.m[1][1]), f(sv * t.m[1][3] + ov)};
}

} // namespace

std::shared_ptr<const Texture> Context::texture(const Node& node, TextureUse use) {
  auto& cached = textures_[{&node, use}];
  if (cached != nullptr) return cached;
  const Opened opened(*this, node);
  Parameters p(node, document);
  const auto map = uv_map(p);
  std::optional<Texture> result;
  if (p.type() == "bitmap") {
    result = located(node, [&] { return Texture{bitmap(p, use), map}; });
  } else if (p.type() == "checkerboard") {
    const auto square = [&](std::string_view name, float initial) {
      if (use != TextureUse::data)
        return spectrum(
            p, name, use == TextureUse::emission ? SpectrumUse::emission : SpectrumUse::reflectance, initial);
      const auto value = number(p, name).value_or(initial);
      if (!std::holds_alternative<float>(value))
        p.at(name).fail("a texture within a texture is not supported");
      return located(p.at(name), [&] { return SpectrumSource::constant(std::get<float>(value)); });
    };
    const SpectrumSource color0 = square("color0", 0.4f);
    result = Texture{CheckerboardTexture{color0, square("color1", 0.2f)}, map};
  } else {
    unknown_plugin(node, {"bitmap", "checkerboard"});
  }
  p.finish();
  return cached = std::make_shared<const Texture>(std::move(*result));
}

void Context::check_texture(const Node& node) {
  for (const TextureUse use : {TextureUse::data, TextureUse::reflectance, TextureUse::emission})
    if (textures_.contains({&node, use})) return;
  texture(node, TextureUse::reflectance);
}

} // namespace nacre::mitsuba

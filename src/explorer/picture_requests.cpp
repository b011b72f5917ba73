// Requests about pictures that were rendered: look at a pixel, show, save.
#include "display/tonemap.h"
#include "explorer/desk.h"
#include "spectra/color_space.h"

#include <algorithm>

namespace nacre {
namespace {

struct Found {
  std::shared_ptr<Picture> picture;
  std::shared_ptr<const Image> image;
  double samples;
};

Found find_shown(const Arguments& request, const Desk& desk) {
  const auto of = std::int64_t(request.number("of", 0, 9e15));
  const auto picture = desk.pictures.find(of);
  const auto shown = picture->shown();
  if (!shown.image) throw Error(fmt::format("the picture of request {} has no sample yet", of));
  return {picture, shown.image, shown.samples_per_pixel};
}

/// The picture without its variance.
Image colours(const Image& image) {
  Image rgb(image.width, image.height, {"R", "G", "B"});
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      std::copy_n(image.at(x, y), 3, rgb.at(x, y));
  rgb.metadata = image.metadata;
  return rgb;
}

ToneMapOptions tone_options(const Arguments& request) {
  ToneMapOptions options;
  options.operator_name = request.text("operator", options.operator_name);
  options.exposure_stops = request.number("exposure", 0, -64, 64);
  if (request.has("parameters")) {
    const auto& parameters = request.at("parameters");
    if (!parameters.is_object()) throw Error("'parameters' is an object of numbers");
    for (const auto& [name, value] : parameters.items()) {
      if (!value.is_number()) throw Error(fmt::format("'parameters.{}' is a number", name));
      options.parameters[name] = value.get<double>();
    }
  }
  check(options);
  return options;
}

} // namespace

Answer answer_inspect(const Arguments& request, const Desk& desk) {
  const Found found = find_shown(request, desk);
  const int x = request.whole("x", 0, 0, found.image->width - 1),
            y = request.whole("y", 0, 0, found.image->height - 1);
  const float* p = found.image->at(x, y);
  Answer answer;
  auto& h = answer.header;
  const RGB rgb{p[0], p[1], p[2]};
  h["rgb"] = rgb;
  h["xyz"] = srgb_to_xyz * rgb;
  h["samples"] = found.samples;
  h["variance"] = {p[3], p[4], p[5]};
  const int material = found.picture->renderer().material_at(x, y);
  h["material"] = nullptr;
  if (material >= 0) h["material"] = found.picture->scene().materials[std::size_t(material)].id;
  const PixelSpectrum spectrum =
      found.picture->renderer().spectrum(x, y, request.whole("paths", 512, 16, 65536));
  h["spectrum"] = {{"wavelength_nm", spectrum.wavelength_nm}, {"radiance", spectrum.radiance}};
  return answer;
}

Answer answer_display(const Arguments& request, const Desk& desk) {
  const Found found = find_shown(request, desk);
  ToneMapReport report;
  Answer answer;
  answer.add_image("image", tone_map(colours(*found.image), tone_options(request), &report));
  answer.header["clipped"] = report.clipped;
  return answer;
}

Answer answer_save(const Arguments& request, const Desk& desk) {
  const Found found = find_shown(request, desk);
  const auto path = desk.folder.writable(request.text("file"), {".exr", ".png"});
  if (path.extension() == ".exr")
    write_exr(*found.image, path.string());
  else
    write_png(tone_map(colours(*found.image), tone_options(request)), path.string());
  return {};
}

} // namespace nacre

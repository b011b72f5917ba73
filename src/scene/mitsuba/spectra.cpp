// Numbers, RGB, and spectra as Mitsuba writes them.

#include "core/error.h"
#include "core/file.h"
#include "core/srgb.h"
#include "core/text_scanner.h"
#include "scene/mitsuba/context.h"

namespace nacre::mitsuba {
namespace {

SpectrumSource grey(float value, SpectrumUse use) {
  return use == SpectrumUse::emission ? SpectrumSource::d65(value) : SpectrumSource::constant(value);
}

SpectrumSource rgb(const Node& node, SpectrumUse use) {
  const Attribute& value = node.require("value");
  auto v = read_numbers(node, value);
  if (v.size() == 1) v.resize(3, v[0]);
  if (v.size() != 3) node.fail_at(value, "expected one or three numbers, found " + std::to_string(v.size()));
  float c[3];
  for (int i = 0; i < 3; ++i)
    c[i] = static_cast<float>(node.tag == "srgb" ? srgb_decode(v[i]) : v[i]);
  switch (use) {
  case SpectrumUse::reflectance:
    return SpectrumSource::rgb_reflectance(c[0], c[1], c[2]);
  case SpectrumUse::unbounded:
    return SpectrumSource::rgb_unbounded(c[0], c[1], c[2]);
  case SpectrumUse::emission:
    break;
  }
  return SpectrumSource::rgb_illuminant(c[0], c[1], c[2]);
}

/// "400:0.1, 500:0.2"
SpectrumSource pairs(const Node& node, const Attribute& attribute) {
  std::vector<float> wavelengths, values;
  const std::string_view text = attribute.value;
  for (std::size_t i = text.find_first_not_of(" ,\t\r\n"); i != std::string_view::npos;
       i = text.find_first_not_of(" ,\t\r\n", i)) {
    const std::size_t end = std::min(text.find_first_of(" ,\t\r\n", i), text.size());
    const std::string_view token = text.substr(i, end - i);
    const std::size_t colon = token.find(':');
    double lambda = 0, value = 0;
    if (colon == std::string_view::npos || !parse_number(token.substr(0, colon), lambda) ||
        !parse_number(token.substr(colon + 1), value))
      node.fail_at(attribute, "expected pairs such as 400:0.5, found " + in_quotes(token));
    wavelengths.push_back(static_cast<float>(lambda));
    values.push_back(static_cast<float>(value));
    i = end;
  }
  return located(node, [&] { return SpectrumSource::tabulated(wavelengths, values); });
}

/// A file of lines "wavelength value"; # begins a comment.
SpectrumSource spectrum_file(const std::string& path) {
  const std::string text = read_text_file(path);
  TextScanner scanner(text, path);
  std::vector<float> wavelengths, values;
  do {
    const std::string_view first = scanner.token_on_line(true);
    if (first.empty()) continue;
    wavelengths.push_back(scanner.finite_float(first, "a wavelength in nm"));
    values.push_back(scanner.number_on_line("a value"));
  } while (scanner.next_line());
  try {
    return SpectrumSource::tabulated(wavelengths, values);
  } catch (const Error& e) {
    throw Error::in_file(path, e.what());
  }
}

std::vector<float> number_list(Parameters& p, std::string_view name) {
  const Node* node = p.find(name);
  if (node == nullptr) p.node().fail("the spectrum lacks the parameter '" + std::string(name) + "'");
  std::vector<float> list;
  for (const double v : read_numbers(*node, node->require("value")))
    list.push_back(static_cast<float>(v));
  return list;
}

SpectrumSource spectrum_plugin(const Node& node, SpectrumUse use, const Document& document) {
  Parameters p(node, document);
  const auto scalar = [&](std::string_view name, double initial) {
    return static_cast<float>(p.number(name, initial));
  };
  SpectrumSource result;
  if (p.type() == "uniform") {
    result = grey(scalar("value", 1), use);
  } else if (p.type() == "d65") {
    result = SpectrumSource::d65(scalar("scale", 1));
  } else if (p.type() == "blackbody") {
    const float scale = scalar("scale", 1);
    result = SpectrumSource::blackbody(scalar("temperature", 5000), scale);
  } else if (p.type() == "regular") {
    const auto values = number_list(p, "values");
    const float first = scalar("wavelength_min", 360);
    result = SpectrumSource::regular(first, scalar("wavelength_max", 830), values);
  } else if (p.type() == "irregular") {
    const auto values = number_list(p, "values");
    result = SpectrumSource::tabulated(number_list(p, "wavelengths"), values);
  } else {
    Context::unknown_plugin(node, {"uniform", "d65", "blackbody", "regular", "irregular"});
  }
  p.finish();
  return result;
}

/// <blackbody temperature="5000K" scale="1"/> of Mitsuba 0.x.
SpectrumSource old_blackbody(const Node& node) {
  Attribute temperature = node.require("temperature");
  if (!temperature.value.empty() && (temperature.value.back() == 'K' || temperature.value.back() == 'k'))
    temperature.value.pop_back();
  const Attribute* scale = node.find("scale");
  return SpectrumSource::blackbody(static_cast<float>(read_number(node, temperature)),
                                   scale == nullptr ? 1.0f : static_cast<float>(read_number(node, *scale)));
}

} // namespace

SpectrumSource Context::spectrum(const Node& node, SpectrumUse use) {
  return located(node, [&] {
    if (node.tag == "float" || node.tag == "integer")
      return grey(static_cast<float>(read_number(node, node.require("value"))), use);
    if (node.tag == "rgb" || node.tag == "srgb" || node.tag == "color") return rgb(node, use);
    if (node.tag == "blackbody") return old_blackbody(node);
    if (node.tag == "texture") node.fail("a texture cannot be used here, only a number or a spectrum");
    if (node.tag != "spectrum") node.fail("expected a number, <rgb> or <spectrum>, found <" + node.tag + ">");
    if (node.find("type") != nullptr) return spectrum_plugin(node, use, document);
    if (const Attribute* file = node.find("filename"))
      return spectrum_file(document.find_file(node, file->value));
    const Attribute& value = node.require("value");
    if (value.value.find(':') != std::string::npos) return pairs(node, value);
    return grey(static_cast<float>(read_number(node, value)), use);
  });
}

SpectrumSource Context::spectrum(Parameters& parameters, std::string_view name, SpectrumUse use,
                                 float initial) {
  const Node* node = parameters.find(name);
  return node == nullptr ? grey(initial, use) : spectrum(*node, use);
}

std::optional<ParameterSource> Context::color(Parameters& parameters, std::string_view name,
                                              SpectrumUse use) {
  const Node* node = parameters.find(name);
  if (node == nullptr) return std::nullopt;
  if (node->tag == "texture")
    return texture(*node, use == SpectrumUse::emission ? TextureUse::emission : TextureUse::reflectance);
  return spectrum(*node, use);
}

std::optional<ParameterSource> Context::number(Parameters& parameters, std::string_view name) {
  const Node* node = parameters.find(name);
  if (node == nullptr) return std::nullopt;
  if (node->tag == "texture") return texture(*node, TextureUse::data);
  const Attribute* value = node->find("value");
  if (value == nullptr || node->tag == "string" || node->tag == "boolean")
    parameters.at(name).fail("the parameter '" + std::string(name) +
                             "' must be a number or a texture, found <" + node->tag + ">");
  const auto v = read_numbers(*node, *value);
  if (v.empty()) node->fail_at(*value, "expected a number, found nothing");
  for (const double other : v)
    if (other != v[0]) node->fail_at(*value, "this parameter takes one number, not a colour");
  return static_cast<float>(v[0]);
}

} // namespace nacre::mitsuba

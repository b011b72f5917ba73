#include "measured/formats/sample_rows.h"

#include "core/error.h"
#include "measured/merl_table.h"
#include "spectra/color_space.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fmt/format.h>

namespace nacre {

std::optional<std::string_view> TextLines::next() {
  if (offset_ >= text_.size()) return {};
  std::size_t end = text_.find('\n', offset_);
  if (end == std::string_view::npos) end = text_.size();
  std::string_view line = text_.substr(offset_, end - offset_);
  offset_ = end + 1;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::string_view text_of(std::span<const std::uint8_t> bytes) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.substr(0, 3) == "\xef\xbb\xbf") text.remove_prefix(3); // mark of UTF-8
  return text;
}

std::string_view trimmed(std::string_view s) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '"'; };
  while (!s.empty() && blank(s.front()))
    s.remove_prefix(1);
  while (!s.empty() && blank(s.back()))
    s.remove_suffix(1);
  return s;
}

std::string lower_case(std::string_view s) {
  std::string lower(s);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return lower;
}

void split_fields(std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  const bool commas = line.find(',') != std::string_view::npos;
  line = trimmed(line);
  while (!line.empty()) {
    const std::size_t end = commas ? line.find(',') : line.find_first_of(" \t");
    fields.push_back(trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return;
    line.remove_prefix(end + 1);
    if (!commas) line = trimmed(line);
    // A comma at the end of a line closes it.
    if (commas && trimmed(line).empty()) return;
  }
}

std::optional<double> wavelength_in(std::string_view name) {
  std::string lower = lower_case(trimmed(name));
  if (lower.size() < 3 || lower.substr(lower.size() - 2) != "nm") return {};
  std::string_view number = trimmed(std::string_view(lower).substr(0, lower.size() - 2));
  const std::size_t before = number.find_last_not_of("0123456789.");
  if (before != std::string_view::npos) number.remove_prefix(before + 1);
  double nm = 0;
  if (!parse_number(number, nm) || !(nm > 0 && nm < 1e9)) return {};
  return nm;
}

NumberRows read_number_rows(TextLines& lines, int columns) {
  NumberRows rows;
  std::vector<std::string_view> fields;
  while (const auto line = lines.next()) {
    const std::string_view text = trimmed(*line);
    if (text.empty() || text[0] == '#') continue;
    split_fields(*line, fields);
    if (int(fields.size()) != columns)
      lines.fail_at(text, fmt::format("expected {} numbers in a line, found {}", columns, fields.size()));
    for (const std::string_view field : fields) {
      double x = 0;
      if (!parse_number(field, x)) lines.fail_at(field, "expected a number, found " + in_quotes(field));
      if (!(std::abs(x) < 1e36))
        lines.fail_at(field, "not a finite number of sensible size: " + in_quotes(field));
      rows.numbers.push_back(x);
    }
    rows.lines.push_back(text);
  }
  return rows;
}

SamplesRead samples_of(const NumberRows& rows, const SampleColumns& columns, const TextLines& lines) {
  SamplesRead read;
  const double unit = columns.radians ? 1 : pi / 180;
  const std::size_t channels = columns.values.size();
  const auto direction = [](double theta, double phi) {
    // Exactly in the surface where the angle says so, within what degrees in decimals can say.
    const double z = std::abs(theta - pi / 2) < 1e-9 ? 0 : std::cos(theta);
    return Vec3d{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), z};
  };
  for (std::size_t n = 0; n < rows.lines.size(); ++n) {
    const double* x = &rows.numbers[n * std::size_t(columns.count)];
    const double theta_i = x[columns.theta_i] * unit, theta_o = x[columns.theta_o] * unit;
    for (const double theta : {theta_i, theta_o})
      if (!(std::abs(theta) <= pi + 1e-6))
        lines.fail_at(rows.lines[n],
                      fmt::format("a polar angle is {:.6g} degrees, expected -180 to 180", theta * 180 / pi));
    // Where a column is missing the scan lies in the plane of incidence, light from azimuth 180 degrees, and
    // theta_o is positive on the specular side (ASTM E2387).
    const double phi_i = columns.phi_i >= 0 ? x[columns.phi_i] * unit : pi;
    const double phi_o = columns.phi_o >= 0 ? x[columns.phi_o] * unit : phi_i + pi;
    Vec3d wi = direction(theta_i, phi_i), wo = direction(theta_o, phi_o);
    if (columns.transmits && wo.z > 0 && wi.z > 0) wo.z = -wo.z;
    if (std::abs(wo.z) < 1e-9 || std::abs(wi.z) < 1e-9) {
      ++read.in_surface;
      continue;
    }
    MeasuredSamples& s = read.samples;
    s.wo.push_back({float(wo.x), float(wo.y), float(wo.z)});
    s.wi.push_back({float(wi.x), float(wi.y), float(wi.z)});
    const double scale = columns.times_cosine ? 1 / std::abs(wo.z) : 1;
    if (columns.values_are_xyz) {
      const RGB rgb = xyz_to_srgb * XYZ{x[columns.values[0]], x[columns.values[1]], x[columns.values[2]]};
      for (std::size_t c = 0; c < 3; ++c)
        s.f.push_back(float(rgb[c] * scale));
    } else {
      for (std::size_t c = 0; c < channels; ++c)
        s.f.push_back(float(x[columns.values[c]] * scale));
    }
    for (std::size_t c = s.f.size() - channels; c < s.f.size(); ++c)
      if (!std::isfinite(s.f[c])) lines.fail_at(rows.lines[n], "a value is too large for a float");
    s.weight.push_back(1);
  }
  return read;
}

ScatteredBsdf::Symmetry symmetry_named(std::string_view name, const TextLines& lines) {
  using enum ScatteredBsdf::Symmetry;
  static const std::vector<std::pair<std::string, ScatteredBsdf::Symmetry>> known{
      {"found", found}, {"none", none}, {"isotropic", isotropic}, {"bilateral", bilateral}};
  const std::string lower = lower_case(name);
  std::vector<std::string> names;
  for (const auto& [text, symmetry] : known) {
    if (text == lower) return symmetry;
    names.push_back(text);
  }
  lines.fail_at(name, "no symmetry is called " + in_quotes(name) + suggestion(lower, names));
}

std::string_view symmetry_name(const MeasuredBsdf& measured) {
  return measured.is_isotropic() ? "isotropic" : "none";
}

std::vector<std::string> value_names(const Channels& channels) {
  if (channels.is_rgb()) return {"r", "g", "b"};
  if (!channels.is_spectral()) return {"f"};
  std::vector<std::string> names;
  for (const double nm : channels.wavelengths_nm())
    names.push_back(fmt::format("{}nm", nm));
  return names;
}

MeasuredSamples samples_to_write(const MeasuredBsdf& measured) {
  const MeasuredSamples all = measured.samples();
  const std::size_t channels = std::size_t(measured.channels().count());
  const auto* merl = dynamic_cast<const MerlTable*>(&measured);
  const bool exchanged = merl && merl->phi_d_period() < 4;
  MeasuredSamples kept;
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (std::abs(all.wo[n].z) < 1e-8f || std::abs(all.wi[n].z) < 1e-8f) continue;
    for (int turn = 0; turn < (exchanged ? 2 : 1); ++turn) {
      kept.wo.push_back(turn == 0 ? all.wo[n] : all.wi[n]);
      kept.wi.push_back(turn == 0 ? all.wi[n] : all.wo[n]);
      kept.f.insert(kept.f.end(), &all.f[n * channels], &all.f[n * channels] + channels);
      kept.weight.push_back(all.weight[n]);
    }
  }
  if (kept.size() == 0)
    throw Error("a measurement without samples makes no list of them: " + measured.kind());
  return kept;
}

std::pair<double, double> angles_deg(const Vec3f& w) {
  const double x = double(w.x), y = double(w.y), z = double(w.z);
  const double theta = std::atan2(std::hypot(x, y), z), phi = x == 0 && y == 0 ? 0 : std::atan2(y, x);
  return {theta * 180 / pi, phi * 180 / pi};
}

} // namespace nacre

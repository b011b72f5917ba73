#include "measured/formats/astm.h"

#include "core/error.h"
#include "measured/formats/sample_rows.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace nacre {
namespace {

struct Header {
  std::vector<std::pair<std::string, std::string>> keywords;
  std::string_view vars_line;
  std::vector<std::string_view> names;
  std::int64_t num_points = 0;
  std::string_view num_points_line;
  ScatteredBsdf::Symmetry symmetry = ScatteredBsdf::Symmetry::found;
};

Header read_header(TextLines& lines) {
  constexpr std::size_t most_keywords = 64;
  Header header;
  std::string_view last;
  while (const auto line = lines.next()) {
    const std::string_view text = trimmed(*line);
    if (text.empty() || text[0] == '#') continue;
    last = text;
    const std::size_t end = std::min(text.find_first_of(" \t=:"), text.size());
    const std::string_view keyword = text.substr(0, end);
    std::string_view value = trimmed(text.substr(end));
    if (!value.empty() && (value[0] == '=' || value[0] == ':')) value = trimmed(value.substr(1));
    const std::string key = lower_case(keyword);
    if (key == "vars") {
      header.vars_line = text;
      split_fields(value, header.names);
      return header;
    }
    if (key == "num_points") {
      if (!parse_number(value, header.num_points) || header.num_points < 0)
        lines.fail_at(text, "expected a number of points after NUM_POINTS, found " + in_quotes(value));
      header.num_points_line = text;
    } else if (key == "symmetry") {
      header.symmetry = symmetry_named(value, lines);
    } else if (header.keywords.size() < most_keywords) {
      header.keywords.emplace_back(lower_case(in_quotes(keyword).substr(1, keyword.size())),
                                   value.substr(0, 200));
    }
  }
  constexpr std::string_view expected = "no line 'VARS theta_i,phi_i,theta_s,phi_s,...' in the file";
  if (last.empty()) lines.fail(expected);
  lines.fail_at(last, expected);
}

/// The part of a column's name that says what it is: lower case, without what only decorates it.
std::string plain(std::string_view name) {
  std::string lower = lower_case(name);
  std::erase_if(lower, [](char c) { return c == '_' || c == ' ' || c == '-' || c == '(' || c == ')'; });
  return lower;
}

bool is_one_of(const std::string& name, std::initializer_list<std::string_view> known) {
  return std::find(known.begin(), known.end(), name) != known.end();
}

/// Sorts columns out. @param unused  names of columns that are not read
SampleColumns columns_of(const Header& header, Channels& channels, std::vector<std::string>& unused,
                         const TextLines& lines) {
  SampleColumns columns;
  columns.count = int(header.names.size());
  std::vector<int> others;
  const auto claim = [&](int& column, int n) {
    if (column >= 0) lines.fail_at(header.names[n], "a second column of " + in_quotes(header.names[n]));
    column = n;
  };
  int r = -1, g = -1, b = -1, x = -1, y = -1, z = -1;
  std::vector<std::pair<double, int>> spectral;
  for (int n = 0; n < columns.count; ++n) {
    const std::string name = plain(header.names[n]);
    if (name == "thetai")
      claim(columns.theta_i, n);
    else if (name == "phii")
      claim(columns.phi_i, n);
    else if (is_one_of(name, {"thetas", "thetar", "thetao"}))
      claim(columns.theta_o, n);
    else if (is_one_of(name, {"phis", "phir", "phio"}))
      claim(columns.phi_o, n);
    else if (is_one_of(name, {"r", "red", "bsdfr", "brdfr", "btdfr"}))
      claim(r, n);
    else if (is_one_of(name, {"g", "green", "bsdfg", "brdfg", "btdfg"}))
      claim(g, n);
    else if (is_one_of(name, {"b", "blue", "bsdfb", "brdfb", "btdfb"}))
      claim(b, n);
    else if (name == "x")
      claim(x, n);
    else if (name == "y")
      claim(y, n);
    else if (name == "z")
      claim(z, n);
    else if (const auto nm = wavelength_in(header.names[n]))
      spectral.emplace_back(*nm, n);
    else
      others.push_back(n);
  }
  if (columns.theta_i < 0 || columns.theta_o < 0)
    lines.fail_at(header.vars_line,
                  columns.theta_i < 0 ? "no column theta_i in VARS" : "no column theta_s in VARS");
  const auto leave = [&](int n) {
    if (n >= 0) unused.emplace_back(header.names[n].substr(0, 40));
  };
  if (r >= 0 && g >= 0 && b >= 0) {
    columns.values = {r, g, b};
    channels = Channels::rgb();
  } else if (x >= 0 && y >= 0 && z >= 0) {
    columns.values = {x, y, z};
    columns.values_are_xyz = true;
    channels = Channels::rgb();
  } else if (!spectral.empty()) {
    std::sort(spectral.begin(), spectral.end());
    std::vector<double> nm;
    for (const auto& [wavelength, n] : spectral) {
      if (!nm.empty() && wavelength == nm.back())
        lines.fail_at(header.names[n], fmt::format("a second column of {} nm", wavelength));
      nm.push_back(wavelength);
      columns.values.push_back(n);
    }
    if (nm.size() > std::size_t(Channels::max_count))
      lines.fail_at(header.vars_line,
                    fmt::format("{} wavelengths, expected at most {}", nm.size(), Channels::max_count));
    channels = Channels::spectral(std::move(nm));
  } else {
    // One plain column: the one called BSDF, else its cosine-corrected form, else the only one there is.
    int found = -1, cosine = -1;
    for (const int n : others) {
      const std::string name = plain(header.names[n]);
      const bool scatter = name.find("bsdf") != std::string::npos || name.find("brdf") != std::string::npos ||
                           name.find("btdf") != std::string::npos || is_one_of(name, {"f", "value"});
      const bool with_cosine = name.find("cos") != std::string::npos || name.find("ccb") == 0;
      if (with_cosine && cosine < 0) cosine = n;
      if (scatter && !with_cosine && found < 0) found = n;
    }
    if (found < 0 && cosine < 0 && others.size() == 1) found = others[0];
    if (found < 0 && cosine < 0)
      lines.fail_at(header.vars_line, "no column of values in VARS: expected BSDF, Cos_BSDF, R,G,B, X,Y,Z or "
                                      "wavelengths as in 550nm");
    columns.times_cosine = found < 0;
    columns.values = {columns.times_cosine ? cosine : found};
    columns.transmits = plain(header.names[columns.values[0]]).find("btdf") != std::string::npos;
    channels = Channels::grey();
  }
  for (const auto& list : {others, std::vector<int>{r, g, b, x, y, z}})
    for (const int n : list)
      if (std::find(columns.values.begin(), columns.values.end(), n) == columns.values.end()) leave(n);
  if (columns.values.size() > 1)
    for (const int n : columns.values)
      columns.times_cosine |= plain(header.names[n]).find("cos") != std::string::npos;
  return columns;
}

/// Whether angles must be radians: degrees would all be tiny.
bool in_radians(const NumberRows& rows, const SampleColumns& columns) {
  double theta = 0, phi = 0;
  for (std::size_t n = 0; n < rows.lines.size(); ++n) {
    const double* x = &rows.numbers[n * std::size_t(columns.count)];
    theta = std::max({theta, std::abs(x[columns.theta_i]), std::abs(x[columns.theta_o])});
    for (const int c : {columns.phi_i, columns.phi_o})
      if (c >= 0) phi = std::max(phi, std::abs(x[c]));
  }
  return theta > 0.5 && theta < pi / 2 + 1e-3 && phi < 2 * pi + 1e-3;
}

} // namespace

std::shared_ptr<const MeasuredBsdf> parse_astm(std::span<const std::uint8_t> bytes, std::string_view name) {
  TextLines lines(text_of(bytes), name);
  Header header = read_header(lines);
  Channels channels = Channels::grey();
  std::vector<std::string> unused;
  SampleColumns columns = columns_of(header, channels, unused, lines);
  const NumberRows rows = read_number_rows(lines, columns.count);
  if (rows.lines.empty()) lines.fail_at(header.vars_line, "no samples follow VARS");
  if (std::int64_t(rows.lines.size()) < header.num_points)
    lines.fail_at(header.num_points_line, fmt::format("the header promises {} points, found {}",
                                                      header.num_points, rows.lines.size()));
  columns.radians = in_radians(rows, columns);
  SamplesRead read = samples_of(rows, columns, lines);
  if (read.samples.size() == 0)
    lines.fail_at(header.vars_line, "all samples lie in the surface, where scattering has no value");
  auto facts = std::move(header.keywords);
  facts.emplace_back("angles", columns.radians ? "radians, as their size tells" : "degrees");
  if (columns.times_cosine) facts.emplace_back("values", "f cos theta_s, divided by the cosine");
  if (columns.values_are_xyz) facts.emplace_back("values", "CIE XYZ, read as linear sRGB");
  if (read.in_surface > 0)
    facts.emplace_back("left out", fmt::format("{} samples in the surface", read.in_surface));
  if (!unused.empty()) facts.emplace_back("columns not read", fmt::format("{}", fmt::join(unused, ", ")));
  return std::make_shared<const ScatteredBsdf>(std::move(read.samples), std::move(channels), header.symmetry,
                                               "scattered samples (ASTM)", std::move(facts));
}

std::vector<std::uint8_t> encode_astm(const MeasuredBsdf& measured) {
  const MeasuredSamples samples = samples_to_write(measured);
  const std::size_t channels = std::size_t(measured.channels().count());
  auto names = value_names(measured.channels());
  if (channels == 1 && !measured.channels().is_spectral()) names = {"BSDF"};
  std::string text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out,
                 "SAMPLE_NAME {}\nSYSTEM_NAME Nacre\nSYMMETRY {}\nNUM_POINTS {}\n"
                 "VARS theta_i,phi_i,theta_s,phi_s,{}\n",
                 measured.kind(), symmetry_name(measured), samples.size(), fmt::join(names, ","));
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const auto [theta_i, phi_i] = angles_deg(samples.wi[n]);
    const auto [theta_s, phi_s] = angles_deg(samples.wo[n]);
    fmt::format_to(out, "{:.10g},{:.10g},{:.10g},{:.10g}", theta_i, phi_i, theta_s, phi_s);
    for (std::size_t c = 0; c < channels; ++c)
      fmt::format_to(out, ",{}", samples.f[n * channels + c]);
    text += '\n';
  }
  return {text.begin(), text.end()};
}

} // namespace nacre

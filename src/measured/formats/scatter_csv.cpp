#include "measured/formats/scatter_csv.h"

#include "core/error.h"
#include "measured/formats/sample_rows.h"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <set>

namespace nacre {
namespace {

constexpr std::string_view mark = "nacre-bsdf";

struct Schema {
  std::optional<Channels> channels;
  SampleColumns columns;
  ScatteredBsdf::Symmetry symmetry = ScatteredBsdf::Symmetry::found;
};

/// What stands before a separator; `rest` is what follows it.
std::string_view before(std::string_view& rest, char separator) {
  const std::size_t end = std::min(rest.find(separator), rest.size());
  const std::string_view part = trimmed(rest.substr(0, end));
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return part;
}

Channels channels_named(std::string_view text, const TextLines& lines) {
  const std::string lower = lower_case(text);
  if (lower == "grey" || lower == "gray") return Channels::grey();
  if (lower == "rgb") return Channels::rgb();
  if (lower.substr(0, 3) != "nm:")
    lines.fail_at(text, "expected grey, rgb or nm:400,410,... for channels, found " + in_quotes(text));
  std::vector<double> nm;
  std::string_view rest = text.substr(3);
  while (!rest.empty()) {
    const std::string_view field = before(rest, ',');
    double x = 0;
    if (!parse_number(field, x) || !(x > 0 && x < 1e9) || (!nm.empty() && !(x > nm.back())))
      lines.fail_at(field.empty() ? text : field,
                    "expected a wavelength in nm above the one before, found " + in_quotes(field));
    nm.push_back(x);
  }
  if (nm.empty() || nm.size() > std::size_t(Channels::max_count))
    lines.fail_at(text,
                  fmt::format("expected 1 to {} wavelengths, found {}", Channels::max_count, nm.size()));
  return Channels::spectral(std::move(nm));
}

Schema read_schema(std::string_view line, const TextLines& lines) {
  std::string_view rest = trimmed(line);
  if (rest.empty() || rest[0] != '#') lines.fail("expected a first line '# nacre-bsdf 1; channels=...'");
  rest.remove_prefix(1);
  const std::string_view first = before(rest, ';');
  if (first.substr(0, mark.size()) != mark)
    lines.fail("expected a first line '# nacre-bsdf 1; channels=...', found " + in_quotes(first));
  if (trimmed(first.substr(mark.size())) != "1")
    lines.fail_at(first, "expected version 1, found " + in_quotes(first));
  Schema schema;
  std::set<std::string> seen;
  while (!trimmed(rest).empty()) {
    std::string_view setting = before(rest, ';');
    if (setting.empty()) continue;
    const std::string_view whole = setting, name = before(setting, '='), value = trimmed(setting);
    const std::string key = lower_case(name), word = lower_case(value);
    if (!seen.insert(key).second) lines.fail_at(whole, "a second setting of " + in_quotes(name));
    if (key == "channels") {
      schema.channels = channels_named(value.empty() ? whole : value, lines);
    } else if (key == "angles") {
      if (word != "degrees" && word != "radians")
        lines.fail_at(whole, "expected degrees or radians, found " + in_quotes(value));
      schema.columns.radians = word == "radians";
    } else if (key == "value") {
      if (word != "bsdf" && word != "cosine_bsdf")
        lines.fail_at(whole, "expected bsdf or cosine_bsdf, found " + in_quotes(value));
      schema.columns.times_cosine = word == "cosine_bsdf";
    } else if (key == "symmetry") {
      schema.symmetry = symmetry_named(value.empty() ? whole : value, lines);
    } else {
      const std::vector<std::string> known{"angles", "channels", "value", "symmetry"};
      lines.fail_at(whole, "no setting is called " + in_quotes(name) + suggestion(key, known));
    }
  }
  if (!schema.channels) lines.fail("the schema line needs channels=grey, rgb or nm:400,410,...");
  return schema;
}

void read_names(std::string_view line, Schema& schema, const TextLines& lines) {
  std::vector<std::string_view> fields;
  split_fields(line, fields);
  SampleColumns& columns = schema.columns;
  columns.count = int(fields.size());
  auto wanted = value_names(*schema.channels);
  columns.values.assign(wanted.size(), -1);
  std::vector<std::string> known{"theta_i", "phi_i", "theta_o", "phi_o"};
  known.insert(known.end(), wanted.begin(), wanted.end());
  for (int n = 0; n < columns.count; ++n) {
    const std::string name = lower_case(fields[n]);
    int* column = name == "theta_i"   ? &columns.theta_i
                  : name == "phi_i"   ? &columns.phi_i
                  : name == "theta_o" ? &columns.theta_o
                  : name == "phi_o"   ? &columns.phi_o
                                      : nullptr;
    if (!column) {
      const auto nm = wavelength_in(name);
      for (std::size_t c = 0; c < wanted.size() && !column; ++c)
        if (name == wanted[c] ||
            (nm && schema.channels->is_spectral() && *nm == schema.channels->wavelengths_nm()[c]))
          column = &columns.values[c];
    }
    if (!column)
      lines.fail_at(fields[n].empty() ? line : fields[n],
                    "no column is called " + in_quotes(fields[n]) + suggestion(name, known));
    if (*column >= 0) lines.fail_at(fields[n], "a second column of " + in_quotes(fields[n]));
    *column = n;
  }
  const auto need = [&](int column, const std::string& name) {
    if (column < 0) lines.fail_at(line, "the column " + name + " is missing");
  };
  need(columns.theta_i, "theta_i");
  need(columns.theta_o, "theta_o");
  need(columns.phi_o, "phi_o");
  for (std::size_t c = 0; c < wanted.size(); ++c)
    need(columns.values[c], wanted[c]);
}

} // namespace

bool is_scatter_csv(std::span<const std::uint8_t> bytes) {
  std::string_view text = trimmed(text_of(bytes.first(std::min<std::size_t>(bytes.size(), 64))));
  if (text.empty() || text[0] != '#') return false;
  text.remove_prefix(1);
  return trimmed(text).substr(0, mark.size()) == mark;
}

std::shared_ptr<const MeasuredBsdf> parse_scatter_csv(std::span<const std::uint8_t> bytes,
                                                      std::string_view name) {
  TextLines lines(text_of(bytes), name);
  const auto first = lines.next();
  if (!first) lines.fail("the file is empty, expected a first line '# nacre-bsdf 1; channels=...'");
  Schema schema = read_schema(*first, lines);
  std::string_view names;
  while (names.empty()) {
    const auto line = lines.next();
    if (!line) lines.fail_at(*first, "no line of column names follows the schema");
    if (const auto text = trimmed(*line); !text.empty() && text[0] != '#') names = text;
  }
  read_names(names, schema, lines);
  NumberRows rows = read_number_rows(lines, schema.columns.count);
  if (rows.lines.empty()) lines.fail_at(names, "no samples follow the column names");
  const bool without_azimuth = schema.columns.phi_i < 0;
  if (without_azimuth) {
    // A column of zeros at the end of every line.
    std::vector<double> with;
    with.reserve(rows.numbers.size() + rows.lines.size());
    for (std::size_t n = 0; n < rows.lines.size(); ++n) {
      const double* row = &rows.numbers[n * std::size_t(schema.columns.count)];
      with.insert(with.end(), row, row + schema.columns.count);
      with.push_back(0);
    }
    rows.numbers = std::move(with);
    schema.columns.phi_i = schema.columns.count++;
  }
  SamplesRead read = samples_of(rows, schema.columns, lines);
  if (read.samples.size() == 0)
    lines.fail_at(names, "all samples lie in the surface, where scattering has no value");
  std::vector<std::pair<std::string, std::string>> facts;
  if (schema.columns.times_cosine) facts.emplace_back("values", "f |cos theta_o|, divided by the cosine");
  if (read.in_surface > 0)
    facts.emplace_back("left out", fmt::format("{} samples in the surface", read.in_surface));
  return std::make_shared<const ScatteredBsdf>(std::move(read.samples), *schema.channels, schema.symmetry,
                                               "scattered samples (CSV)", std::move(facts));
}

std::vector<std::uint8_t> encode_scatter_csv(const MeasuredBsdf& measured) {
  const MeasuredSamples samples = samples_to_write(measured);
  const Channels& channels = measured.channels();
  const std::size_t count = std::size_t(channels.count());
  const std::string channel_text = channels.is_spectral()
                                       ? fmt::format("nm:{}", fmt::join(channels.wavelengths_nm(), ","))
                                       : std::string(channels.is_rgb() ? "rgb" : "grey");
  std::string text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out,
                 "# nacre-bsdf 1; angles=degrees; channels={}; value=bsdf; symmetry={}\n"
                 "theta_i,phi_i,theta_o,phi_o,{}\n",
                 channel_text, symmetry_name(measured), fmt::join(value_names(channels), ","));
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const auto [theta_i, phi_i] = angles_deg(samples.wi[n]);
    const auto [theta_o, phi_o] = angles_deg(samples.wo[n]);
    fmt::format_to(out, "{:.10g},{:.10g},{:.10g},{:.10g}", theta_i, phi_i, theta_o, phi_o);
    for (std::size_t c = 0; c < count; ++c)
      fmt::format_to(out, ",{}", samples.f[n * count + c]);
    text += '\n';
  }
  return {text.begin(), text.end()};
}

} // namespace nacre

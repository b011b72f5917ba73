#include "measured/formats.h"

#include "core/error.h"
#include "core/file.h"
#include "measured/formats/astm.h"
#include "measured/formats/integra.h"
#include "measured/formats/ngan.h"
#include "measured/formats/scatter_csv.h"
#include "measured/formats/utia.h"
#include "measured/formats/zemax.h"
#include "measured/merl_table.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace nacre {
namespace {

std::string ending_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return ending;
}

bool has_ending(const MeasuredFormat& format, const std::string& ending) {
  return format.parse &&
         std::find(format.endings.begin(), format.endings.end(), ending) != format.endings.end();
}

template <class T>
std::shared_ptr<const MeasuredBsdf> shared(T&& table) {
  return std::make_shared<const std::decay_t<T>>(std::forward<T>(table));
}

} // namespace

const std::vector<MeasuredFormat>& measured_formats() {
  static const std::vector<MeasuredFormat> formats{
      {"merl",
       "isotropic RGB table over half and difference angles (Matusik et al. 2003)",
       {".binary"},
       nullptr,
       [](std::span<const std::uint8_t> bytes, std::string_view name) {
         return shared(parse_merl(bytes, name));
       },
       [](const MeasuredBsdf& measured) {
         const auto* table = dynamic_cast<const MerlTable*>(&measured);
         return table ? encode_merl(*table) : encode_merl(tabulate_merl(measured));
       }},
      {"utia",
       "anisotropic RGB table, 6 x 48 x 6 x 48 directions (UTIA BRDF Database)",
       {".bin"},
       is_utia,
       parse_utia,
       nullptr},
      {"ngan", "anisotropic RGB table of bins (Ngan et al. 2005)", {".dat"}, is_ngan, parse_ngan, nullptr},
      {"astm",
       "scattered samples, any channels (ASTM E1392, E2387)",
       {".astm"},
       nullptr,
       parse_astm,
       encode_astm},
      {"csv",
       "scattered samples with a schema line, any channels (Nacre)",
       {".csv"},
       is_scatter_csv,
       parse_scatter_csv,
       encode_scatter_csv},
      {"integra_ddr",
       "reflection about the specular direction, any channels (Integra)",
       {".ddr"},
       nullptr,
       [](std::span<const std::uint8_t> bytes, std::string_view name) {
         return parse_integra(bytes, name, false);
       },
       nullptr},
      {"integra_ddt",
       "transmission about the specular direction, any channels (Integra)",
       {".ddt"},
       nullptr,
       [](std::span<const std::uint8_t> bytes, std::string_view name) {
         return parse_integra(bytes, name, true);
       },
       nullptr},
      {"zemax",
       "tabular BSDF about the specular direction, grey or XYZ (Zemax)",
       {".bsdf"},
       is_zemax,
       parse_zemax,
       encode_zemax},
  };
  return formats;
}

bool is_measured_file(const std::string& path) {
  const std::string ending = ending_of(path);
  return std::any_of(measured_formats().begin(), measured_formats().end(),
                     [&](const MeasuredFormat& f) { return has_ending(f, ending); });
}

std::shared_ptr<const MeasuredBsdf> read_measured(const std::string& path) {
  const std::string ending = ending_of(path);
  std::vector<const MeasuredFormat*> candidates;
  for (const MeasuredFormat& f : measured_formats())
    if (has_ending(f, ending)) candidates.push_back(&f);
  if (candidates.empty()) {
    std::vector<std::string> known;
    for (const MeasuredFormat& f : measured_formats())
      if (f.parse) known.insert(known.end(), f.endings.begin(), f.endings.end());
    throw Error::in_file(path,
                         fmt::format("no measurement ends in '{}'{}", ending, suggestion(ending, known)));
  }
  const std::vector<std::uint8_t> bytes = read_file(path);
  for (const MeasuredFormat* f : candidates)
    if (candidates.size() == 1 || (f->recognises && f->recognises(bytes))) return f->parse(bytes, path);
  std::vector<std::string> names;
  for (const MeasuredFormat* f : candidates)
    names.emplace_back(f->name);
  throw Error::in_file(
      path, fmt::format("not one of the formats that end in {}: {}", ending, fmt::join(names, ", ")));
}

} // namespace nacre

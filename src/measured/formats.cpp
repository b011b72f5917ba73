#include "measured/formats.h"

#include "core/error.h"
#include "core/file.h"
#include "measured/formats/astm.h"
#include "measured/formats/container.h"
#include "measured/formats/integra.h"
#include "measured/formats/kaist_pbsdf.h"
#include "measured/formats/nbrdf.h"
#include "measured/formats/ngan.h"
#include "measured/formats/rgl_bsdf.h"
#include "measured/formats/scatter_csv.h"
#include "measured/formats/utia.h"
#include "measured/formats/window_xml.h"
#include "measured/formats/zemax.h"
#include "measured/merl_table.h"
#include "measured/tensor_file.h"

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

const NeuralBrdf& as_network(const MeasuredBsdf& measured) {
  if (const auto* network = dynamic_cast<const NeuralBrdf*>(&measured)) return *network;
  throw Error("only a network has weights to write, found: " + measured.kind());
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
      {"nbrdf",
       "weights of a neural reflectance, saved by Keras (Sztrajman et al. 2021)",
       {".h5", ".hdf5"},
       nullptr,
       [](std::span<const std::uint8_t> bytes, std::string_view name) {
         return shared(parse_nbrdf_h5(bytes, name));
       },
       [](const MeasuredBsdf& measured) { return encode_nbrdf_h5(as_network(measured)); }},
      {"nbrdf-npy",
       "weights of a neural reflectance as arrays of NumPy (Sztrajman et al. 2021)",
       {".npy"},
       nullptr,
       [](std::span<const std::uint8_t> bytes, std::string_view name) {
         return shared(parse_nbrdf_npy(bytes, name));
       },
       [](const MeasuredBsdf& measured) { return encode_nbrdf_npy(as_network(measured)); },
       read_nbrdf_npy_files},
      {"window",
       "scattering of WINDOW and Radiance: Klems matrices, tensor trees",
       {".xml"},
       recognises_window_xml,
       [](std::span<const std::uint8_t> bytes, std::string_view name) {
         return shared(parse_window_xml(bytes, name));
       },
       [](const MeasuredBsdf& measured) {
         const auto* window = dynamic_cast<const WindowBsdf*>(&measured);
         return window ? encode_window_xml(*window) : encode_window_xml(make_tensor_tree(measured));
       }},
      {"klems",
       "scattering matrices of WINDOW and Radiance in the full Klems basis",
       {".xml"},
       nullptr,
       nullptr,
       [](const MeasuredBsdf& measured) {
         return encode_window_xml(make_klems(measured, KlemsBasis::standard().front()));
       }},
      {"nbsdf",
       "Nacre's own container, without loss: a table, a file with where it came from, or samples",
       {".nbsdf"},
       nullptr,
       [](std::span<const std::uint8_t> bytes, std::string_view name) {
         return parse_container(bytes, name);
       },
       encode_container},
      {"rgl",
       "isotropic or anisotropic, RGB or spectral, adaptive parameterisation (Dupuy and Jakob 2018)",
       {".bsdf"},
       TensorFile::recognises,
       [](std::span<const std::uint8_t> bytes, std::string_view name) {
         return shared(parse_rgl(bytes, name));
       },
       [](const MeasuredBsdf& measured) {
         const auto* rgl = dynamic_cast<const RglBsdf*>(&measured);
         return encode_rgl(rgl ? rgl->tables() : tabulate_rgl(measured, rgl_resolution(measured)));
       }},
      {"kaist",
       "isotropic, Mueller matrices over half and difference angles and wavelengths (Baek et al. 2020)",
       {".pbsdf"},
       TensorFile::recognises,
       [](std::span<const std::uint8_t> bytes, std::string_view name) {
         return shared(parse_kaist(bytes, name));
       },
       nullptr},
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
  const std::vector<std::uint8_t> bytes =
      candidates.front()->read ? candidates.front()->read(path) : read_file(path);
  for (const MeasuredFormat* f : candidates)
    if (candidates.size() == 1 || (f->recognises && f->recognises(bytes))) {
      auto measured = f->parse(bytes, path);
      measured->came_from({path, std::string(f->name), bytes.size(), MeasuredSource::fingerprint_of(bytes)});
      return measured;
    }
  std::vector<std::string> names;
  for (const MeasuredFormat* f : candidates)
    names.emplace_back(f->name);
  throw Error::in_file(
      path, fmt::format("not one of the formats that end in {}: {}", ending, fmt::join(names, ", ")));
}

} // namespace nacre

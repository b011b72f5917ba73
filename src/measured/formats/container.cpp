#include "measured/formats/container.h"

#include "core/error.h"
#include "core/file.h"
#include "core/version.h"
#include "measured/formats.h"
#include "measured/formats/hdf5_writer.h"
#include "measured/formats/nbrdf.h"
#include "measured/formats/window_xml.h"
#include "measured/hdf5_file.h"
#include "measured/merl_table.h"
#include "measured/scattered_bsdf.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>

namespace nacre {
namespace {

constexpr std::string_view container_format = "nacre-nbsdf", own_name = "nbsdf";
constexpr std::int32_t container_version = 1;

enum State : std::uint8_t { hole, measured_here, filled_in };

using Facts = std::vector<std::pair<std::string, std::string>>;

std::string lines(const Facts& facts) {
  std::string text;
  for (const auto& [label, value] : facts)
    text += label + ": " + value + "\n";
  return text;
}

Facts from_lines(std::span<const std::uint8_t> bytes) {
  Facts facts;
  for (auto at = bytes.begin(); at < bytes.end();) {
    const auto end = std::find(at, bytes.end(), std::uint8_t('\n'));
    const std::string line(at, end);
    const std::size_t colon = line.find(": ");
    if (colon != std::string::npos) facts.emplace_back(line.substr(0, colon), line.substr(colon + 2));
    if (end == bytes.end() || facts.size() >= 1000) break;
    at = end + 1;
  }
  return facts;
}

/// The version and content of a container. @throws Error unless it is one that this program reads
std::string content_of(const Hdf5File& file) {
  if (file.text("@format") != container_format)
    throw Error::in_file(file.name(),
                         fmt::format("an HDF5 file, but not a container of Nacre: expected its attribute "
                                     "'format' to be '{}', found '{}'",
                                     container_format, file.text("@format")));
  const auto version = file.attributes().find("@version");
  std::int32_t number = 0;
  if (version != file.attributes().end() && version->second.type == Hdf5File::Type::int32 &&
      version->second.bytes.size() == sizeof number)
    std::memcpy(&number, version->second.bytes.data(), sizeof number);
  if (number != container_version)
    throw Error::in_file(file.name(),
                         fmt::format("a container of version {}, this program ({}) reads version {}", number,
                                     nacre::version(), container_version));
  return file.text("@content");
}

/// An error of another part, with the file's name before it unless it is there.
Error named(const Hdf5File& file, const Error& e) {
  return std::string_view(e.what()).starts_with(file.name()) ? e : Error::in_file(file.name(), e.what());
}

std::span<const std::uint8_t> raw(const Hdf5File& file, const std::string& path) {
  const Hdf5File::Array& a = file.array(path);
  if (a.type != Hdf5File::Type::uint8)
    throw Error::in_binary(file.name(), a.offset, fmt::format("array '{}': expected bytes", path));
  return a.bytes;
}

void expect_shape(const Hdf5File& file, const std::string& path, const std::vector<std::uint64_t>& shape) {
  const Hdf5File::Array& a = file.array(path);
  if (a.shape == shape) return;
  const auto words = [](const std::vector<std::uint64_t>& s) {
    std::string text;
    for (const auto n : s)
      text += (text.empty() ? "" : " x ") + std::to_string(n);
    return text;
  };
  throw Error::in_binary(file.name(), a.offset,
                         fmt::format("array '{}' is {}, expected {}", path, words(a.shape), words(shape)));
}

std::shared_ptr<const MeasuredBsdf> merl_of(const Hdf5File& file) {
  const Hdf5File::Array& rgb = file.array("merl/rgb");
  if (rgb.shape.size() != 4 || rgb.shape[3] != 3)
    throw Error::in_binary(file.name(), rgb.offset,
                           "array 'merl/rgb': expected theta_h x theta_d x phi_d x 3");
  for (const auto n : rgb.shape)
    if (n > 1u << 20) throw Error::in_binary(file.name(), rgb.offset, "array 'merl/rgb': too large");
  expect_shape(file, "merl/state", {rgb.shape[0], rgb.shape[1], rgb.shape[2]});
  const std::vector<float> values = file.floats("merl/rgb");
  const auto states = raw(file, "merl/state");
  const std::uint64_t states_at = file.array("merl/state").offset;
  std::vector<MerlTable::Cell> cells(states.size());
  std::vector<bool> filled;
  if (std::find(states.begin(), states.end(), filled_in) != states.end()) filled.resize(states.size());
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (states[c] > filled_in)
      throw Error::in_binary(file.name(), states_at + c,
                             fmt::format("array 'merl/state': {}, expected 0, 1 or 2", states[c]));
    if (states[c] == hole) continue;
    const float* v = &values[3 * c];
    cells[c] = {v[0], v[1], v[2], 1};
    if (states[c] == filled_in) filled[c] = true;
    for (int k = 0; k < 3; ++k)
      if (!(v[k] >= 0 && v[k] < 1e36f))
        throw Error::in_binary(file.name(), rgb.offset + (3 * c + std::size_t(k)) * rgb.element_bytes,
                               fmt::format("array 'merl/rgb': {}, expected reflectance of 0 or more", v[k]));
  }
  try {
    return std::make_shared<const MerlTable>(MerlTable(
        int(rgb.shape[0]), int(rgb.shape[1]), int(rgb.shape[2]), std::move(cells), std::move(filled)));
  } catch (const Error& e) {
    throw Error::in_binary(file.name(), rgb.offset, e.what());
  }
}

std::shared_ptr<const MeasuredBsdf> embedded(const Hdf5File& file) {
  const auto bytes = raw(file, "file/bytes");
  const std::string format = file.text("file@format");
  std::vector<std::string> known;
  for (const MeasuredFormat& f : measured_formats()) {
    if (!f.parse || f.name == own_name) continue;
    if (f.name == format)
      return f.parse(bytes, fmt::format("{}: {}", file.name(), file.text("file@name", "the file in it")));
    known.emplace_back(f.name);
  }
  throw Error::in_file(file.name(), fmt::format("holds a file of the format '{}', which is not read{}",
                                                format, suggestion(format, known)));
}

Channels wavelengths_of(const Hdf5File& file) {
  try {
    return Channels::spectral(file.doubles("samples/wavelengths_nm"));
  } catch (const Error& e) {
    throw named(file, e);
  }
}

std::shared_ptr<const MeasuredBsdf> samples_of(const Hdf5File& file) {
  struct {
    MeasuredSamples samples;
    Channels channels;
    std::string kind;
    Facts facts;
  } s;
  const std::string channels = file.text("samples@channels");
  if (channels == "rgb")
    s.channels = Channels::rgb();
  else if (channels == "spectral")
    s.channels = wavelengths_of(file);
  else if (channels != "grey")
    throw Error::in_file(file.name(),
                         fmt::format("samples with channels '{}', expected grey, rgb or spectral", channels));
  const std::uint64_t n = file.array("samples/weight").size();
  expect_shape(file, "samples/weight", {n});
  expect_shape(file, "samples/wo", {n, 3});
  expect_shape(file, "samples/wi", {n, 3});
  expect_shape(file, "samples/f", {n, std::uint64_t(s.channels.count())});
  for (const auto& [path, to] : {std::pair{"samples/wo", &s.samples.wo}, {"samples/wi", &s.samples.wi}}) {
    const std::vector<float> xyz = file.floats(path);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3f w{xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]};
      if (!(std::abs(length(w) - 1) < 1e-3f))
        throw Error::in_binary(
            file.name(), file.array(path).offset + 3 * i * file.array(path).element_bytes,
            fmt::format("array '{}': a direction of length {}, expected 1", path, length(w)));
      to->push_back(w);
    }
  }
  s.samples.f = file.floats("samples/f");
  s.samples.weight = file.doubles("samples/weight");
  const auto isotropic = file.attributes().find("samples@isotropic");
  const bool is_isotropic = isotropic != file.attributes().end() && !isotropic->second.bytes.empty() &&
                            isotropic->second.bytes.front() != 0;
  s.kind = file.text("@kind");
  if (file.arrays().contains("facts")) s.facts = from_lines(raw(file, "facts"));
  try {
    using Symmetry = ScatteredBsdf::Symmetry;
    return std::make_shared<const ScatteredBsdf>(std::move(s.samples), std::move(s.channels),
                                                 is_isotropic ? Symmetry::isotropic : Symmetry::none,
                                                 std::move(s.kind), std::move(s.facts));
  } catch (const Error& e) {
    throw named(file, e);
  }
}

void write_merl(Hdf5Writer& file, const MerlTable& table) {
  std::vector<float> rgb;
  std::vector<std::uint8_t> states;
  rgb.reserve(3 * table.size());
  states.reserve(table.size());
  for (int i = 0; i < table.n_theta_h(); ++i)
    for (int j = 0; j < table.n_theta_d(); ++j)
      for (int k = 0; k < table.n_phi_d(); ++k) {
        const MerlTable::Cell& c = table.cell(i, j, k);
        rgb.insert(rgb.end(), c.begin(), c.begin() + 3);
        states.push_back(table.is_hole(i, j, k)     ? hole
                         : table.is_filled(i, j, k) ? filled_in
                                                    : measured_here);
      }
  const std::array<std::uint64_t, 4> shape{std::uint64_t(table.n_theta_h()), std::uint64_t(table.n_theta_d()),
                                           std::uint64_t(table.n_phi_d()), 3};
  file.group("merl");
  file.array("merl/rgb", shape, rgb.data());
  file.array("merl/state", std::span(shape).first(3), states.data());
}

void write_file(Hdf5Writer& file, std::span<const std::uint8_t> bytes, const std::string& format,
                const std::string& name) {
  const std::array<std::uint64_t, 1> shape{bytes.size()};
  file.group("file");
  file.array("file/bytes", shape, bytes.data());
  file.attribute("file", "format", format);
  file.attribute("file", "name", name);
}

void write_samples(Hdf5Writer& file, const MeasuredBsdf& measured) {
  const MeasuredSamples s = measured.samples();
  if (s.size() == 0)
    throw Error("neither a table, nor read from a file, nor with samples: " + measured.kind());
  const Channels& channels = measured.channels();
  const std::uint64_t n = s.size();
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  const std::array<std::uint64_t, 2> triples{n, 3}, values{n, std::uint64_t(channels.count())};
  file.group("samples");
  file.array("samples/wo", triples, &s.wo.front().x);
  file.array("samples/wi", triples, &s.wi.front().x);
  file.array("samples/f", values, s.f.data());
  file.array("samples/weight", std::span(triples).first(1), s.weight.data());
  if (channels.is_spectral())
    file.array("samples/wavelengths_nm", std::span(values).last(1), channels.wavelengths_nm().data());
  file.attribute("samples", "channels",
                 channels.is_spectral() ? "spectral"
                 : channels.is_rgb()    ? "rgb"
                                        : "grey");
  file.attribute("samples", "isotropic", std::int32_t(measured.is_isotropic()));
}

} // namespace

std::shared_ptr<const MeasuredBsdf> parse_container(std::span<const std::uint8_t> bytes,
                                                    std::string_view name) {
  const Hdf5File file(bytes, name);
  const std::string content = content_of(file);
  if (content == "merl") return merl_of(file);
  if (content == "file") return embedded(file);
  if (content != "samples")
    throw Error::in_file(name, fmt::format("holds '{}', expected merl, file or samples", content));
  return samples_of(file);
}

Facts container_facts(std::span<const std::uint8_t> bytes, std::string_view name) {
  const Hdf5File file(bytes, name);
  Facts facts{{"content", content_of(file)}};
  for (const char* attribute : {"kind", "source_file", "source_format", "software", "value", "directions"})
    if (const std::string text = file.text("@" + std::string(attribute)); !text.empty())
      facts.emplace_back(attribute, text);
  if (file.arrays().contains("facts"))
    for (auto& fact : from_lines(raw(file, "facts")))
      facts.push_back(std::move(fact));
  return facts;
}

std::vector<std::uint8_t> encode_container(const MeasuredBsdf& measured) {
  const auto source = measured.source();
  const auto* table = dynamic_cast<const MerlTable*>(&measured);
  std::vector<std::uint8_t> bytes;
  std::string format, file_name;
  if (source) {
    format = source->format;
    file_name = std::filesystem::path(source->path).filename().string();
  }
  if (source && (!table || format == own_name)) {
    bytes = source->read_again();
    if (format == own_name) return bytes;
  } else if (const auto* window = dynamic_cast<const WindowBsdf*>(&measured)) {
    bytes = encode_window_xml(*window);
    format = "window";
  } else if (const auto* network = dynamic_cast<const NeuralBrdf*>(&measured)) {
    bytes = encode_nbrdf_npy(*network);
    format = "nbrdf-npy";
  }

  Hdf5Writer file;
  const auto describe = [&](const char* name, const std::string& text) { file.attribute("/", name, text); };
  describe("format", std::string(container_format));
  file.attribute("/", "version", container_version);
  describe("content", table ? "merl" : !bytes.empty() ? "file" : "samples");
  describe("kind", measured.kind());
  describe("software", "Nacre " + nacre::version());
  describe("source_file", file_name);
  describe("source_format", format);
  describe("value", "f in 1/sr, without the cosine");
  describe("directions",
           "unit vectors in the local frame, away from the surface: wo to the viewer, wi to the light, "
           "z the normal, x the tangent");
  if (const std::string facts = lines(measured.facts()); !facts.empty()) {
    const std::array<std::uint64_t, 1> shape{facts.size()};
    file.array("facts", shape, reinterpret_cast<const std::uint8_t*>(facts.data()));
  }
  if (table)
    write_merl(file, *table);
  else if (!bytes.empty())
    write_file(file, bytes, format, file_name);
  else
    write_samples(file, measured);
  return file.finish();
}

} // namespace nacre

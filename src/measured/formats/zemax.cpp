#include "measured/formats/zemax.h"

#include "core/error.h"
#include "measured/angle_grid.h"
#include "measured/formats/sample_rows.h"
#include "measured/formats/words.h"
#include "spectra/color_space.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <limits>

namespace nacre {
namespace {

const std::vector<std::string>& keywords() {
  static const std::vector<std::string> all{"Source",         "Symmetry",       "SpectralContent",
                                            "ScatterType",    "SampleRotation", "AngleOfIncidence",
                                            "ScatterAzimuth", "ScatterRadial"};
  return all;
}

bool begins_block(std::string_view word) {
  const std::string w = lower_case(word);
  return w == "monochrome" || w.substr(0, 11) == "tristimulus";
}

struct Header {
  AngleGrid::Nodes nodes;
  bool xyz = false;
  std::string source;
};

Header read_header(Words& words) {
  Header h;
  h.nodes.axis = AngleGrid::Axis::specular;
  while (!begins_block(words.peek())) {
    switch (words.one_of("a keyword of the header, Monochrome or TristimulusX", keywords())) {
    case 0:
      h.source = lower_case(words.word("the source")).substr(0, 40);
      break;
    case 1:
      h.nodes.mirror =
          words.one_of("the symmetry", {"PlaneSymmetrical", "Asymmetrical", "Asymmetrical4D"}) == 0
              ? AngleGrid::Mirror::plane_of_incidence
              : AngleGrid::Mirror::none;
      break;
    case 2:
      h.xyz = words.one_of("the spectral content", {"Monochrome", "XYZ"}) == 1;
      break;
    case 3:
      h.nodes.transmits = words.one_of("the scatter type", {"BRDF", "BTDF"}) == 1;
      break;
    case 4:
      h.nodes.phi_i = words.angles("SampleRotation", -360, 360);
      break;
    case 5:
      h.nodes.theta_i = words.angles("AngleOfIncidence", 0, 90);
      break;
    case 6:
      h.nodes.phi_o = words.angles("ScatterAzimuth", -360, 360);
      break;
    default:
      h.nodes.theta_o = words.angles("ScatterRadial", 0, 180);
    }
  }
  for (const auto& [nodes, name] :
       {std::pair{&h.nodes.theta_i, "AngleOfIncidence"}, std::pair{&h.nodes.phi_o, "ScatterAzimuth"},
        std::pair{&h.nodes.theta_o, "ScatterRadial"}})
    if (nodes->empty()) words.fail(fmt::format("no angles {} before the values", name));
  if (h.nodes.phi_i.empty()) h.nodes.phi_i = {0};
  if (h.nodes.mirror == AngleGrid::Mirror::plane_of_incidence &&
      !(h.nodes.phi_o.front() >= 0 && h.nodes.phi_o.back() <= pi + 1e-9))
    words.fail("plane-symmetrical data has angles ScatterAzimuth from 0 to 180");
  for (const auto* azimuths : {&h.nodes.phi_i, &h.nodes.phi_o})
    if (azimuths->back() - azimuths->front() > 2 * pi + 1e-9) words.fail("azimuths span more than a turn");
  return h;
}

/// The nodes to write: the grid's own where it has such angles.
AngleGrid::Nodes nodes_to_write(const MeasuredBsdf& measured) {
  if (const auto* grid = dynamic_cast<const AngleGrid*>(&measured);
      grid && grid->nodes().axis == AngleGrid::Axis::specular && grid->nodes().theta_specular.empty() &&
      grid->nodes().mirror != AngleGrid::Mirror::sample && !grid->nodes().holds_beyond_ends)
    return grid->nodes();
  AngleGrid::Nodes nodes;
  nodes.axis = AngleGrid::Axis::specular;
  nodes.transmits = !measured.sides().reflects_front;
  for (int deg = 0; deg <= 85; deg += 5)
    nodes.theta_i.push_back(deg * pi / 180);
  nodes.phi_i = {0};
  for (int n = 0; n < 24; ++n)
    nodes.phi_o.push_back(n * pi / 12);
  if (!measured.is_isotropic()) nodes.phi_i = nodes.phi_o;
  for (const double deg : {0.0,  0.1,  0.2, 0.4,  0.6,  0.8,  1.0,  1.5,  2.0,  3.0,  4.0,  5.0, 6.0,
                           8.0,  10.,  13., 16.,  20.,  25.,  30.,  35.,  40.,  45.,  50.,  55., 60.,
                           70.0, 80.0, 90., 100., 110., 120., 130., 140., 150., 160., 170., 175.})
    nodes.theta_o.push_back(deg * pi / 180);
  return nodes;
}

} // namespace

bool is_zemax(std::span<const std::uint8_t> bytes) {
  Words words(text_of(bytes.first(std::min<std::size_t>(bytes.size(), 65536))), "", '#');
  const std::string first = lower_case(words.next());
  return std::any_of(keywords().begin(), keywords().end(),
                     [&](const std::string& k) { return lower_case(k) == first; });
}

std::shared_ptr<const MeasuredBsdf> parse_zemax(std::span<const std::uint8_t> bytes, std::string_view name) {
  Words words(text_of(bytes), name, '#');
  Header header = read_header(words);
  const AngleGrid::Nodes& nodes = header.nodes;
  const std::size_t n_i = nodes.theta_i.size(), n_j = nodes.phi_i.size(), n_k = nodes.theta_o.size(),
                    n_l = nodes.phi_o.size(), channels = header.xyz ? 3 : 1;
  std::size_t cells = 1;
  for (const std::size_t n : {n_i, n_j, n_k, n_l}) {
    if (n > words.bytes_left() / cells) words.fail("more values expected than the file can hold");
    cells *= n;
  }
  std::vector<float> values(cells * channels);
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (std::size_t c = 0; c < channels; ++c) {
    if (header.xyz)
      words.one_of("the channel", {std::string("Tristimulus") + "XYZ"[c]});
    else
      words.one_of("the channel", {"Monochrome"});
    words.one_of("DataBegin", {"DataBegin"});
    for (std::size_t j = 0; j < n_j; ++j)
      for (std::size_t i = 0; i < n_i; ++i) {
        words.one_of("TIS", {"TIS"});
        const double share = words.number("the share after TIS");
        least = std::min(least, share);
        most = std::max(most, share);
        for (std::size_t l = 0; l < n_l; ++l)
          for (std::size_t k = 0; k < n_k; ++k)
            values[(((i * n_j + j) * n_k + k) * n_l + l) * channels + c] = float(words.number("a value"));
      }
    words.one_of("DataEnd", {"DataEnd"});
  }
  if (const std::string_view more = words.next(); !more.empty())
    words.fail_at(more, "expected the end of the file, found " + in_quotes(more));
  if (header.xyz)
    for (std::size_t cell = 0; cell < cells; ++cell) {
      float* x = &values[3 * cell];
      const RGB rgb = xyz_to_srgb * XYZ{double(x[0]), double(x[1]), double(x[2])};
      for (std::size_t c = 0; c < 3; ++c) {
        x[c] = float(rgb[c]);
        if (!std::isfinite(x[c])) words.fail("a tristimulus value is too large for a float");
      }
    }
  std::vector<std::pair<std::string, std::string>> facts;
  if (!header.source.empty()) facts.emplace_back("source", header.source);
  facts.emplace_back("TIS in the file", fmt::format("{:.4g} to {:.4g}", least, most));
  if (header.xyz) facts.emplace_back("values", "CIE XYZ, read as linear sRGB");
  const bool transmits = header.nodes.transmits;
  return std::make_shared<const AngleGrid>(std::move(header.nodes),
                                           header.xyz ? Channels::rgb() : Channels::grey(), std::move(values),
                                           transmits ? "transmission about the specular direction (Zemax)"
                                                     : "reflection about the specular direction (Zemax)",
                                           std::move(facts));
}

std::vector<std::uint8_t> encode_zemax(const MeasuredBsdf& measured) {
  const auto sides = measured.sides();
  if (!sides.reflects_front && !sides.transmits_to_back)
    throw Error(
        "a Zemax file holds reflection on the front or transmission to the back, and this measurement "
        "has neither: " +
        measured.kind());
  const AngleGrid::Nodes nodes = nodes_to_write(measured);
  const bool colour = measured.channels().is_rgb() || measured.channels().is_spectral();
  const std::size_t channels = colour ? 3 : 1;
  const std::size_t cells =
      nodes.theta_i.size() * nodes.phi_i.size() * nodes.theta_o.size() * nodes.phi_o.size();
  // The values in a grid of their own, which knows the nodes' directions and integrates.
  std::vector<float> values(cells * channels);
  const AngleGrid frame(nodes, Channels::grey(), std::vector<float>(cells, 0.0f), "");
  std::size_t n = 0;
  for (std::size_t i = 0; i < nodes.theta_i.size(); ++i)
    for (std::size_t j = 0; j < nodes.phi_i.size(); ++j)
      for (const double theta_o : nodes.theta_o)
        for (const double phi_o : nodes.phi_o) {
          const auto [wo, wi] = frame.directions(i, j, theta_o, phi_o);
          const auto rgb = measured.rgb(wo, wi);
          const XYZ xyz = srgb_to_xyz * RGB{rgb[0], rgb[1], rgb[2]};
          for (std::size_t c = 0; c < channels; ++c)
            values[n++] = float(colour ? std::max(xyz[c], 0.0) : rgb[0]);
        }
  const AngleGrid grid(nodes, colour ? Channels::rgb() : Channels::grey(), values, "");
  std::string text;
  const auto out = std::back_inserter(text);
  const auto degrees = [&](const char* keyword, const std::vector<double>& radians) {
    fmt::format_to(out, "{}\t{}\n", keyword, radians.size());
    for (std::size_t a = 0; a < radians.size(); ++a)
      fmt::format_to(out, "{}{:.8g}", a > 0 ? "\t" : "", radians[a] * 180 / pi);
    text += '\n';
  };
  const bool mirrored = nodes.mirror == AngleGrid::Mirror::plane_of_incidence;
  fmt::format_to(out, "# {}\nSource\tMeasured\nSymmetry\t{}\nSpectralContent\t{}\nScatterType\t{}\n",
                 measured.kind(),
                 mirrored                  ? "PlaneSymmetrical"
                 : nodes.phi_i.size() == 1 ? "Asymmetrical"
                                           : "Asymmetrical4D",
                 colour ? "XYZ" : "Monochrome", nodes.transmits ? "BTDF" : "BRDF");
  degrees("SampleRotation", nodes.phi_i);
  degrees("AngleOfIncidence", nodes.theta_i);
  degrees("ScatterAzimuth", nodes.phi_o);
  degrees("ScatterRadial", nodes.theta_o);
  for (std::size_t c = 0; c < channels; ++c) {
    text += '\n';
    text += colour ? fmt::format("Tristimulus{}\nDataBegin\n", "XYZ"[c]) : "Monochrome\nDataBegin\n";
    for (std::size_t j = 0; j < nodes.phi_i.size(); ++j)
      for (std::size_t i = 0; i < nodes.theta_i.size(); ++i) {
        fmt::format_to(out, "TIS\t{:.6g}\n", grid.albedo(i, j)[c]);
        for (std::size_t l = 0; l < nodes.phi_o.size(); ++l)
          for (std::size_t k = 0; k < nodes.theta_o.size(); ++k) {
            const std::size_t cell =
                ((i * nodes.phi_i.size() + j) * nodes.theta_o.size() + k) * nodes.phi_o.size() + l;
            fmt::format_to(out, "{}{}", values[cell * channels + c],
                           k + 1 < nodes.theta_o.size() ? '\t' : '\n');
          }
      }
    text += "DataEnd\n";
  }
  return {text.begin(), text.end()};
}

} // namespace nacre

#include "measured/formats/integra.h"

#include "core/error.h"
#include "measured/angle_grid.h"
#include "measured/formats/sample_rows.h"
#include "measured/formats/words.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace nacre {
namespace {

struct Header {
  AngleGrid::Nodes nodes;
  bool axial = false, four_d = false, intensity = false, relative = false;
  std::size_t channels = 3;
  bool spectral = false;
  std::string source;
};

bool begins_channel(std::string_view word) {
  const std::string w = lower_case(word);
  for (const char* known : {"bw", "red", "gre", "green", "blu", "blue", "wl"})
    if (w == known) return true;
  return false;
}

Header read_header(Words& words) {
  const std::vector<std::string> keywords{"Source", "TypeSym", "TypeColorModel", "TypeData", "psi", "sigma",
                                          "sigmaT", "phi",     "theta"};
  Header h;
  h.nodes.axis = AngleGrid::Axis::specular;
  h.nodes.mirror = AngleGrid::Mirror::plane_of_incidence;
  std::string_view sigma_t_at;
  while (!begins_channel(words.peek())) {
    const std::string_view at = words.peek();
    switch (words.one_of("a keyword of the header, or red or bw or wl", keywords)) {
    case 0:
      h.source = lower_case(words.word("the source")).substr(0, 40);
      break;
    case 1: {
      const std::size_t type = words.one_of(
          "the symmetry", {"AxiSymmetrical", "PlaneSymmetrical", "ASymmetrical", "DirSymmetrical"});
      h.axial = type == 0;
      if (type != 1) h.nodes.mirror = AngleGrid::Mirror::none;
      if (type == 2 && lower_case(words.peek()) == "4d") {
        words.next();
        h.four_d = true;
      }
      break;
    }
    case 2: {
      const std::size_t model = words.one_of("the colour model", {"BW", "RGB", "spectral"});
      h.spectral = model == 2;
      h.channels = model == 0   ? 1
                   : model == 1 ? 3
                                : words.count("the number of wavelengths", std::size_t(Channels::max_count));
      break;
    }
    case 3:
      h.intensity = words.one_of("the kind of data", {"Luminance", "Intensity"}) == 1;
      h.relative = words.one_of("Absolute or Relative", {"Absolute", "Relative"}) == 1;
      break;
    case 4:
      h.nodes.phi_i = words.angles("psi", -360, 360);
      break;
    case 5:
      h.nodes.theta_i = words.angles("sigma", 0, 90);
      break;
    case 6:
      if (h.nodes.theta_i.empty()) words.fail_at(at, "sigmaT before sigma");
      sigma_t_at = at;
      h.nodes.theta_specular.clear();
      for (std::size_t i = 0; i < h.nodes.theta_i.size(); ++i) {
        const double deg = words.number("an angle of sigmaT");
        if (!(std::abs(deg) <= 90))
          words.fail_at(at, fmt::format("an angle of sigmaT is {}, expected -90 to 90", deg));
        h.nodes.theta_specular.push_back(deg * pi / 180);
      }
      break;
    case 7:
      h.nodes.phi_o = words.angles("phi", -360, 360);
      break;
    default:
      h.nodes.theta_o = words.angles("theta", 0, 180);
    }
  }
  for (const auto& [nodes, name] : {std::pair{&h.nodes.theta_i, "sigma"}, std::pair{&h.nodes.phi_o, "phi"},
                                    std::pair{&h.nodes.theta_o, "theta"}})
    if (nodes->empty()) words.fail(fmt::format("no angles {} before the values", name));
  if (h.nodes.phi_i.empty()) h.nodes.phi_i = {0};
  if (!sigma_t_at.empty() && h.nodes.theta_specular.size() != h.nodes.theta_i.size())
    words.fail_at(sigma_t_at, "as many angles of sigmaT as of sigma expected");
  if (h.axial && h.nodes.phi_o.size() > 1)
    words.fail(fmt::format("axially symmetrical data has one angle phi, found {}", h.nodes.phi_o.size()));
  if (h.nodes.mirror == AngleGrid::Mirror::plane_of_incidence &&
      !(h.nodes.phi_o.front() >= 0 && h.nodes.phi_o.back() <= pi + 1e-9))
    words.fail("plane-symmetrical data has angles phi from 0 to 180");
  for (const auto* azimuths : {&h.nodes.phi_i, &h.nodes.phi_o})
    if (azimuths->back() - azimuths->front() > 2 * pi + 1e-9) words.fail("azimuths span more than a turn");
  return h;
}

} // namespace

std::shared_ptr<const MeasuredBsdf> parse_integra(std::span<const std::uint8_t> bytes, std::string_view name,
                                                  bool transmits) {
  Words words(text_of(bytes), name, ';');
  Header header = read_header(words);
  header.nodes.transmits = transmits;
  const AngleGrid::Nodes& nodes = header.nodes;
  const std::size_t n_i = nodes.theta_i.size(), n_j = nodes.phi_i.size(), n_k = nodes.theta_o.size(),
                    n_l = nodes.phi_o.size();
  // Each value takes two bytes at least, so that the counts cannot ask for more memory than the file
  // warrants.
  std::size_t cells = 1;
  for (const std::size_t n : {n_i, n_j, n_k, n_l}) {
    if (n > words.bytes_left() / cells) words.fail("more values expected than the file can hold");
    cells *= n;
  }
  if (cells > words.bytes_left() / (2 * header.channels) + 1)
    words.fail(fmt::format("expected {} values in {} channels, more than the file can hold", cells,
                           header.channels));
  std::vector<float> values(cells * header.channels);
  std::vector<double> kbdf;
  std::vector<std::pair<double, std::size_t>> wavelengths;
  bool has_kbdf = false;
  const std::vector<std::string> names = header.channels == 1
                                             ? std::vector<std::string>{"bw"}
                                             : std::vector<std::string>{"red", "green", "blue"};
  kbdf.assign(header.channels * n_i * n_j, 1.0);
  for (std::size_t c = 0; c < header.channels; ++c) {
    const std::string_view at = words.word("the next channel");
    const std::string key = lower_case(at);
    if (header.spectral) {
      if (key != "wl") words.fail_at(at, "expected wl, found " + in_quotes(at));
      const double nm = words.number("a wavelength in nm");
      if (!(nm > 0)) words.fail_at(at, fmt::format("a wavelength is {}, expected above 0", nm));
      for (const auto& [known, index] : wavelengths)
        if (known == nm) words.fail_at(at, fmt::format("a second channel of {} nm", nm));
      wavelengths.emplace_back(nm, c);
    } else if (key != names[c] && !(key.size() == 3 && key == names[c].substr(0, 3))) {
      words.fail_at(at, fmt::format("expected {}, found {}", names[c], in_quotes(at)));
    }
    if (lower_case(words.peek()) == "kbdf") {
      words.next();
      has_kbdf = true;
      for (std::size_t n = 0; n < n_i * n_j; ++n) {
        const std::string_view here = words.peek();
        kbdf[c * n_i * n_j + n] = words.number("a factor of kbdf");
        if (kbdf[c * n_i * n_j + n] < 0) words.fail_at(here, "a factor of kbdf is below 0");
      }
    }
    words.one_of("def", {"def"});
    for (std::size_t j = 0; j < n_j; ++j)
      for (std::size_t i = 0; i < n_i; ++i)
        for (std::size_t l = 0; l < n_l; ++l)
          for (std::size_t k = 0; k < n_k; ++k)
            values[(((i * n_j + j) * n_k + k) * n_l + l) * header.channels + c] =
                float(words.number("a value"));
    words.one_of("enddef", {"enddef"});
  }
  if (const std::string_view more = words.next(); !more.empty())
    words.fail_at(more, "expected the end of the file, found " + in_quotes(more));

  // Channels in order of wavelength.
  Channels channels = header.channels == 1 ? Channels::grey() : Channels::rgb();
  std::vector<std::size_t> order;
  if (header.spectral) {
    std::sort(wavelengths.begin(), wavelengths.end());
    std::vector<double> nm;
    for (const auto& [wavelength, c] : wavelengths) {
      nm.push_back(wavelength);
      order.push_back(c);
    }
    channels = Channels::spectral(std::move(nm));
  } else {
    for (std::size_t c = 0; c < header.channels; ++c)
      order.push_back(c);
  }
  std::vector<float> sorted(values.size());
  for (std::size_t cell = 0; cell < cells; ++cell)
    for (std::size_t c = 0; c < header.channels; ++c)
      sorted[cell * header.channels + c] = values[cell * header.channels + order[c]];

  std::vector<std::pair<std::string, std::string>> facts;
  if (!header.source.empty()) facts.emplace_back("source", header.source);
  facts.emplace_back("values", fmt::format("{}, {}", header.intensity ? "intensity" : "luminance",
                                           !header.relative ? "absolute"
                                           : has_kbdf       ? "relative, scaled by the shares of kbdf"
                                                            : "relative without shares, taken as absolute"));
  AngleGrid grid(std::move(header.nodes), std::move(channels), std::move(sorted),
                 transmits ? "transmission about the refracted ray (Integra)"
                           : "reflection about the specular direction (Integra)",
                 std::move(facts));
  if (header.intensity) grid.divide_by_cosines();
  const double unit = header.intensity ? 1 : inv_pi;
  for (std::size_t i = 0; i < n_i; ++i)
    for (std::size_t j = 0; j < grid.nodes().phi_i.size(); ++j) {
      const auto share = header.relative && has_kbdf ? grid.albedo(i, j) : std::vector<double>();
      for (std::size_t c = 0; c < header.channels; ++c) {
        const double k = kbdf[(order[c] * n_j + j) * n_i + i];
        if (share.empty())
          grid.scale(i, j, c, k * unit);
        else if (share[c] > 0)
          grid.scale(i, j, c, k / share[c]);
      }
    }
  return std::make_shared<const AngleGrid>(std::move(grid));
}

} // namespace nacre

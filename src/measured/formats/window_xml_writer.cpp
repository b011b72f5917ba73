#include "measured/formats/window_xml.h"

#include "core/error.h"
#include "core/parallel.h"
#include "core/warp.h"
#include "spectra/color_space.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace nacre {
namespace {

constexpr XYZ white = srgb_to_xyz * RGB{1, 1, 1};
constexpr std::size_t most_cells = std::size_t(1) << 20;

/// Y alone, or X, Y, Z relative to a perfect diffuser.
using Stored = std::array<double, 3>;
using StoredRange = std::array<float, 3>; // there are many

Stored stored(const MeasuredBsdf& measured, const Vec3d& wo, const Vec3d& wi) {
  std::array<float, Channels::max_count> f;
  const Channels& channels = measured.channels();
  const std::span<float> used(f.data(), std::size_t(channels.count()));
  if (!measured.evaluate(wo, wi, used)) return {};
  if (channels.count() == 1) return {std::max(double(f[0]), 0.0), 0, 0};
  const XYZ xyz = srgb_to_xyz * channels.to_rgb(used);
  return {std::max(xyz[0] / white[0], 0.0), std::max(xyz[1] / white[1], 0.0),
          std::max(xyz[2] / white[2], 0.0)};
}

bool knows(const MeasuredSides& s, WindowDirection d) {
  switch (d) {
  case WindowDirection::reflection_back:
    return s.reflects_front;
  case WindowDirection::reflection_front:
    return s.reflects_back;
  case WindowDirection::transmission_back:
    return s.transmits_to_back; // light from Nacre's front
  default:
    return s.transmits_to_front;
  }
}

struct TooManyCells : Error {
  using Error::Error;
};

/// A cell while the tree is made: its mean, and the range of f over all points looked at.
struct Cell {
  StoredRange mean{}, low{}, high{};
  std::vector<Cell> branches;
};

class TreeMaker {
public:
  TreeMaker(const MeasuredBsdf& measured, WindowDirection direction, int rank, const TensorTreeTolerance& t)
      : measured_(measured), direction_(direction), rank_(rank), tolerance_(t) {}

  Cell root() {
    // The first two halvings by hand, so that their cells can be made side by side.
    const std::size_t n = std::size_t(1) << rank_;
    Cell top;
    top.branches.resize(n);
    for (Cell& c : top.branches)
      c.branches.resize(n);
    parallel_for(n * n, [&](std::size_t i) {
      top.branches[i / n].branches[i % n] = cell(branch(branch({}, 1, i / n), 2, i % n), 2);
    });
    for (Cell& c : top.branches)
      join(c, 1);
    join(top, 0);
    return top;
  }

private:
  TensorTree::Position branch(TensorTree::Position lower, int level, std::size_t b) const {
    for (int d = 0; d < rank_; ++d)
      if (b >> d & 1) lower[std::size_t(d)] += std::ldexp(1.0, -level);
    return lower;
  }

  /// True if a cell of this mean may stand for all values seen.
  bool is_flat(const Cell& c) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const double off = double(std::max(c.high[k] - c.mean[k], c.mean[k] - c.low[k]));
      // The largest component sets what is small, so that deep colours are not split for their darkest.
      const double scale = double(std::max({c.mean[0], c.mean[1], c.mean[2]}));
      if (off > std::max(tolerance_.absolute, tolerance_.relative * scale)) return false;
    }
    return true;
  }

  /// Mean and range of a cell from its branches, which go if it is flat.
  void join(Cell& c, int level) const {
    c.low = c.branches.front().low;
    c.high = c.branches.front().high;
    Stored mean{};
    bool leaves = true;
    for (const Cell& b : c.branches) {
      leaves = leaves && b.branches.empty();
      for (std::size_t k = 0; k < 3; ++k) {
        c.low[k] = std::min(c.low[k], b.low[k]);
        c.high[k] = std::max(c.high[k], b.high[k]);
        mean[k] += double(b.mean[k]) / double(c.branches.size());
      }
    }
    for (std::size_t k = 0; k < 3; ++k)
      c.mean[k] = float(mean[k]);
    if (leaves && (is_flat(c) || level >= tolerance_.last_level)) c.branches.clear();
  }

  Cell point(const TensorTree::Position& lower, int level) const {
    TensorTree::Position p = lower;
    for (int d = 0; d < rank_; ++d)
      p[std::size_t(d)] += std::ldexp(0.5, -level);
    const auto [in, out] = tensor_directions(rank_, p);
    const auto [wo, wi] = window_directions(direction_, in, out);
    const Stored s = stored(measured_, wo, wi);
    const StoredRange r{float(s[0]), float(s[1]), float(s[2])};
    return {r, r, r, {}};
  }

  Cell cell(const TensorTree::Position& lower, int level) {
    if (rank_ == 3 && lower[0] >= 0.5) return {}; // holds nothing
    Cell c;
    c.branches.resize(std::size_t(1) << rank_);
    const bool deep = level >= tolerance_.first_level;
    for (std::size_t b = 0; b < c.branches.size(); ++b) {
      const auto corner = branch(lower, level + 1, b);
      c.branches[b] = deep ? point(corner, level + 1) : cell(corner, level + 1);
    }
    join(c, level);
    if (!deep || c.branches.empty()) return c;
    // Its points differ: look closer.
    if ((cells_ += c.branches.size()) > most_cells)
      throw TooManyCells(
          fmt::format("a tensor tree of more than {} cells; allow a larger tolerance", most_cells));
    for (std::size_t b = 0; b < c.branches.size(); ++b)
      c.branches[b] = cell(branch(lower, level + 1, b), level + 1);
    join(c, level);
    return c;
  }

  const MeasuredBsdf& measured_;
  WindowDirection direction_;
  int rank_;
  TensorTreeTolerance tolerance_;
  std::atomic<std::size_t> cells_{0};
};

/// One component of a tree. @param component  0: Y, 1: u', 2: v'
TensorTree::Built built(const Cell& c, bool grey, int component) {
  TensorTree::Built b;
  for (const Cell& branch : c.branches)
    b.branches.push_back(built(branch, grey, component));
  if (!b.branches.empty()) return b;
  if (grey || component == 0) {
    b.value = c.mean[grey ? 0 : 1];
    return b;
  }
  // CIE 15; black is neutral.
  const bool black = !(c.mean[0] + c.mean[1] + c.mean[2] > 0);
  const double x = black ? 1 : double(c.mean[0]), y = black ? 1 : double(c.mean[1]),
               z = black ? 1 : double(c.mean[2]);
  b.value = float((component == 1 ? 4 * x : 9 * y) / (x + 15 * y + 3 * z));
  return b;
}

WindowBsdf::Facts named(std::string name) { return {{"name", std::move(name)}}; }

std::string escaped(std::string_view text) {
  std::string s;
  for (const char c : text) {
    if (c == '&')
      s += "&amp;";
    else if (c == '<')
      s += "&lt;";
    else if (c == '>')
      s += "&gt;";
    else if (static_cast<unsigned char>(c) >= ' ')
      s += c;
  }
  return s;
}

void write_basis(const KlemsBasis& basis, std::string& text) {
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "    <AngleBasis>\n      <AngleBasisName>{}</AngleBasisName>\n", escaped(basis.name()));
  for (const KlemsBasis::Ring& r : basis.rings())
    fmt::format_to(
        out,
        "      <AngleBasisBlock><Theta>{}</Theta><nPhis>{}</nPhis><ThetaBounds><LowerTheta>{}</LowerTheta>"
        "<UpperTheta>{}</UpperTheta></ThetaBounds></AngleBasisBlock>\n",
        r.lower_deg == 0 && r.sectors == 1 ? 0 : (r.lower_deg + r.upper_deg) / 2, r.sectors, r.lower_deg,
        r.upper_deg);
  text += "    </AngleBasis>\n";
}

} // namespace

WindowBsdf make_tensor_tree(const MeasuredBsdf& measured, const TensorTreeTolerance& tolerance) {
  const int rank = measured.is_isotropic() ? 3 : 4;
  TensorTreeTolerance t = tolerance;
  if (t.last_level == 0) t.last_level = rank == 3 ? 8 : 6;
  if (t.first_level == 0) t.first_level = std::min(rank == 3 ? 5 : 4, t.last_level);
  if (t.first_level < 2 || t.last_level < t.first_level || t.last_level > 10 || !(t.relative >= 0) ||
      !(t.absolute >= 0))
    throw Error(
        fmt::format("a tensor tree of {} to {} halvings within {} and {}; expected 2 to 10 and tolerances of "
                    "0 or more",
                    t.first_level, t.last_level, t.relative, t.absolute));
  const bool grey = measured.channels().count() == 1;
  WindowBsdf::Blocks blocks;
  for (std::size_t d = 0; d < blocks.size(); ++d) {
    if (!knows(measured.sides(), WindowDirection(d))) continue;
    const Cell root = TreeMaker(measured, WindowDirection(d), rank, t).root();
    WindowBlock block;
    for (int component = 0; component < (grey ? 1 : 3); ++component)
      block.emplace_back(TensorTree(rank, built(root, grey, component)));
    blocks[d] = std::move(block);
  }
  return WindowBsdf(grey ? WindowColor::grey : WindowColor::yuv, std::move(blocks),
                    named(fmt::format("{}, within {} or {}/sr", measured.kind(), t.relative, t.absolute)));
}

WindowBsdf make_tensor_tree(const MeasuredBsdf& measured) {
  for (TensorTreeTolerance t;; t.relative *= 2)
    try {
      return make_tensor_tree(measured, t);
    } catch (const TooManyCells&) {
      if (t.relative > 1) throw;
    }
}

WindowBsdf make_klems(const MeasuredBsdf& measured, const KlemsBasis& basis) {
  constexpr int n = 3; // points each way in a patch
  const auto shared = std::make_shared<const KlemsBasis>(basis);
  const std::size_t size = std::size_t(basis.size()), components = measured.channels().count() == 1 ? 1 : 3;
  WindowBsdf::Blocks blocks;
  for (std::size_t d = 0; d < blocks.size(); ++d) {
    if (!knows(measured.sides(), WindowDirection(d))) continue;
    std::vector<KlemsMatrix> matrices(components, {shared, shared, std::vector<float>(size * size)});
    parallel_for(size, [&](std::size_t out) {
      const auto at = [](int i) { return Vec2d{(i % n + 0.5) / n, (i / n + 0.5) / n}; };
      for (std::size_t in = 0; in < size; ++in) {
        Stored sum{};
        for (int o = 0; o < n * n; ++o)
          for (int i = 0; i < n * n; ++i) {
            const auto [wo, wi] = window_directions(WindowDirection(d), basis.direction(int(in), at(i)),
                                                    basis.direction(int(out), at(o)));
            const Stored s = stored(measured, wo, wi);
            for (std::size_t c = 0; c < 3; ++c)
              sum[c] += s[c] / (n * n * n * n);
          }
        for (std::size_t c = 0; c < components; ++c)
          matrices[c].values[out * size + in] = float(sum[c]);
      }
    });
    blocks[d] = WindowBlock(matrices.begin(), matrices.end());
  }
  return WindowBsdf(components == 1 ? WindowColor::grey : WindowColor::xyz, std::move(blocks),
                    named(measured.kind() + ", means over patches"));
}

std::vector<std::uint8_t> encode_window_xml(const WindowBsdf& bsdf) {
  const auto& blocks = bsdf.blocks();
  const auto any = std::find_if(blocks.begin(), blocks.end(), [](const auto& b) { return b.has_value(); });
  const auto* tree = std::get_if<TensorTree>(&(*any)->front());
  std::string name = "Name", maker = "Manufacturer";
  for (const auto& [label, fact] : bsdf.facts()) {
    if (label == "name") name = fact;
    if (label == "manufacturer") maker = fact;
  }

  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<WindowElement xmlns=\"http://windows.lbl.gov\" "
      "xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
      "xsi:schemaLocation=\"http://windows.lbl.gov/BSDF-v1.4.xsd\">\n"
      "<WindowElementType>System</WindowElementType>\n<FileType>BSDF</FileType>\n<Optical>\n<Layer>\n";
  const auto out = std::back_inserter(text);
  fmt::format_to(out,
                 "  <Material>\n    <Name>{}</Name>\n    <Manufacturer>{}</Manufacturer>\n"
                 "    <DeviceType>Other</DeviceType>\n  </Material>\n"
                 "  <DataDefinition>\n    <IncidentDataStructure>{}</IncidentDataStructure>\n",
                 escaped(name), escaped(maker), tree ? fmt::format("TensorTree{}", tree->rank()) : "Columns");
  std::vector<std::string> written;
  for (const auto& block : blocks) {
    if (!block || tree) continue;
    const auto& m = std::get<KlemsMatrix>(block->front());
    for (const auto& basis : {m.incident, m.outgoing})
      if (std::find(written.begin(), written.end(), basis->name()) == written.end()) {
        write_basis(*basis, text);
        written.push_back(basis->name());
      }
  }
  text += "  </DataDefinition>\n";

  static constexpr std::array<const char*, 1> grey{"Visible"};
  static constexpr std::array<const char*, 3> xyz{"CIE-X", "Visible", "CIE-Z"},
      yuv{"Visible", "CIE-u", "CIE-v"};
  const std::span<const char* const> components =
      bsdf.color() == WindowColor::grey  ? std::span<const char* const>(grey)
      : bsdf.color() == WindowColor::xyz ? std::span<const char* const>(xyz)
                                         : yuv;
  for (std::size_t c = 0; c < components.size(); ++c) {
    fmt::format_to(out,
                   "  <WavelengthData>\n    <LayerNumber>System</LayerNumber>\n"
                   "    <Wavelength unit=\"Integral\">{}</Wavelength>\n"
                   "    <SourceSpectrum>CIE Illuminant D65 1nm.ssp</SourceSpectrum>\n",
                   components[c]);
    for (std::size_t d = 0; d < blocks.size(); ++d) {
      if (!blocks[d]) continue;
      const WindowData& data = (*blocks[d])[c];
      fmt::format_to(
          out, "    <WavelengthDataBlock>\n      <WavelengthDataDirection>{}</WavelengthDataDirection>\n",
          window_direction_names[d]);
      if (const auto* m = std::get_if<KlemsMatrix>(&data))
        fmt::format_to(
            out, "      <ColumnAngleBasis>{}</ColumnAngleBasis>\n      <RowAngleBasis>{}</RowAngleBasis>\n",
            escaped(m->incident->name()), escaped(m->outgoing->name()));
      else
        text += "      <AngleBasis>LBNL/Shirley-Chiu</AngleBasis>\n";
      text += "      <ScatteringDataType>BTDF</ScatteringDataType>\n      <ScatteringData>\n";
      if (const auto* m = std::get_if<KlemsMatrix>(&data)) {
        const std::size_t in = std::size_t(m->incident->size());
        for (std::size_t i = 0; i < m->values.size(); ++i)
          fmt::format_to(out, "{}{}", m->values[i], i % in + 1 == in ? "\n" : ", ");
      } else {
        text += std::get<TensorTree>(data).to_text();
      }
      text += "      </ScatteringData>\n    </WavelengthDataBlock>\n";
    }
    text += "  </WavelengthData>\n";
  }
  text += "</Layer>\n</Optical>\n</WindowElement>\n";
  return {text.begin(), text.end()};
}

} // namespace nacre

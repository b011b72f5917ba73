#include "measured/formats/window_xml.h"

#include "core/error.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <pugixml.hpp>

namespace nacre {
namespace {

constexpr std::size_t most_bytes = std::size_t(1) << 31;

std::string lower(std::string_view text) {
  std::string s(text);
  std::transform(s.begin(), s.end(), s.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return s;
}

std::string trimmed(std::string_view text) {
  const auto blank = [](unsigned char c) { return std::isspace(c) != 0; };
  while (!text.empty() && blank(static_cast<unsigned char>(text.front())))
    text.remove_prefix(1);
  while (!text.empty() && blank(static_cast<unsigned char>(text.back())))
    text.remove_suffix(1);
  return std::string(text);
}

class Reader {
public:
  Reader(std::span<const std::uint8_t> bytes, std::string_view name)
      : text_(reinterpret_cast<const char*>(bytes.data()), bytes.size()), name_(name) {}

  WindowBsdf read() {
    if (text_.size() > most_bytes)
      throw Error::in_file(name_, fmt::format("{} bytes, more than {}", text_.size(), most_bytes));
    const pugi::xml_parse_result result = document_.load_buffer(text_.data(), text_.size());
    if (!result) fail_at(result.offset, fmt::format("not XML: {}", result.description()));
    const pugi::xml_node root = document_.document_element();
    if (lower(root.name()) != "windowelement")
      fail(root, fmt::format("expected a document of WINDOW or Radiance, <WindowElement>, found <{}>",
                             root.name()));
    const pugi::xml_node optical = child(root, "Optical"), layer = child(optical, "Layer");
    if (layer.next_sibling("Layer")) facts_.emplace_back("layers", "more than one; this is the first");
    material(layer);
    definition(child(layer, "DataDefinition"));
    std::vector<std::string> others;
    for (const pugi::xml_node data : layer.children("WavelengthData"))
      wavelength(data, others);
    if (!others.empty()) facts_.emplace_back("not read", fmt::format("{}", fmt::join(others, ", ")));
    return finish(layer, others);
  }

private:
  enum Component { luminance, x, z, u, v };
  static constexpr std::array<const char*, 5> component_names{"Visible", "CIE-X", "CIE-Z", "CIE-u", "CIE-v"};

  [[noreturn]] void fail_at(std::ptrdiff_t offset, const std::string& what) const {
    const auto end = std::size_t(std::clamp<std::ptrdiff_t>(offset, 0, std::ssize(text_)));
    const std::string_view before = text_.substr(0, end);
    const auto line = std::count(before.begin(), before.end(), '\n') + 1;
    const std::size_t start = before.find_last_of('\n');
    throw Error::in_text(name_, int(line), int(end - (start == std::string_view::npos ? 0 : start + 1)) + 1,
                         what);
  }
  [[noreturn]] void fail(pugi::xml_node node, const std::string& what) const {
    fail_at(node.offset_debug(), what);
  }

  pugi::xml_node child(pugi::xml_node of, const char* tag) const {
    const pugi::xml_node found = of.child(tag);
    if (found) return found;
    std::vector<std::string> known;
    for (const pugi::xml_node c : of.children())
      if (c.type() == pugi::node_element && known.size() < 10) known.emplace_back(c.name());
    fail(of, fmt::format("<{}> has no <{}>{}", of.name(), tag, suggestion(tag, known)));
  }

  /// The name among `known` that the text of a node is, without regard to case.
  template <class Names>
  std::size_t one_of(pugi::xml_node node, const Names& known) const {
    const std::string text = trimmed(node.child_value());
    std::vector<std::string> names;
    for (std::size_t i = 0; i < std::size(known); ++i) {
      if (lower(known[i]) == lower(text)) return i;
      names.emplace_back(known[i]);
    }
    fail(node, fmt::format("<{}> is '{}'{}", node.name(), text, suggestion(text, names)));
  }

  double number(pugi::xml_node node) const {
    const std::string text = trimmed(node.child_value());
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
      fail(node, fmt::format("<{}> is '{}', expected a number", node.name(), text));
    return value;
  }

  void material(pugi::xml_node layer) {
    const pugi::xml_node m = layer.child("Material");
    for (const auto& [tag, label] : {std::pair{"Name", "name"}, {"Manufacturer", "manufacturer"}}) {
      const std::string text = trimmed(m.child_value(tag));
      // What Radiance's own tools write where nothing is known.
      if (!text.empty() && text != tag) facts_.emplace_back(label, text);
    }
  }

  void definition(pugi::xml_node node) {
    static constexpr std::array<const char*, 4> structures{"Columns", "Rows", "TensorTree3", "TensorTree4"};
    const std::size_t s = one_of(child(node, "IncidentDataStructure"), structures);
    rank_ = s == 2 ? 3 : s == 3 ? 4 : 0;
    incident_rows_ = s == 1;
    for (const pugi::xml_node basis : node.children("AngleBasis")) {
      const std::string name = trimmed(child(basis, "AngleBasisName").child_value());
      std::vector<KlemsBasis::Ring> rings;
      for (const pugi::xml_node block : basis.children("AngleBasisBlock")) {
        const pugi::xml_node bounds = child(block, "ThetaBounds"), sectors = child(block, "nPhis");
        const double n = number(sectors);
        if (!(n >= 1 && n <= KlemsBasis::max_patches && n == std::floor(n)))
          fail(sectors, fmt::format("{} patches in a ring, expected 1 to {}", n, KlemsBasis::max_patches));
        // The cap about the pole is given as -5 to 5 degrees or so by some.
        const double from = rings.empty() ? 0 : number(child(bounds, "LowerTheta"));
        rings.push_back({from, number(child(bounds, "UpperTheta")), int(n)});
      }
      if (rings.empty()) {
        if (!known_bases(name).empty()) continue;
        fail(basis, fmt::format("angle basis '{}' is no standard one and defines no rings", name));
      }
      if (bases_.size() > 100) fail(basis, "more than 100 angle bases");
      try {
        bases_.push_back(std::make_shared<const KlemsBasis>(name, std::move(rings)));
      } catch (const Error& e) {
        fail(basis, e.what());
      }
    }
  }

  using Bases = std::vector<std::shared_ptr<const KlemsBasis>>;
  /// The file's own rings are what it means by a name; else those that the name stands for.
  Bases known_bases(const std::string& name) const {
    Bases found;
    for (const auto& b : bases_)
      if (lower(b->name()) == lower(name)) found.push_back(b);
    if (!found.empty()) return found;
    for (const KlemsBasis& b : KlemsBasis::standard())
      if (lower(b.name()) == lower(name)) found.push_back(std::make_shared<const KlemsBasis>(b));
    return found;
  }
  /// The bases of this name, at least one: they differ in the number of their patches.
  Bases bases_of(pugi::xml_node node) const {
    const std::string name = trimmed(node.child_value());
    if (auto found = known_bases(name); !found.empty()) return found;
    std::vector<std::string> known;
    for (const auto& b : bases_)
      known.push_back(b->name());
    for (const KlemsBasis& b : KlemsBasis::standard())
      known.push_back(b.name());
    fail(node,
         fmt::format("<{}> is '{}', which is not defined{}", node.name(), name, suggestion(name, known)));
  }

  void wavelength(pugi::xml_node data, std::vector<std::string>& others) {
    const pugi::xml_node node = child(data, "Wavelength");
    const std::string name = trimmed(node.child_value());
    std::size_t component = component_names.size();
    for (std::size_t i = 0; i < component_names.size(); ++i)
      if (lower(name) == lower(component_names[i])) component = i;
    if (lower(name) == "cie-y") component = luminance;
    if (component == component_names.size()) {
      if (std::find(others.begin(), others.end(), name) == others.end() && others.size() < 20)
        others.push_back(name);
      return;
    }
    for (const pugi::xml_node block : data.children("WavelengthDataBlock")) {
      const std::size_t direction = one_of(child(block, "WavelengthDataDirection"), window_direction_names);
      auto& place = data_[direction][component];
      if (place) fail(block, fmt::format("a second block {} of {}", window_direction_names[direction], name));
      place = rank_ == 0 ? WindowData(matrix(block)) : WindowData(tree(block));
      if (!first_block_[direction]) first_block_[direction] = block;
    }
  }

  /// The numbers of a block and their offset in the file.
  std::pair<std::string_view, std::ptrdiff_t> numbers(pugi::xml_node block) const {
    const pugi::xml_node node = child(block, "ScatteringData");
    const pugi::xml_node text = node.first_child();
    return {node.child_value(), text ? text.offset_debug() : node.offset_debug()};
  }

  TensorTree tree(pugi::xml_node block) const {
    const pugi::xml_node basis = child(block, "AngleBasis");
    static constexpr std::array<const char*, 1> known{"LBNL/Shirley-Chiu"};
    one_of(basis, known);
    const auto [text, offset] = numbers(block);
    return TensorTree::parse(rank_, text, [&, start = offset](std::size_t at, const std::string& what) {
      fail_at(start + std::ptrdiff_t(at), what);
    });
  }

  static std::size_t count_of_numbers(std::string_view text) {
    std::size_t count = 0;
    bool within = false;
    for (const char c : text) {
      const bool separates = c == ',' || std::isspace(static_cast<unsigned char>(c));
      count += !separates && !within;
      within = !separates;
    }
    return count;
  }

  KlemsMatrix matrix(pugi::xml_node block) const {
    // Columns are incident, or rows where the file says so; then the names of the bases say so too.
    KlemsMatrix m;
    const auto [text, offset] = numbers(block);
    const std::size_t count = count_of_numbers(text);
    for (const auto& incident : bases_of(child(block, "ColumnAngleBasis")))
      for (const auto& outgoing : bases_of(child(block, "RowAngleBasis")))
        if (!m.incident || std::size_t(incident->size()) * std::size_t(outgoing->size()) == count) {
          m.incident = incident;
          m.outgoing = outgoing;
        }
    const std::size_t in = std::size_t(m.incident->size()), out = std::size_t(m.outgoing->size());
    if (text.size() / 2 + 1 < in * out)
      fail_at(offset, fmt::format("too short for {} x {} numbers", out, in));
    m.values.resize(in * out);
    const char *p = text.data(), *const end = p + text.size();
    const auto skip = [&] {
      while (p < end && (*p == ',' || std::isspace(static_cast<unsigned char>(*p))))
        ++p;
    };
    for (std::size_t i = 0; i < in * out; ++i) {
      skip();
      if (p < end && *p == '+') ++p;
      double value = 0;
      const auto [after, error] = std::from_chars(p, end, value);
      if (error == std::errc::result_out_of_range && std::abs(value) < 1)
        value = 0;
      else if (error != std::errc() || !(std::abs(value) < 1e30))
        fail_at(offset + (p - text.data()),
                fmt::format("number {} of {} x {}: expected a finite number of f, in 1/sr", i + 1, out, in));
      p = after;
      m.values[incident_rows_ ? i % out * in + i / out : i] = float(std::max(value, 0.0));
    }
    skip();
    if (p < end) fail_at(offset + (p - text.data()), fmt::format("more than {} x {} numbers", out, in));
    return m;
  }

  WindowBsdf finish(pugi::xml_node layer, const std::vector<std::string>& others) {
    const std::array<Component, 2> chroma = rank_ == 0 ? std::array{x, z} : std::array{u, v};
    // WINDOW itself gives trees in u' and v' and matrices in X and Z; X and Z of trees are as good.
    const auto has = [&](Component c) {
      return std::any_of(data_.begin(), data_.end(), [&](const auto& d) { return d[c].has_value(); });
    };
    const bool has_xz = has(x) && has(z), has_uv = rank_ != 0 && has(u) && has(v);
    const WindowColor color = has_uv ? WindowColor::yuv : has_xz ? WindowColor::xyz : WindowColor::grey;
    const std::array<Component, 2> more = color == WindowColor::xyz ? std::array{x, z} : chroma;
    WindowBsdf::Blocks blocks;
    for (std::size_t d = 0; d < data_.size(); ++d) {
      auto& parts = data_[d];
      const auto any = std::find_if(parts.begin(), parts.end(), [](const auto& p) { return p.has_value(); });
      if (any == parts.end()) continue;
      const auto need = [&](Component c) -> WindowData& {
        if (parts[c]) return *parts[c];
        fail(first_block_[d],
             fmt::format("{} has {} but not {}", window_direction_names[d],
                         component_names[std::size_t(any - parts.begin())], component_names[c]));
      };
      WindowBlock block;
      WindowData& y = need(luminance);
      if (color == WindowColor::xyz) {
        block = {need(more[0]), y, need(more[1])};
      } else if (color == WindowColor::yuv) {
        block = {y, need(more[0]), need(more[1])};
      } else {
        block = {y};
      }
      blocks[d] = std::move(block);
    }
    if (std::none_of(blocks.begin(), blocks.end(), [](const auto& b) { return b.has_value(); }))
      fail(layer, others.empty() ? std::string("no <WavelengthData> with numbers")
                                 : fmt::format("no data of the wavelength 'Visible', found {}",
                                               fmt::join(others, ", ")));
    try {
      return WindowBsdf(color, std::move(blocks), std::move(facts_));
    } catch (const Error& e) {
      throw Error::in_file(name_, e.what());
    }
  }

  std::string_view text_, name_;
  pugi::xml_document document_;
  int rank_ = 0;
  bool incident_rows_ = false;
  std::vector<std::shared_ptr<const KlemsBasis>> bases_;
  std::array<std::array<std::optional<WindowData>, 5>, 4> data_;
  std::array<pugi::xml_node, 4> first_block_;
  WindowBsdf::Facts facts_;
};

} // namespace

bool recognises_window_xml(std::span<const std::uint8_t> bytes) {
  const std::string_view head(reinterpret_cast<const char*>(bytes.data()),
                              std::min<std::size_t>(bytes.size(), 65536));
  return head.find("<WindowElement") != std::string_view::npos;
}

WindowBsdf parse_window_xml(std::span<const std::uint8_t> bytes, std::string_view name) {
  return Reader(bytes, name).read();
}

} // namespace nacre

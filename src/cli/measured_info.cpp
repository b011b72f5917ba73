#include "cli/measured_info.h"

#include "measured/formats.h"
#include "measured/inspection.h"
#include "measured/measured_albedo.h"
#include "measured/merl_table.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

constexpr std::array albedo_angles_deg{0, 30, 60, 75, 85};
constexpr int regions = 6; // a quarter of the circle in parts of 15 degrees

/// Holes among the entries of each 15 degrees of theta_h and theta_d.
struct HoleMap {
  std::array<std::array<std::size_t, regions>, regions> entries{}, holes{};

  explicit HoleMap(const MerlTable& table) {
    const auto region = [](double angle) {
      return std::min(static_cast<int>(angle / (pi / 2) * regions), regions - 1);
    };
    for (int i = 0; i < table.n_theta_h(); ++i)
      for (int j = 0; j < table.n_theta_d(); ++j) {
        const int h = region(table.theta_h(i)), d = region(table.theta_d(j));
        entries[h][d] += table.n_phi_d();
        for (int k = 0; k < table.n_phi_d(); ++k)
          holes[h][d] += table.is_hole(i, j, k);
      }
  }
  /// In percent; below 0 where the table has no entries.
  double share(int h, int d) const { return entries[h][d] ? 100.0 * holes[h][d] / entries[h][d] : -1; }
};

/// Holes at nodes whose directions are both above the horizon: there, a measurement is missing.
std::size_t missing_above_horizon(const MerlTable& table) {
  std::size_t missing = 0;
  for (int i = 0; i < table.n_theta_h(); ++i)
    for (int j = 0; j < table.n_theta_d(); ++j)
      for (int k = 0; k < table.n_phi_d(); ++k)
        missing += table.is_hole(i, j, k) && above_horizon(table.node(i, j, k));
  return missing;
}

/// Range over all entries of a table that have a value, those at the horizon and below too.
SampleStatistics entry_statistics(const MerlTable& table) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  SampleStatistics s{0, std::vector<ChannelRange>(3, {infinite, -infinite, 0})};
  for (const MerlTable::Cell& cell : table.cells()) {
    if (cell[3] == 0) continue;
    ++s.count;
    for (std::size_t c = 0; c < 3; ++c) {
      ChannelRange& range = s.channels[c];
      range.lo = std::min(range.lo, double(cell[c])), range.hi = std::max(range.hi, double(cell[c]));
      range.mean += double(cell[c]);
    }
  }
  for (ChannelRange& range : s.channels)
    range.mean /= double(s.count);
  return s;
}

std::vector<std::string> channel_names(const Channels& channels) {
  if (channels.is_rgb()) return {"red", "green", "blue"};
  if (!channels.is_spectral()) return {"grey"};
  std::vector<std::string> names;
  for (const double nm : channels.wavelengths_nm())
    names.push_back(fmt::format("{:g} nm", nm));
  return names;
}

nlohmann::json range_json(const ChannelRange& r) { return {{"min", r.lo}, {"max", r.hi}, {"mean", r.mean}}; }

nlohmann::json albedo_json(const MeasuredBsdf& measured) {
  const MeasuredSides sides = measured.sides();
  nlohmann::json list = nlohmann::json::array();
  for (const bool back : {false, true}) {
    const bool reflects = back ? sides.reflects_back : sides.reflects_front;
    const bool transmits = back ? sides.transmits_to_back : sides.transmits_to_front;
    if (!reflects && !transmits) continue;
    for (const int degrees : albedo_angles_deg) {
      // Of anisotropic data the mean over azimuths of the direction, each on a coarser grid.
      const int azimuths = measured.is_isotropic() ? 1 : 8, coarser = measured.is_isotropic() ? 1 : 3;
      DirectionalAlbedo sum;
      for (int a = 0; a < azimuths; ++a) {
        const Vec3d w =
            spherical_direction(degrees * pi / 180, 2 * pi * (a + 0.5 * (azimuths > 1)) / azimuths);
        const auto albedo =
            directional_albedo(measured, {w.x, w.y, back ? -w.z : w.z}, 720 / coarser, 128 / coarser);
        for (std::size_t c = 0; c < 3; ++c) {
          sum.reflected[c] += albedo.reflected[c] / azimuths;
          sum.transmitted[c] += albedo.transmitted[c] / azimuths;
        }
      }
      nlohmann::json entry{{"theta_deg", degrees}, {"from", back ? "back" : "front"}};
      if (reflects) entry["rgb"] = sum.reflected;
      if (transmits) entry["transmitted_rgb"] = sum.transmitted;
      list.push_back(entry);
    }
  }
  return list;
}

nlohmann::json angles_json(const Vec3d& w) {
  const double theta = std::acos(std::clamp(w.z, -1.0, 1.0)) * 180 / pi,
               phi = std::atan2(w.y, w.x) * 180 / pi;
  return {{"theta_deg", theta}, {"phi_deg", phi < 0 ? phi + 360 : phi}};
}

nlohmann::json reciprocity_json(const MeasuredBsdf& measured) {
  const ReciprocityError e = reciprocity_error(measured);
  nlohmann::json json{{"pairs", e.pairs}};
  if (e.pairs == 0) return json;
  json["mean"] = e.mean;
  json["worst"] = e.worst;
  json["worst_at"] = {{"o", angles_json(e.wo)}, {"i", angles_json(e.wi)}};
  return json;
}

void add_table_numbers(const MerlTable& table, nlohmann::json& json) {
  const HoleMap map(table);
  nlohmann::json where = nlohmann::json::array();
  for (int h = 0; h < regions; ++h) {
    nlohmann::json row = nlohmann::json::array();
    for (int d = 0; d < regions; ++d)
      row.push_back(map.entries[h][d] ? nlohmann::json(map.share(h, d)) : nlohmann::json());
    where.push_back(row);
  }
  json["n_theta_h"] = table.n_theta_h();
  json["n_theta_d"] = table.n_theta_d();
  json["n_phi_d"] = table.n_phi_d();
  json["phi_d_period_deg"] = table.phi_d_period() * 180 / pi;
  json["entries"] = table.size();
  json["holes"] = table.hole_count();
  json["holes_above_horizon"] = missing_above_horizon(table);
  json["filled"] = table.filled_count();
  json["holes_percent_by_15_degrees_theta_h_theta_d"] = where;
}

std::string hole_text(const MerlTable& table, const nlohmann::json& json) {
  std::string text = fmt::format("  holes       {} of {} entries ({:.2f} %), {} of them above the horizon\n",
                                 table.hole_count(), table.size(), 100.0 * table.hole_count() / table.size(),
                                 json["holes_above_horizon"].get<std::size_t>());
  if (table.filled_count() > 0) text += fmt::format("  filled      {} entries\n", table.filled_count());
  if (table.hole_count() == 0) return text;
  const HoleMap map(table);
  text += "  holes in percent, by angle in degrees\n  theta_h \\ theta_d";
  for (int d = 0; d < regions; ++d)
    text += fmt::format("{:>4}-{:<2}", 15 * d, 15 * d + 15);
  for (int h = 0; h < regions; ++h) {
    text += fmt::format("\n            {:>2}-{:<2} ", 15 * h, 15 * h + 15);
    for (int d = 0; d < regions; ++d)
      text += map.entries[h][d] ? fmt::format("{:>6.1f} ", map.share(h, d)) : fmt::format("{:>6} ", "-");
  }
  return text + "\n";
}

/// '.' none, 1 to 9 tenths, '#' all.
char coverage_mark(double share) {
  if (share <= 0) return '.';
  if (share >= 1) return '#';
  return char('0' + std::clamp(int(std::lround(10 * share)), 1, 9));
}

std::string coverage_text(const nlohmann::json& maps) {
  std::string text;
  for (const auto& map : maps) {
    text += fmt::format("  coverage    {:.1f} % of the pairs of directions: {}\n"
                        "              share of azimuths by angle in degrees: . none, 1 to 9 tenths, # all\n"
                        "    theta_o \\ theta_i   0     15    30    45    60    75   90\n",
                        100 * map["share"].get<double>(), map["sides"].get<std::string>());
    const auto& rows = map["share_by_theta_o_theta_i"];
    for (std::size_t o = 0; o < rows.size(); ++o) {
      text += fmt::format("              {:>3}-{:<3}  ", 5 * o, 5 * o + 5);
      for (const auto& share : rows[o])
        text += fmt::format("{} ", coverage_mark(share.get<double>()));
      text += "\n";
    }
  }
  return text;
}

std::string angles_text(const nlohmann::json& w) {
  return fmt::format("theta {:.1f} phi {:.1f}", w["theta_deg"].get<double>(), w["phi_deg"].get<double>());
}

std::string yes_no(bool b) { return b ? "yes" : ""; }

} // namespace

nlohmann::json describe(const MeasuredBsdf& measured) {
  const Channels& channels = measured.channels();
  const auto* table = dynamic_cast<const MerlTable*>(&measured);
  const SampleStatistics statistics = table ? entry_statistics(*table) : sample_statistics(measured);
  const std::vector<std::string> names = channel_names(channels);

  nlohmann::json facts = nlohmann::json::array();
  for (const auto& [label, text] : measured.facts())
    facts.push_back({{"label", label}, {"text", text}});
  nlohmann::json range = nlohmann::json::object();
  for (std::size_t c = 0; c < names.size(); ++c)
    range[names[c]] = statistics.count > 0 ? range_json(statistics.channels[c]) : nlohmann::json();
  nlohmann::json sides = nlohmann::json::array(), maps = nlohmann::json::array();
  for (const SidePair& pair : side_pairs(measured.sides()))
    sides.push_back(pair.name);
  for (const CoverageMap& map : coverage(measured))
    maps.push_back(
        {{"sides", map.sides.name}, {"share", map.whole}, {"share_by_theta_o_theta_i", map.share}});

  nlohmann::json json{{"kind", measured.kind()},
                      {"facts", facts},
                      {"channels", names},
                      {"isotropic", measured.is_isotropic()},
                      {"sides", sides},
                      {"samples", statistics.count},
                      {"range", range},
                      {"coverage", maps},
                      {"albedo", albedo_json(measured)},
                      {"reciprocity_error", reciprocity_json(measured)}};
  if (channels.is_spectral()) json["wavelengths_nm"] = channels.wavelengths_nm();
  if (table) add_table_numbers(*table, json);
  return json;
}

std::string describe_as_text(const MeasuredBsdf& measured, const nlohmann::json& json) {
  const Channels& channels = measured.channels();
  const std::vector<std::string> names = channel_names(channels);
  std::string text = fmt::format("  kind        {}, {}\n", measured.kind(),
                                 channels.is_rgb() ? "RGB, linear, 1/sr" : "1/sr");
  for (const auto& [label, what] : measured.facts())
    text += fmt::format("  {:<11} {}\n", label, what);
  if (channels.is_spectral())
    text += fmt::format("  channels    {} wavelengths from {} to {}\n", names.size(), names.front(),
                        names.back());
  text +=
      fmt::format("  sides       {}; {}\n", fmt::join(json["sides"].get<std::vector<std::string>>(), ", "),
                  measured.is_isotropic() ? "isotropic" : "anisotropic");
  text += fmt::format("  samples     {}\n", json["samples"].get<std::size_t>());
  // Of many wavelengths some, the first and the last among them.
  const std::size_t shown = std::min<std::size_t>(names.size(), 9);
  for (std::size_t n = 0; n < shown; ++n) {
    const std::string& name = names[shown > 1 ? n * (names.size() - 1) / (shown - 1) : 0];
    if (const auto& r = json["range"][name]; r.is_null())
      text += fmt::format("  {:<10}  no values\n", name);
    else
      text += fmt::format("  {:<10}  {:.6g} to {:.6g}, mean {:.6g}\n", name, r["min"].get<double>(),
                          r["max"].get<double>(), r["mean"].get<double>());
  }
  if (const auto* table = dynamic_cast<const MerlTable*>(&measured)) text += hole_text(*table, json);
  text += coverage_text(json["coverage"]);
  text += "  albedo      at angle to the normal: red green blue\n";
  for (const auto& a : json["albedo"])
    for (const auto& [key, what] : {std::pair{"rgb", "reflected"}, {"transmitted_rgb", "let through"}})
      if (a.contains(key))
        text += fmt::format("    {:>3} deg   {:.4f} {:.4f} {:.4f}  {}, from the {}\n",
                            a["theta_deg"].get<int>(), a[key][0].get<double>(), a[key][1].get<double>(),
                            a[key][2].get<double>(), what, a["from"].get<std::string>());
  const auto& e = json["reciprocity_error"];
  if (e["pairs"].get<std::size_t>() == 0)
    text += "  reciprocity no pair of directions is measured both ways\n";
  else
    text += fmt::format(
        "  reciprocity error |f(o,i) - f(i,o)| over their mean: {:.3g} on average, {:.3g} at worst, "
        "o at {}, i at {}\n",
        e["mean"].get<double>(), e["worst"].get<double>(), angles_text(e["worst_at"]["o"]),
        angles_text(e["worst_at"]["i"]));
  return text;
}

nlohmann::json describe_formats() {
  nlohmann::json list = nlohmann::json::array();
  for (const MeasuredFormat& f : measured_formats())
    list.push_back({{"name", f.name},
                    {"description", f.description},
                    {"endings", f.endings},
                    {"reads", f.parse != nullptr},
                    {"writes", f.encode != nullptr}});
  return {{"formats", list}};
}

std::string describe_formats_as_text() {
  std::string text = fmt::format("{:<18} {:<16} {:<5} {:<6} {}\n", "format", "endings", "read", "write", "");
  for (const MeasuredFormat& f : measured_formats())
    text +=
        fmt::format("{:<18} {:<16} {:<5} {:<6} {}\n", f.name, fmt::format("{}", fmt::join(f.endings, " ")),
                    yes_no(f.parse != nullptr), yes_no(f.encode != nullptr), f.description);
  return text;
}

} // namespace nacre

#include "cli/commands.h"
#include "core/error.h"
#include "core/image.h"
#include "measured/merl_albedo.h"

#include <filesystem>
#include <fmt/format.h>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

constexpr std::array<double, 5> albedo_angles_deg{0, 30, 60, 75, 85};
constexpr int regions = 6; // a quarter of the circle in parts of 15 degrees

struct Range {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo, sum = 0;
  std::size_t count = 0;
  void add(double x) { lo = std::min(lo, x), hi = std::max(hi, x), sum += x, ++count; }
  nlohmann::json json() const {
    if (count == 0) return nullptr;
    return {{"min", lo}, {"max", hi}, {"mean", sum / count}};
  }
};

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

nlohmann::json describe(const MerlTable& table) {
  std::array<Range, 3> range;
  for (const MerlTable::Cell& cell : table.cells())
    if (cell[3] != 0)
      for (int channel = 0; channel < 3; ++channel)
        range[channel].add(cell[channel]);
  const HoleMap map(table);
  nlohmann::json where = nlohmann::json::array(), albedo = nlohmann::json::array();
  for (int h = 0; h < regions; ++h) {
    nlohmann::json row = nlohmann::json::array();
    for (int d = 0; d < regions; ++d)
      row.push_back(map.entries[h][d] ? nlohmann::json(map.share(h, d)) : nlohmann::json());
    where.push_back(row);
  }
  for (const double theta : albedo_angles_deg)
    albedo.push_back({{"theta_deg", theta}, {"rgb", directional_albedo(table, theta * pi / 180)}});
  return {{"kind", "isotropic reflectance table (MERL)"},
          {"n_theta_h", table.n_theta_h()},
          {"n_theta_d", table.n_theta_d()},
          {"n_phi_d", table.n_phi_d()},
          {"phi_d_period_deg", table.phi_d_period() * 180 / pi},
          {"range", {{"red", range[0].json()}, {"green", range[1].json()}, {"blue", range[2].json()}}},
          {"entries", table.size()},
          {"holes", table.hole_count()},
          {"holes_above_horizon", missing_above_horizon(table)},
          {"holes_percent_by_15_degrees_theta_h_theta_d", where},
          {"albedo", albedo}};
}

void print(const MerlTable& table, const nlohmann::json& json) {
  std::cout << fmt::format("  kind        {}, RGB, linear, 1/sr\n", json["kind"].get<std::string>())
            << fmt::format(
                   "  resolution  theta_h {} (square-root spaced), theta_d {}, phi_d {} over {:g} degrees\n",
                   table.n_theta_h(), table.n_theta_d(), table.n_phi_d(), table.phi_d_period() * 180 / pi);
  for (const char* channel : {"red", "green", "blue"})
    if (const auto& r = json["range"][channel]; r.is_null())
      std::cout << fmt::format("  {:<10}  no values\n", channel);
    else
      std::cout << fmt::format("  {:<10}  {:.6g} to {:.6g}, mean {:.6g}\n", channel, r["min"].get<double>(),
                               r["max"].get<double>(), r["mean"].get<double>());
  std::cout << fmt::format("  holes       {} of {} entries ({:.2f} %), {} of them above the horizon\n",
                           table.hole_count(), table.size(), 100.0 * table.hole_count() / table.size(),
                           json["holes_above_horizon"].get<std::size_t>());
  if (table.hole_count() > 0) {
    const HoleMap map(table);
    std::cout << "  holes in percent, by angle in degrees\n  theta_h \\ theta_d";
    for (int d = 0; d < regions; ++d)
      std::cout << fmt::format("{:>4}-{:<2}", 15 * d, 15 * d + 15);
    for (int h = 0; h < regions; ++h) {
      std::cout << fmt::format("\n            {:>2}-{:<2} ", 15 * h, 15 * h + 15);
      for (int d = 0; d < regions; ++d)
        std::cout << (map.entries[h][d] ? fmt::format("{:>6.1f} ", map.share(h, d))
                                        : fmt::format("{:>6} ", "-"));
    }
    std::cout << "\n";
  }
  std::cout << "  albedo      at angle to the normal: red green blue\n";
  for (const auto& a : json["albedo"])
    std::cout << fmt::format("    {:>3g} deg   {:.4f} {:.4f} {:.4f}\n", a["theta_deg"].get<double>(),
                             a["rgb"][0].get<double>(), a["rgb"][1].get<double>(), a["rgb"][2].get<double>());
}

nlohmann::json describe(const Image& image) {
  nlohmann::json channels = nlohmann::json::array();
  for (int c = 0; c < image.channel_count(); ++c) {
    Range range;
    std::size_t not_finite = 0;
    for (std::size_t p = c; p < image.data.size(); p += image.channel_count())
      if (std::isfinite(image.data[p]))
        range.add(image.data[p]);
      else
        ++not_finite;
    channels.push_back({{"name", image.channels[c]}, {"range", range.json()}, {"not_finite", not_finite}});
  }
  return {{"kind", "image (OpenEXR)"},
          {"width", image.width},
          {"height", image.height},
          {"channels", channels},
          {"metadata", image.metadata}};
}

void print(const Image& image, const nlohmann::json& json) {
  std::cout << fmt::format("  kind        image (OpenEXR)\n  size        {} x {}\n", image.width,
                           image.height);
  for (const auto& c : json["channels"]) {
    const auto& r = c["range"];
    std::cout << fmt::format("  channel     {:<12}", c["name"].get<std::string>());
    if (!r.is_null())
      std::cout << fmt::format(" {:.6g} to {:.6g}, mean {:.6g}", r["min"].get<double>(),
                               r["max"].get<double>(), r["mean"].get<double>());
    if (const auto bad = c["not_finite"].get<std::size_t>(); bad > 0)
      std::cout << fmt::format(", {} not finite", bad);
    std::cout << "\n";
  }
  for (const auto& [key, text] : image.metadata)
    std::cout << fmt::format("  {:<11} {}\n", key, text);
}

/// Text of a file may be in any encoding; JSON is UTF-8.
std::string dump(const nlohmann::json& json) {
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

template <class Content>
void report(const std::string& path, const Content& content, bool as_json) {
  nlohmann::json json = describe(content);
  json["file"] = path;
  if (as_json) {
    std::cout << dump(json) << "\n";
  } else {
    std::cout << path << "\n";
    print(content, json);
  }
}

} // namespace

void add_info_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("info", "describe a measured reflectance (.binary) or an image (.exr)");
  auto file = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  command->add_option("FILE", *file, "a .binary or .exr file")->required();
  command->add_flag("--json", *json, "one JSON object on standard output");
  command->footer("Example: nacre info gold.binary --json");
  command->callback([=] {
    std::string extension = std::filesystem::path(*file).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".binary")
      report(*file, *read_merl(*file), *json);
    else if (extension == ".exr")
      report(*file, read_exr(*file), *json);
    else
      throw Error::in_file(*file, "info knows .binary (MERL reflectance) and .exr (images), found '" +
                                      extension + "'");
  });
}

} // namespace nacre

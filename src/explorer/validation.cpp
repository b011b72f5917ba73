// Requests to judge a material by the laws of reflectance.
#include "explorer/desk.h"
#include "report/curves.h"
#include "validate/validate.h"

#include <cmath>
#include <optional>

namespace nacre {
namespace {

using nlohmann::json;

/// Directions of the worst case in degrees, or null where the law is not about one.
json directions_of(const LawResult& law) {
  json where = json::object();
  const auto add = [&](const std::optional<Vec3d>& w, const std::string& side) {
    if (!w) return;
    where["theta_" + side] = std::atan2(std::hypot(w->x, w->y), w->z) * (180 / pi);
    where["phi_" + side] = std::atan2(w->y, w->x) * (180 / pi);
  };
  add(law.wo, "o"), add(law.wi, "i");
  return where.empty() ? json() : where;
}

json laws_json(const ValidationReport& report) {
  json laws = json::array();
  for (const LawResult& law : report.laws)
    laws.push_back({{"name", law.law},
                    {"measures", law.measures},
                    {"verdict", law.verdict == Verdict::holds      ? "holds"
                                : law.verdict == Verdict::violated ? "violated"
                                                                   : "stated"},
                    {"worst", law.worst},
                    {"error", law.error},
                    {"tolerance", law.tolerance},
                    {"where", directions_of(law)},
                    {"where_text", law.where},
                    {"command", law.command}});
  return laws;
}

constexpr int map_size = 46; ///< 0 to 90 degrees in steps of 2
constexpr int map_azimuths = 16;

} // namespace

Answer answer_validate(const Arguments& request, const Desk& desk) {
  const auto material = desk.materials.resolve(request.at("material"), desk.folder);
  ValidateOptions options;
  options.samples = request.whole("samples", 20000, 1000, 10000000);
  Answer answer;
  // The maps take a moment, the laws some seconds: the maps are shown first.
  const auto angle = [](int i) { return std::min(90.0 * i / (map_size - 1), 89.9) * pi / 180; };
  Directions there, back;
  for (int i = 0; i < map_size; ++i)
    for (int o = 0; o < map_size; ++o)
      for (int k = 0; k < map_azimuths; ++k) {
        // From half a step to half a step before the circle's half: no pair stands out by being in one plane.
        const Vec3d wi = spherical_direction(angle(i), 0.0);
        const Vec3d wo = spherical_direction(angle(o), 2 * pi * (k + 0.5) / map_azimuths);
        there.add(wo, wi), back.add(wi, wo);
      }
  const auto f = evaluate(*material, there), g = evaluate(*material, back);
  std::vector<float> reciprocity, energy;
  for (int i = 0, n = 0; i < map_size; ++i)
    for (int o = 0; o < map_size; ++o) {
      double worst = 0, mean = 0;
      for (int k = 0; k < map_azimuths; ++k, ++n) {
        const double a = luminance(f[std::size_t(n)]), b = luminance(g[std::size_t(n)]);
        if (a + b > 0) worst = std::max(worst, std::abs(a - b) / (0.5 * (a + b)));
        mean += a / map_azimuths;
      }
      reciprocity.push_back(float(worst));
      energy.push_back(float(2 * pi * mean * std::cos(angle(o)) * std::sin(angle(o))));
    }
  constexpr std::size_t n = map_size;
  answer.add("reciprocity_map", {n, n}, reciprocity);
  answer.add("energy_map", {n, n}, energy);
  desk.progress(0.1, answer);

  constexpr double most_laws = 16; // few materials are judged by more
  options.stopped = [&] { return desk.is_cancelled(); };
  options.on_laws = [&](const ValidationReport& so_far) {
    Answer told;
    told.header["laws"] = laws_json(so_far);
    desk.progress(0.1 + 0.9 * std::min(double(so_far.laws.size()) / most_laws, 0.95), told);
  };
  ValidationReport report;
  try {
    report = validate(*material, options);
  } catch (const Error&) {
    if (!desk.is_cancelled()) throw;
    return answer; // the page keeps the laws that it was told
  }
  answer.header["holds"] = report.holds();
  answer.header["seconds"] = report.seconds;
  answer.header["laws"] = laws_json(report);
  std::vector<float> theta, albedo;
  for (const AlbedoSample& a : report.albedo) {
    theta.push_back(float(a.theta_deg));
    for (const double v : a.albedo)
      albedo.push_back(float(v));
  }
  const std::size_t angles = theta.size();
  answer.add("albedo", {angles, 3}, std::move(albedo));
  answer.add("albedo_theta", {angles}, std::move(theta));
  return answer;
}

} // namespace nacre

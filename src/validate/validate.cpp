#include "validate/validate.h"

#include "core/error.h"
#include "validate/laws.h"

#include <chrono>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace nacre {

bool ValidationReport::holds() const {
  return std::none_of(laws.begin(), laws.end(),
                      [](const LawResult& l) { return l.verdict == Verdict::violated; });
}

Scattering Scattering::of(const Bsdf<double, 3>& bsdf) {
  return {[bsdf](const Vec3d& wo, const Vec3d& wi) { return bsdf.eval(wo, wi); },
          [bsdf](const Vec3d& wo, const Vec3d& wi) { return bsdf.pdf(wo, wi); },
          [bsdf](const Vec3d& wo, double u_lobe, Vec2<double> u) { return bsdf.sample(wo, u_lobe, u); }};
}

namespace {

/// What evaluation for pictures clamps away: f of a user's shader below 0, or of a measurement. Spectral
/// channels are asked themselves, as a colour outside sRGB is no negative reflectance.
Rgb below_zero(const MeasuredBsdf& measured, const Vec3d& wo, const Vec3d& wi) {
  std::array<float, Channels::max_count> f;
  const Channels& channels = measured.channels();
  const std::span used(f.data(), std::size_t(channels.count()));
  if (!measured.evaluate(wo, wi, used)) return {};
  if (!channels.is_rgb()) return Rgb(std::min(double(*std::min_element(used.begin(), used.end())), 0.0));
  const auto rgb = channels.to_rgb(used);
  return Rgb(std::array{std::min(rgb[0], 0.0), std::min(rgb[1], 0.0), std::min(rgb[2], 0.0)});
}

} // namespace

Scattering Scattering::of(const MaterialSpec& material) {
  const Bsdf<double, 3> clamped = make_bsdf<double>(material);
  Scattering s = of(clamped);
  std::vector<LobeSpec> measured;
  for (const LobeSpec& lobe : material.lobes)
    if (lobe.measured) measured.push_back(lobe);
  if (!measured.empty()) {
    // A negative value shows as 0, or hides below another lobe.
    const auto mended = [measured, alone = clamped.count() == 1](Rgb f, const Vec3d& wo, const Vec3d& wi) {
      if (alone && f[0] > 0 && f[1] > 0 && f[2] > 0) return f;
      for (const LobeSpec& lobe : measured)
        f += below_zero(*lobe.measured, wo, wi) * lobe.weight;
      return f;
    };
    s.eval = [clamped, mended](const Vec3d& wo, const Vec3d& wi) {
      return mended(clamped.eval(wo, wi), wo, wi);
    };
    s.sample = [clamped, mended](const Vec3d& wo, double u_lobe, Vec2<double> u) {
      auto sampled = clamped.sample(wo, u_lobe, u);
      if (sampled.pdf > 0 && !sampled.is_delta) sampled.f = mended(sampled.f, wo, sampled.wi);
      return sampled;
    };
  }
  for (const LobeSpec& lobe : material.lobes) {
    if (lobe.measured) continue;
    const ModelInfo& model = model_info(lobe);
    s.stochastic = s.stochastic || model.laws.stochastic;
    const FacetFunctions& facets = model_facets(lobe.model);
    if (!facets.D) continue;
    const std::vector<double> values = parameter_vector(lobe);
    s.facets.push_back(
        {model.name, [facets, values](const Vec3d& wm) { return facets.D(values.data(), wm); },
         [facets, values](const Vec3d& w, const Vec3d& wm) { return facets.G1(values.data(), w, wm); },
         [facets, values](const Vec3d& wo, const Vec3d& wi) { return facets.G2(values.data(), wo, wi); }});
  }
  return s;
}

Sides Sides::of(const MaterialSpec& material) {
  Sides sides;
  for (const LobeSpec& lobe : material.lobes) {
    double eta = 1; // a measured sheet has air on both sides
    if (lobe.measured) {
      const MeasuredSides measured = lobe.measured->sides();
      if (!measured.transmits() && !measured.reflects_back) continue;
    } else {
      const ModelInfo& model = model_info(lobe);
      if (!model.laws.transmits) continue;
      if (!model.laws.thin) eta = lobe.values[model.parameter_index("eta")][0];
    }
    if (sides.transmits && sides.eta != eta)
      throw Error(material.name + ": lobes with different eta cannot share one interface");
    sides = {true, eta};
  }
  return sides;
}

void check_stopped(const ValidateOptions& options) {
  if (options.stopped && options.stopped()) throw Error("the validation was stopped");
}

ValidationReport validate(const Scattering& bsdf, const std::string& name, const Sides& sides,
                          const ValidateOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  auto pairs = adversarial_pairs();
  const auto random = random_pairs(options.directions, options.seed);
  pairs.insert(pairs.end(), random.begin(), random.end());
  ValidationReport report{.material = name, .laws = {}, .albedo = {}};
  const auto told = [&] {
    check_stopped(options);
    if (options.on_laws) options.on_laws(report);
  };
  report.laws.push_back(finiteness(bsdf, name, pairs));
  told();
  report.laws.push_back(positivity(bsdf, name, pairs));
  told();
  if (bsdf.stochastic) {
    report.laws.push_back(reciprocity_of_estimates(bsdf, name, sides, random_pairs(400, options.seed)));
  } else {
    report.laws.push_back(reciprocity(bsdf, name, sides, pairs));
    told();
    report.laws.push_back(continuity(bsdf, name, options));
  }
  told();
  const std::vector<double> azimuths = judged_azimuths(bsdf, options.seed);
  sampling_laws(bsdf, name, sides, azimuths, options, report);
  told();
  for (const FacetSurface& facets : bsdf.facets)
    for (LawResult& law : facet_laws(facets, bsdf, name, azimuths, options)) {
      if (bsdf.facets.size() > 1) law.law += fmt::format(" ({})", facets.name);
      report.laws.push_back(std::move(law));
      told();
    }
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

ValidationReport validate(const MaterialSpec& material, const ValidateOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const std::string& argument = material.argument.empty() ? material.name : material.argument;
  ValidateOptions named = options; // the report has the material's name, its commands the argument
  if (options.on_laws)
    named.on_laws = [&](const ValidationReport& so_far) {
      ValidationReport told = so_far;
      told.material = material.name;
      options.on_laws(told);
    };
  ValidationReport report = validate(Scattering::of(material), argument, Sides::of(material), named);
  report.material = material.name;
  for (LawResult& law : parameter_laws(material, options))
    report.laws.push_back(std::move(law));
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

namespace {

const char* name_of(Verdict verdict) {
  return verdict == Verdict::holds ? "holds" : verdict == Verdict::stated ? "stated" : "violated";
}

} // namespace

nlohmann::json to_json(const ValidationReport& report) {
  nlohmann::json json{{"material", report.material}, {"holds", report.holds()}, {"seconds", report.seconds}};
  for (const LawResult& law : report.laws) {
    nlohmann::json entry{{"law", law.law},
                         {"measures", law.measures},
                         {"worst", law.worst},
                         {"error", law.error},
                         {"where", law.where},
                         {"command", law.command},
                         {"verdict", name_of(law.verdict)}};
    if (law.verdict != Verdict::stated) entry["tolerance"] = law.tolerance;
    json["laws"].push_back(std::move(entry));
  }
  json["bihemispherical"] = {{"rgb", report.bihemispherical}, {"error", report.bihemispherical_error}};
  for (const AlbedoSample& a : report.albedo)
    json["albedo"].push_back({{"theta_deg", a.theta_deg}, {"rgb", a.albedo}, {"error", a.error}});
  return json;
}

std::string to_text(const ValidationReport& report) {
  std::string text = fmt::format("{}\n", report.material);
  text += fmt::format("  {:<32} {:>12} {:>10}  {:<9} {}\n", "law", "worst", "tolerance", "verdict", "where");
  for (const LawResult& law : report.laws) {
    const bool violated = law.verdict == Verdict::violated, stated = law.verdict == Verdict::stated;
    text += fmt::format("  {:<33} {:>11.4g} {:>10}  {:<9} {}\n", law.law, law.worst,
                        stated ? "" : fmt::format("{:.3g}", law.tolerance),
                        violated ? "VIOLATED" : name_of(law.verdict), law.where);
    if (violated) text += fmt::format("      {}; see: {}\n", law.measures, law.command);
  }
  text += "  directional albedo, red/green/blue:";
  int n = 0;
  for (const AlbedoSample& a : report.albedo)
    text += fmt::format("{}{:>5.4g} deg {:.3f}/{:.3f}/{:.3f}", n++ % 4 == 0 ? "\n  " : "  ", a.theta_deg,
                        a.albedo[0], a.albedo[1], a.albedo[2]);
  const auto& b = report.bihemispherical;
  text += fmt::format(
      "\n  bihemispherical albedo: {:.4f}/{:.4f}/{:.4f} +- {:.1g}", b[0], b[1], b[2],
      *std::max_element(report.bihemispherical_error.begin(), report.bihemispherical_error.end()));
  return text + fmt::format("\n  {} ({:.1f} s)\n",
                            report.holds() ? "All laws hold." : "Some laws are violated.", report.seconds);
}

} // namespace nacre

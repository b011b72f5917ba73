#include "validate/validate.h"

#include "core/error.h"
#include "core/parallel.h"
#include "core/random.h"
#include "core/statistics.h"
#include "core/warp.h"
#include "validate/sphere_partition.h"

#include <chrono>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

using Rgb = Spectrum<double, 3>;

// Double precision leaves a relative error near 1e-13 in f; 1e-6 also forgives tables of floats.
constexpr double reciprocity_tolerance = 1e-6;
constexpr double energy_tolerance = 1e-3;
constexpr double pdf_tolerance = 2e-3;
// Six standard errors: passed by chance less than once in 10^8 estimates.
constexpr double albedo_sigmas = 6;

double degrees(double radians) { return radians * (180 / pi); }
double theta_deg(const Vec3d& w) { return degrees(std::atan2(std::sqrt(sin2_theta(w)), w.z)); }
double phi_deg(const Vec3d& w) { return degrees(std::atan2(w.y, w.x)); }

std::string direction_text(const Vec3d& wo, const Vec3d& wi) {
  return fmt::format("theta_o {:.6g}, theta_i {:.6g}, phi {:.6g}", theta_deg(wo), theta_deg(wi),
                     phi_deg(wi) - phi_deg(wo));
}
std::string eval_command(const std::string& material, const Vec3d& wo, const Vec3d& wi) {
  return fmt::format("nacre eval '{}' --theta-o {:.9g} --theta-i {:.9g} --phi-o {:.9g} --phi-i {:.9g}",
                     material, theta_deg(wo), theta_deg(wi), phi_deg(wo), phi_deg(wi));
}
std::string angle_command(const std::string& material, double theta) {
  return fmt::format("nacre eval '{}' --theta-o {:.9g} --albedo", material, theta);
}

double random(std::uint64_t seed, std::uint64_t index, std::uint64_t dimension) {
  return unit_double(hash(seed, index, dimension));
}

/// Pairs of directions: uniform ones, and ones where formulas break: grazing, normal, mirror, retro, opposite
/// half vectors, below the horizon and in it.
std::vector<std::pair<Vec3d, Vec3d>> direction_pairs(const ValidateOptions& options) {
  std::vector<std::pair<Vec3d, Vec3d>> pairs;
  std::vector<Vec3d> special;
  for (const double z : {1.0, 0.9999999, 0.7, 0.1, 1e-3, 1e-5, 1e-8, 1e-12, 0.0})
    for (const double phi : {0.0, 0.5 * pi, pi, 4.0})
      for (const double side : {1.0, -1.0}) {
        const double s = std::sqrt(1 - z * z);
        special.push_back({s * std::cos(phi), s * std::sin(phi), side * z});
      }
  for (const Vec3d& wo : special) {
    for (const Vec3d& wi : special)
      pairs.push_back({wo, wi});
    pairs.push_back({wo, wo});
    pairs.push_back({wo, -wo});
    pairs.push_back({wo, {-wo.x, -wo.y, wo.z}});
  }
  for (int i = 0; i < options.directions; ++i) {
    const auto u = [&](int d) { return random(options.seed, std::uint64_t(i), std::uint64_t(d)); };
    Vec3d wo = square_to_sphere(Vec2<double>{u(0), u(1)});
    Vec3d wi = square_to_sphere(Vec2<double>{u(2), u(3)});
    if (i % 4 == 1) wo.z *= 1e-2, wo = normalize(wo); // a quarter near the horizon
    if (i % 4 == 2) {                                 // a quarter near the mirror direction
      wi = normalize(Vec3d{-wo.x, -wo.y, wo.z} + 0.05 * wi);
    }
    pairs.push_back({wo, wi});
  }
  return pairs;
}

bool finite(const Rgb& f) { return std::isfinite(f[0]) && std::isfinite(f[1]) && std::isfinite(f[2]); }
double smallest(const Rgb& f) { return std::min({f[0], f[1], f[2]}); }

LawResult finiteness(const Scattering& bsdf, const std::string& name,
                     const std::vector<std::pair<Vec3d, Vec3d>>& pairs) {
  LawResult law{.law = "finiteness", .measures = "evaluations that are not numbers"};
  for (const auto& [wo, wi] : pairs)
    if (!finite(bsdf.eval(wo, wi)) || !std::isfinite(bsdf.pdf(wo, wi))) {
      if (law.worst == 0) law.where = direction_text(wo, wi), law.command = eval_command(name, wo, wi);
      law.worst += 1;
    }
  law.verdict = law.worst > 0 ? Verdict::violated : Verdict::holds;
  return law;
}

LawResult positivity(const Scattering& bsdf, const std::string& name,
                     const std::vector<std::pair<Vec3d, Vec3d>>& pairs) {
  LawResult law{.law = "positivity", .measures = "most negative value, 1/sr"};
  for (const auto& [wo, wi] : pairs) {
    const double low = std::min(smallest(bsdf.eval(wo, wi)), bsdf.pdf(wo, wi));
    if (low < law.worst) {
      law.worst = low;
      law.where = direction_text(wo, wi), law.command = eval_command(name, wo, wi);
    }
  }
  law.verdict = law.worst < 0 ? Verdict::violated : Verdict::holds;
  return law;
}

/// (eta on w_to's side / eta on w_from's side)^2: what radiance gains by refraction from one to the other.
double compression(const Sides& sides, const Vec3d& w_from, const Vec3d& w_to) {
  const double eta2 = sides.eta * sides.eta;
  return (w_to.z < 0 ? eta2 : 1) / (w_from.z < 0 ? eta2 : 1);
}

LawResult reciprocity(const Scattering& bsdf, const std::string& name, const Sides& sides,
                      const std::vector<std::pair<Vec3d, Vec3d>>& pairs) {
  LawResult law{.law = "reciprocity",
                .measures = "|f(o,i) - f(i,o)| / mean, eta^2 in transmission",
                .tolerance = reciprocity_tolerance};
  for (const auto& [wo, wi] : pairs) {
    // f(wo, wi) / eta_o^2 = f(wi, wo) / eta_i^2, Veach 1997, eq. 5.14
    const Rgb a = bsdf.eval(wo, wi) * compression(sides, wo, wi), b = bsdf.eval(wi, wo);
    for (int c = 0; c < 3; ++c) {
      // Values below 1e-6 / sr are no one's to see; they do not count relatively.
      const double difference = std::abs(a[c] - b[c]) / (0.5 * (std::abs(a[c]) + std::abs(b[c])) + 1e-6);
      if (difference > law.worst) {
        law.worst = difference;
        law.where = direction_text(wo, wi), law.command = eval_command(name, wo, wi);
      }
    }
  }
  law.verdict = law.worst > law.tolerance ? Verdict::violated : Verdict::holds;
  return law;
}

/// Everything that is found by sampling and integrating for one direction of view.
struct AngleReport {
  double theta_deg = 0;
  Integral integrals; ///< of the pdf, and f cos per channel: the albedo; delta directions included
  std::array<double, 3> sampled_albedo{}, sampled_error{};
  double inconsistency = 0; ///< largest relative difference of sample's f, pdf from eval and pdf
  double largest_weight = 0, weight_variance = 0;
  double p_value = 1;
};

/// Albedo here is the share of light arriving along wo that leaves again, so f is taken with its arguments
/// exchanged (by reciprocity, times `compression`): only then does refraction conserve it.
AngleReport examine_angle(const Scattering& bsdf, const Sides& sides, const Vec3d& wo,
                          const ValidateOptions& options, std::uint64_t stream) {
  AngleReport report;
  report.theta_deg = theta_deg(wo);
  const std::uint64_t seed = hash(options.seed, stream);
  std::vector<Vec3d> training, counted;
  std::vector<std::pair<Vec3d, Rgb>> deltas; // distinct delta directions and their albedo
  std::array<RunningMoments, 3> albedo;
  RunningMoments weight;
  int failed = 0, delta_samples = 0;
  double delta_probability = 0;
  for (int i = 0; i < options.samples; ++i) {
    const auto u = [&](int d) { return random(seed, std::uint64_t(i), std::uint64_t(d)); };
    const auto s = bsdf.sample(wo, u(0), {u(1), u(2)});
    const bool count_it = i % 2 == 1; // the other half learns the cells
    Rgb w;
    if (s.pdf > 0) {
      const double cosine = std::abs(s.wi.z) * compression(sides, wo, s.wi);
      w = s.f * (cosine / s.pdf);
      if (s.is_delta) {
        delta_samples += count_it;
        const bool known = std::any_of(deltas.begin(), deltas.end(),
                                       [&](const auto& d) { return dot(d.first, s.wi) > 1 - 1e-9; });
        if (!known) {
          deltas.push_back({s.wi, s.f * cosine});
          delta_probability += s.pdf;
        }
      } else {
        (count_it ? counted : training).push_back(s.wi);
        const Rgb f = bsdf.eval(wo, s.wi);
        const double p = bsdf.pdf(wo, s.wi);
        report.inconsistency = std::max(report.inconsistency, std::abs(p - s.pdf) / s.pdf);
        for (int c = 0; c < 3; ++c)
          report.inconsistency =
              std::max(report.inconsistency, std::abs(f[c] - s.f[c]) / (std::abs(f[c]) + 1e-9));
      }
    } else {
      failed += count_it;
    }
    for (int c = 0; c < 3; ++c)
      albedo[std::size_t(c)].add(w[c]);
    weight.add(average(w));
    report.largest_weight = std::max(report.largest_weight, max_component(w));
  }
  report.weight_variance = weight.variance();
  const double n = double(options.samples);
  for (std::size_t c = 0; c < 3; ++c) {
    report.sampled_albedo[c] = albedo[c].mean();
    report.sampled_error[c] = std::sqrt(albedo[c].variance() / n);
  }

  const SpherePartition partition(std::move(training), 7);
  const double count = double(counted.size() + std::size_t(failed + delta_samples));
  std::vector<double> observed(std::size_t(partition.group_count())), expected(observed.size());
  for (const Vec3d& w : counted)
    observed[std::size_t(partition.find(w).group)] += 1;
  const auto pdf_and_reflected = [&](const Vec3d& wi) {
    const Rgb f = bsdf.eval(wo, wi) * (std::abs(wi.z) * compression(sides, wo, wi));
    return Values{bsdf.pdf(wo, wi), f[0], f[1], f[2]};
  };
  for (const DirectionCell& cell : partition.cells()) {
    const Integral part = SpherePartition::integrate(cell, pdf_and_reflected, 1e-6);
    // A sliver that the rule missed must not make an observation there impossible.
    expected[std::size_t(cell.group)] += (part.value[0] + 1e-9) * count;
    for (std::size_t k = 0; k < part.value.size(); ++k) {
      report.integrals.value[k] += part.value[k];
      report.integrals.error[k] += part.error[k];
    }
  }
  for (const auto& [direction, reflected] : deltas)
    for (std::size_t c = 0; c < 3; ++c)
      report.integrals.value[1 + c] += reflected[int(c)];
  observed.push_back(double(delta_samples));
  expected.push_back(delta_probability * count);
  report.integrals.value[0] += delta_probability;
  // What the pdf does not cover, sample must reject: the nearest count that the quadrature allows.
  const double uncovered = 1 - report.integrals.value[0], error = report.integrals.error[0];
  observed.push_back(failed);
  expected.push_back(clamp(double(failed), std::max(0.0, uncovered - error) * count,
                           std::max(1e-5, uncovered + error) * count));
  report.p_value = chi_square_test(observed, expected).p;

  return report;
}

struct AngleLaws {
  std::vector<LawResult> laws;
  std::vector<AlbedoSample> albedo;
};

AngleLaws sampling_laws(const Scattering& bsdf, const std::string& name, const Sides& sides,
                        const ValidateOptions& options) {
  std::vector<Vec3d> views;
  for (const double theta : {0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0, 89.0}) {
    views.push_back(spherical_direction(theta * pi / 180, 0.4));
    if (sides.transmits) views.push_back(spherical_direction((180 - theta) * pi / 180, 0.4));
  }
  std::vector<AngleReport> reports(views.size());
  parallel_for(views.size(), [&](std::size_t i) {
    reports[i] = examine_angle(bsdf, sides, views[i], options, std::uint64_t(i));
  });

  LawResult energy{.law = "energy conservation",
                   .measures = "largest directional albedo - 1",
                   .worst = -1,
                   .tolerance = energy_tolerance};
  LawResult normal{
      .law = "pdf normalisation", .measures = "integral of the pdf - 1", .tolerance = pdf_tolerance};
  LawResult consistent{
      .law = "sample agrees with eval and pdf", .measures = "largest relative difference", .tolerance = 1e-6};
  LawResult unbiased{.law = "albedo by sampling",
                     .measures = "|sampled - quadrature| in standard errors",
                     .tolerance = albedo_sigmas};
  LawResult chi{.law = "chi-square of directions",
                .measures = "smallest p-value",
                .worst = 1,
                .tolerance = sidak_significance(options.significance, int(views.size()))};
  LawResult bounded{.law = "bounded weights",
                    .measures = "largest f cos / pdf",
                    .tolerance = std::numeric_limits<double>::infinity()};
  AngleLaws result;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const AngleReport& r = reports[i];
    const std::string where = fmt::format("theta_o {:.6g}", r.theta_deg);
    const std::string command = angle_command(name, r.theta_deg);
    const auto worse = [&](LawResult& law, double x, double error) {
      if (!(law.law == chi.law ? x < law.worst : x > law.worst)) return;
      law.worst = x, law.error = error, law.where = where, law.command = command;
    };
    AlbedoSample albedo{r.theta_deg, {}, 0};
    for (std::size_t c = 0; c < 3; ++c) {
      const double reflected = r.integrals.value[1 + c], error = r.integrals.error[1 + c];
      albedo.albedo[c] = reflected;
      albedo.error = std::max(albedo.error, error);
      worse(energy, reflected - 1, error);
      const double sigma = std::hypot(r.sampled_error[c], error / albedo_sigmas, 1e-4);
      worse(unbiased, std::abs(r.sampled_albedo[c] - reflected) / sigma, 1);
    }
    worse(normal, std::max(r.integrals.value[0] - 1, 0.0), r.integrals.error[0]);
    worse(consistent, r.inconsistency, 0);
    worse(chi, r.p_value, 0);
    worse(bounded, r.largest_weight, 0);
    if (views[i].z > 0) result.albedo.push_back(albedo);
  }
  if (energy.worst - energy.error > energy.tolerance) energy.verdict = Verdict::violated;
  if (normal.worst - normal.error > normal.tolerance) normal.verdict = Verdict::violated;
  if (!(consistent.worst <= consistent.tolerance)) consistent.verdict = Verdict::violated;
  if (!(unbiased.worst <= unbiased.tolerance)) unbiased.verdict = Verdict::violated;
  if (chi.worst < chi.tolerance) chi.verdict = Verdict::violated;
  if (!std::isfinite(bounded.worst)) bounded.verdict = Verdict::violated;
  result.laws = {energy, normal, consistent, unbiased, chi, bounded};
  return result;
}

} // namespace

bool ValidationReport::holds() const {
  return std::all_of(laws.begin(), laws.end(),
                     [](const LawResult& l) { return l.verdict == Verdict::holds; });
}

Scattering Scattering::of(const Bsdf<double, 3>& bsdf) {
  return {[bsdf](const Vec3d& wo, const Vec3d& wi) { return bsdf.eval(wo, wi); },
          [bsdf](const Vec3d& wo, const Vec3d& wi) { return bsdf.pdf(wo, wi); },
          [bsdf](const Vec3d& wo, double u_lobe, Vec2<double> u) { return bsdf.sample(wo, u_lobe, u); }};
}

ValidationReport validate(const Scattering& bsdf, const std::string& name, const Sides& sides,
                          const ValidateOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const auto pairs = direction_pairs(options);
  ValidationReport report{.material = name, .laws = {}, .albedo = {}};
  report.laws.push_back(finiteness(bsdf, name, pairs));
  report.laws.push_back(positivity(bsdf, name, pairs));
  report.laws.push_back(reciprocity(bsdf, name, sides, pairs));
  AngleLaws by_angle = sampling_laws(bsdf, name, sides, options);
  for (LawResult& law : by_angle.laws)
    report.laws.push_back(std::move(law));
  report.albedo = std::move(by_angle.albedo);
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

ValidationReport validate(const MaterialSpec& material, const ValidateOptions& options) {
  Sides sides;
  for (const LobeSpec& lobe : material.lobes) {
    if (lobe.table) continue;
    const ModelInfo& model = model_infos()[std::size_t(lobe.model)];
    if (!model.laws.transmits) continue;
    if (model.laws.thin) {
      sides.transmits = true;
      continue;
    }
    for (std::size_t i = 0; i < model.parameters.size(); ++i)
      if (model.parameters[i].name == "eta") {
        if (sides.transmits && sides.eta != lobe.values[i][0])
          throw Error(material.name + ": lobes with different eta cannot share one interface");
        sides = {true, lobe.values[i][0]};
      }
  }
  return validate(Scattering::of(make_bsdf<double>(material)), material.name, sides, options);
}

nlohmann::json to_json(const ValidationReport& report) {
  nlohmann::json json{{"material", report.material}, {"holds", report.holds()}, {"seconds", report.seconds}};
  for (const LawResult& law : report.laws) {
    nlohmann::json entry{{"law", law.law},
                         {"measures", law.measures},
                         {"worst", law.worst},
                         {"error", law.error},
                         {"where", law.where},
                         {"command", law.command},
                         {"verdict", law.verdict == Verdict::holds ? "holds" : "violated"}};
    if (std::isfinite(law.tolerance)) entry["tolerance"] = law.tolerance;
    json["laws"].push_back(std::move(entry));
  }
  for (const AlbedoSample& a : report.albedo)
    json["albedo"].push_back({{"theta_deg", a.theta_deg}, {"rgb", a.albedo}, {"error", a.error}});
  return json;
}

std::string to_text(const ValidationReport& report) {
  std::string text = fmt::format("{}\n", report.material);
  text += fmt::format("  {:<32} {:>12} {:>10}  {:<9} {}\n", "law", "worst", "tolerance", "verdict", "where");
  for (const LawResult& law : report.laws) {
    const bool holds = law.verdict == Verdict::holds;
    text += fmt::format("  {:<32} {:>12.4g} {:>10.3g}  {:<9} {}\n", law.law, law.worst, law.tolerance,
                        holds ? "holds" : "VIOLATED", law.where);
    if (!holds) text += fmt::format("      {}; see: {}\n", law.measures, law.command);
  }
  text += "  directional albedo:";
  for (const AlbedoSample& a : report.albedo)
    text +=
        fmt::format("  {:.0f} deg {:.3f}/{:.3f}/{:.3f}", a.theta_deg, a.albedo[0], a.albedo[1], a.albedo[2]);
  return text + fmt::format("\n  {} ({:.1f} s)\n",
                            report.holds() ? "All laws hold." : "Some laws are violated.", report.seconds);
}

} // namespace nacre

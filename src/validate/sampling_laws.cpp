// Laws of energy and of sampling, angle by angle.
#include "core/parallel.h"
#include "core/random.h"
#include "core/statistics.h"
#include "core/warp.h"
#include "validate/laws.h"
#include "validate/sphere_partition.h"

#include <limits>

namespace nacre {
namespace {

constexpr double energy_tolerance = 1e-3;
constexpr double pdf_tolerance = 2e-3;
// Six standard errors: passed by chance less than once in 10^8 estimates.
constexpr double albedo_sigmas = 6;

/// Everything that is found by sampling and integrating for one direction of view.
struct AngleReport {
  Integral integrals; ///< of the pdf, and f cos per channel: the albedo; delta directions included
  std::array<double, 3> sampled_albedo{}, sampled_error{};
  double inconsistency = 0; ///< largest relative difference of sample's f, pdf from eval and pdf
  double largest_weight = 0, weight_variance = 0;
  double missed = 0;  ///< of the pdf, by the quadrature
  double p_value = 1; ///< of the directions against the pdf, or of an estimate's light against eval
};

/// Sums of weights that fell into each group of a partition.
struct GroupedWeights {
  std::vector<double> sum, squares;
  explicit GroupedWeights(int groups) : sum(std::size_t(groups)), squares(std::size_t(groups)) {}
  void add(int group, double w) {
    sum[std::size_t(group)] += w;
    squares[std::size_t(group)] += w * w;
  }
};

/// Albedo here is the share of light arriving along wo that leaves again, so f is taken with its arguments
/// exchanged (by reciprocity, times `compression`): only then does refraction conserve it.
AngleReport examine_angle(const Scattering& bsdf, const Sides& sides, const Vec3d& wo,
                          const ValidateOptions& options, std::uint64_t stream) {
  AngleReport report;
  const std::uint64_t seed = hash(options.seed, stream);
  std::vector<Vec3d> training, counted;
  std::vector<std::pair<Vec3d, double>> carried; // by an estimate's samples: direction and weight
  std::vector<std::pair<Vec3d, Rgb>> deltas;     // distinct delta directions and their albedo
  std::array<RunningMoments, 3> albedo;
  RunningMoments weight;
  int failed = 0, delta_samples = 0;
  double delta_probability = 0;
  for (int i = 0; i < options.samples; ++i) {
    if (i % 256 == 0) check_stopped(options);
    const auto u = [&](int d) { return random_unit(seed, std::uint64_t(i), std::uint64_t(d)); };
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
        const double p = bsdf.pdf(wo, s.wi);
        report.inconsistency = std::max(report.inconsistency, std::abs(p - s.pdf) / s.pdf);
        if (bsdf.stochastic && count_it) carried.push_back({s.wi, average(w)});
        const Rgb f = bsdf.stochastic ? s.f : bsdf.eval(wo, s.wi);
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
  const auto pdf_alone = [&](const Vec3d& wi) { return Values{bsdf.pdf(wo, wi), 0, 0, 0}; };
  const auto reflected_alone = [&](const Vec3d& wi) {
    const Rgb f = bsdf.eval(wo, wi) * (std::abs(wi.z) * compression(sides, wo, wi));
    return Values{0, f[0], f[1], f[2]};
  };
  // Each with its own refinement: a density that is a table has steps everywhere, at which there is no need
  // to ask a shader for its smooth values.
  const auto apart = [&](const DirectionCell& cell) {
    Integral both = SpherePartition::integrate(cell, reflected_alone, 1e-6);
    const Integral density = SpherePartition::integrate(cell, pdf_alone, 1e-6, 1);
    both.value[0] = density.value[0], both.error[0] = density.error[0];
    return both;
  };
  // Where eval is an estimate the pdf, its near likeness, steers the quadrature. The rule and its refinement,
  // of four times the points, then differ by noise: the square of that is five times the finer one's
  // variance.
  std::vector<double> group_value(expected.size()), group_variance(expected.size());
  Values variance{};
  for (const DirectionCell& cell : partition.cells()) {
    check_stopped(options);
    const Integral part =
        bsdf.stochastic ? SpherePartition::integrate(cell, pdf_and_reflected, 1e-5, 1) : apart(cell);
    const auto group = std::size_t(cell.group);
    group_value[group] += (part.value[1] + part.value[2] + part.value[3]) / 3;
    for (std::size_t k = 1; k < 4; ++k) {
      variance[k] += sqr(part.error[k]) / 5;
      group_variance[group] += sqr(part.error[k]) / (5 * 3); // the noise of the channels is one
    }
    // A sliver that the rule missed must not make an observation there impossible.
    expected[std::size_t(cell.group)] += (part.value[0] + 1e-9) * count;
    for (std::size_t k = 0; k < part.value.size(); ++k) {
      report.integrals.value[k] += part.value[k];
      report.integrals.error[k] += part.error[k];
    }
  }
  if (bsdf.stochastic) {
    for (std::size_t k = 1; k < 4; ++k)
      report.integrals.error[k] = albedo_sigmas * std::sqrt(variance[k]);
    // Eight groups together: enough samples that the noise's long tail averages out.
    const auto joined = [](const std::vector<double>& groups_of_cells) {
      std::vector<double> sums((groups_of_cells.size() + 7) / 8);
      for (std::size_t g = 0; g < groups_of_cells.size(); ++g)
        sums[g / 8] += groups_of_cells[g];
      return sums;
    };
    group_value = joined(group_value), group_variance = joined(group_variance);
    GroupedWeights sampled(int(group_value.size()));
    for (const auto& [wi, w] : carried)
      sampled.add(partition.find(wi).group / 8, w);
    double statistic = 0;
    int groups = 0;
    for (std::size_t g = 0; g < group_value.size(); ++g) {
      const double mean = sampled.sum[g] / count;
      // 2 % is forgiven: noise with a long tail hides from so few samples.
      const double spread =
          (sampled.squares[g] / count - mean * mean) / count + group_variance[g] + sqr(0.02 * group_value[g]);
      // Few samples make no normal distribution; what they carry is in the albedo.
      if (!(sampled.squares[g] > 0) || sqr(sampled.sum[g]) < 100 * sampled.squares[g]) continue;
      statistic += sqr(mean - group_value[g]) / spread;
      ++groups;
    }
    report.p_value = groups > 0 ? chi_square_survival(statistic, groups) : 1;
  }
  for (const auto& [direction, reflected] : deltas)
    for (std::size_t c = 0; c < 3; ++c)
      report.integrals.value[1 + c] += reflected[int(c)];
  observed.push_back(double(delta_samples));
  expected.push_back(delta_probability * count);
  report.integrals.value[0] += delta_probability;
  // What the pdf does not cover, sample must reject: the nearest count that the quadrature allows.
  const double uncovered = 1 - report.integrals.value[0], error = report.integrals.error[0];
  // No more than a thousandth is forgiven: a pdf that is wrong must not excuse f.
  report.missed = clamp(uncovered - failed / count, 0.0, 1e-3);
  observed.push_back(failed);
  expected.push_back(clamp(double(failed), std::max(0.0, uncovered - error) * count,
                           std::max(1e-5, uncovered + error) * count));
  // No chance explains a density that is negative or no number.
  const bool counts =
      std::all_of(expected.begin(), expected.end(), [](double e) { return e >= 0 && std::isfinite(e); });
  if (!bsdf.stochastic) report.p_value = counts ? chi_square_test(observed, expected).p : 0;
  return report;
}

/// Mean weight of samples under uniform diffuse light from above.
void bihemispherical(const Scattering& bsdf, const Sides& sides, const ValidateOptions& options,
                     ValidationReport& report) {
  std::array<RunningMoments, 3> albedo;
  const std::uint64_t seed = hash(options.seed, std::uint64_t(1) << 40);
  for (int i = 0; i < options.samples; ++i) {
    const auto u = [&](int d) { return random_unit(seed, std::uint64_t(i), std::uint64_t(d)); };
    const Vec3d wo = square_to_cosine_hemisphere(Vec2<double>{u(3), u(4)});
    const auto s = bsdf.sample(wo, u(0), {u(1), u(2)});
    for (int c = 0; c < 3; ++c)
      albedo[std::size_t(c)].add(s.pdf > 0 ? s.f[c] * std::abs(s.wi.z) * compression(sides, wo, s.wi) / s.pdf
                                           : 0);
  }
  for (std::size_t c = 0; c < 3; ++c) {
    report.bihemispherical[c] = albedo[c].mean();
    report.bihemispherical_error[c] = albedo[c].standard_error();
  }
}

} // namespace

void sampling_laws(const Scattering& bsdf, const std::string& name, const Sides& sides,
                   const std::vector<double>& azimuths, const ValidateOptions& options,
                   ValidationReport& report) {
  std::vector<Vec3d> views;
  std::size_t first_azimuth = 0; // that many views
  for (const double phi : azimuths) {
    for (const double theta : {0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0, 89.0, 89.9}) {
      // The normal has no azimuth, and few angles show what another azimuth changes: one of each where a
      // value is an estimate, which takes long.
      const bool shows = bsdf.stochastic ? theta == 75 && phi == azimuths[3]
                                         : theta == 45 || theta == 75 || theta == 85 || theta == 89.9;
      if (phi != azimuths[0] && !shows) continue;
      views.push_back(spherical_direction(theta * pi / 180, phi));
      if (sides.transmits) views.push_back(spherical_direction((180 - theta) * pi / 180, phi));
    }
    if (first_azimuth == 0) first_azimuth = views.size();
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
  LawResult chi{.law = bsdf.stochastic ? "chi-square of sampled light" : "chi-square of directions",
                .measures = "smallest p-value",
                .worst = 1,
                .tolerance = sidak_significance(options.significance, int(views.size()))};
  LawResult bounded{.law = "bounded weights",
                    .measures = "largest f cos / pdf",
                    .tolerance = std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < views.size(); ++i) {
    const AngleReport& r = reports[i];
    const auto worse = [&](LawResult& law, double x, double error) {
      // What is not a number is worse than any.
      if (std::isnan(law.worst) || (law.law == chi.law ? x >= law.worst : x <= law.worst)) return;
      law.worst = x, law.error = error;
      point_at(law, name, views[i], azimuths);
    };
    AlbedoSample albedo{theta_deg(views[i]), {}, 0};
    for (std::size_t c = 0; c < 3; ++c) {
      const double reflected = r.integrals.value[1 + c], error = r.integrals.error[1 + c];
      albedo.albedo[c] = reflected;
      albedo.error = std::max(albedo.error, error);
      worse(energy, reflected - 1, error);
      // What the quadrature missed of the pdf it may have missed of f.
      const double sigma = std::hypot(r.sampled_error[c], error / albedo_sigmas, std::max(1e-4, r.missed));
      worse(unbiased, std::abs(r.sampled_albedo[c] - reflected) / sigma, 1);
    }
    worse(normal, std::max(r.integrals.value[0] - 1, 0.0), r.integrals.error[0]);
    worse(consistent, r.inconsistency, 0);
    worse(chi, r.p_value, 0);
    worse(bounded, r.largest_weight, 0);
    if (i < first_azimuth && views[i].z > 0) report.albedo.push_back(albedo);
  }
  if (!(energy.worst - energy.error <= energy.tolerance)) energy.verdict = Verdict::violated;
  if (!(normal.worst - normal.error <= normal.tolerance)) normal.verdict = Verdict::violated;
  if (!(consistent.worst <= consistent.tolerance)) consistent.verdict = Verdict::violated;
  if (!(unbiased.worst <= unbiased.tolerance)) unbiased.verdict = Verdict::violated;
  if (!(chi.worst >= chi.tolerance)) chi.verdict = Verdict::violated;
  bounded.verdict = std::isfinite(bounded.worst) ? Verdict::stated : Verdict::violated;
  for (const LawResult& law : {energy, normal, consistent, unbiased, chi, bounded})
    report.laws.push_back(law);
  bihemispherical(bsdf, sides, options, report);
}

} // namespace nacre

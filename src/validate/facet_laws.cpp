// Laws of the microsurface that a model is made of. Source: Heitz 2014, Understanding the Masking-Shadowing
// Function in Microfacet-Based BRDFs, JCGT 3(2).
#include "validate/laws.h"
#include "validate/sphere_partition.h"

#include <fmt/format.h>

namespace nacre {
namespace {

constexpr double facet_tolerance = 2e-3;

/// Normals as the model meets them, thinned to the density of visible facets: other lobes would leave strays
/// beside a sharp one, whose edge the quadrature then misses. A viewer above sees no facet steeper than 45
/// degrees mirror light upwards, one near the horizon does: viewers all around, so that a ridge of normals
/// across the grain is met wherever it lies.
std::vector<Vec3d> training_normals(const FacetSurface& facets, const Scattering& bsdf,
                                    const ValidateOptions& options) {
  std::vector<Vec3d> views{{0, 0, 1}};
  for (int azimuth = 0; azimuth < 8; ++azimuth)
    for (const double theta : {50.0, 85.0})
      views.push_back(spherical_direction(theta * pi / 180, azimuth * 0.25 * pi));
  std::vector<Vec3d> normals;
  const int n = std::min(options.samples, 20000);
  for (int i = 0; i < 10 * n && int(normals.size()) < n; ++i) { // glass mirrors one sample in 25

    const auto u = [&](int d) { return random_unit(options.seed + 5, std::uint64_t(i), std::uint64_t(d)); };
    // Half of them from above, where all facets count by their area.
    const Vec3d& wo = i % 2 == 0 ? views[0] : views[1 + std::size_t(i / 2) % (views.size() - 1)];
    const auto s = bsdf.sample(wo, u(0), {u(1), u(2)});
    if (!(s.pdf > 0) || s.is_delta || !(s.wi.z > 0)) continue;
    const Vec3d wm = normalize(wo + s.wi);
    const double visible = facets.G1(wo, wm) * facets.D(wm) / (4 * wo.z); // as a density of wi
    if (u(3) * s.pdf < visible) normals.push_back(wm);
  }
  return normals;
}

Integral integrate_sphere(std::vector<Vec3d> training, const std::function<double(const Vec3d&)>& f) {
  const SpherePartition partition(std::move(training), 7);
  Integral total;
  for (const DirectionCell& cell : partition.cells()) {
    const Integral part = SpherePartition::integrate(
        cell,
        [&](const Vec3d& w) {
          return Values{f(w), 0, 0, 0};
        },
        1e-6);
    total.value[0] += part.value[0];
    total.error[0] += part.error[0];
  }
  return total;
}

} // namespace

std::vector<LawResult> facet_laws(const FacetSurface& facets, const Scattering& bsdf, const std::string& name,
                                  const ValidateOptions& options) {
  LawResult normalisation{
      .law = "normalisation of D", .measures = "|integral of D cos_m - 1|", .tolerance = facet_tolerance};
  LawResult projected{.law = "projected area of visible facets",
                      .measures = "|integral of G1 <wo,wm> D / cos_o - 1|",
                      .tolerance = facet_tolerance};
  LawResult furnace{.law = "weak white furnace",
                    .measures = "|integral of G1 D / (4 cos_o) over wi - 1|",
                    .tolerance = facet_tolerance};
  LawResult lost{.law = "energy lost to single bounces",
                 .measures = "1 - albedo of its facets if they were white",
                 .verdict = Verdict::stated};
  const auto judge = [&](LawResult& law, double value, double error, const std::string& where, double theta) {
    if (!(std::abs(value) > law.worst)) return;
    // The quadrature states the size of its error, no bound.
    law.worst = std::abs(value), law.error = 2 * error, law.where = where;
    law.command = angle_command(name, theta);
  };
  const std::vector<Vec3d> normals = training_normals(facets, bsdf, options);
  if (normals.empty()) return {}; // equal indices: what does not show cannot be wrong
  const Integral unit =
      integrate_sphere(normals, [&](const Vec3d& wm) { return wm.z > 0 ? facets.D(wm) * wm.z : 0; });
  judge(normalisation, unit.value[0] - 1, unit.error[0], "over all normals", 0);
  for (const double theta : {0.0, 30.0, 60.0, 80.0, 89.0}) {
    const Vec3d wo = spherical_direction(theta * pi / 180, 0.4);
    const std::string where = fmt::format("theta_o {:.6g}", theta);
    const Integral area = integrate_sphere(normals, [&](const Vec3d& wm) {
      return wm.z > 0 && dot(wo, wm) > 0 ? facets.G1(wo, wm) * dot(wo, wm) * facets.D(wm) / wo.z : 0;
    });
    judge(projected, area.value[0] - 1, area.error[0], where, theta);
    // Light leaves single facets into the whole sphere, also downwards.
    std::vector<Vec3d> mirrored;
    for (const Vec3d& wm : normals)
      if (dot(wo, wm) > 0) mirrored.push_back(reflect(wo, wm));
    const Integral white = integrate_sphere(mirrored, [&](const Vec3d& wi) {
      const Vec3d sum = wo + wi;
      if (!(sum.z > 0) || length_squared(sum) < 1e-24) return 0.0;
      const Vec3d wm = normalize(sum);
      return facets.G1(wo, wm) * facets.D(wm) / (4 * wo.z);
    });
    judge(furnace, white.value[0] - 1, white.error[0], where, theta);
    const Integral kept = integrate_sphere(std::move(mirrored), [&](const Vec3d& wi) {
      if (!(wi.z > 0)) return 0.0;
      return facets.G2(wo, wi) * facets.D(normalize(wo + wi)) / (4 * wo.z);
    });
    judge(lost, 1 - kept.value[0], kept.error[0], where, theta);
  }
  for (LawResult* law : {&normalisation, &projected, &furnace})
    if (!(law->worst - law->error <= law->tolerance)) law->verdict = Verdict::violated;
  return {normalisation, projected, furnace, lost};
}

} // namespace nacre

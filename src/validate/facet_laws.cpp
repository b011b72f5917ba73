// Laws of the microsurface that a model is made of. Source: Heitz 2014, Understanding the Masking-Shadowing
// Function in Microfacet-Based BRDFs, JCGT 3(2).
#include "core/parallel.h"
#include "core/quadrature.h"
#include "validate/laws.h"
#include "validate/sphere_partition.h"

#include <algorithm>

namespace nacre {
namespace {

constexpr double facet_tolerance = 2e-3;

/// Normals as the model samples them, thinned to the density of visible facets: other lobes would leave
/// strays beside a sharp one, whose edge the quadrature then misses. A viewer above sees no facet steeper
/// than 45 degrees mirror light upwards, one near the horizon does: viewers all around, so that a ridge of
/// normals across the grain is met wherever it lies.
std::vector<Vec3d> training_normals(const FacetSurface& facets, const Scattering& bsdf,
                                    const ValidateOptions& options) {
  std::vector<Vec3d> views{{0, 0, 1}};
  for (int azimuth = 0; azimuth < 8; ++azimuth)
    for (const double theta : {50.0, 85.0})
      views.push_back(spherical_direction(theta * pi / 180, azimuth * 0.25 * pi));
  std::vector<Vec3d> normals;
  const int n = std::min(options.samples, 2000);
  for (int i = 0; i < 30 * n && int(normals.size()) < n; ++i) { // glass mirrors one sample in 25
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

/// Median slopes along the tangent and the bitangent: as units of slope they make brushed facets look as if
/// they were the same all around.
struct SlopeUnits {
  double x, y;

  explicit SlopeUnits(const std::vector<Vec3d>& normals) {
    std::vector<double> along, across;
    for (const Vec3d& wm : normals) {
      along.push_back(std::abs(wm.x / wm.z));
      across.push_back(std::abs(wm.y / wm.z));
    }
    const auto median = [](std::vector<double>& slopes) {
      const auto middle = slopes.begin() + std::ptrdiff_t(slopes.size() / 2);
      std::nth_element(slopes.begin(), middle, slopes.end());
      return std::clamp(*middle, 1e-6, 1e3);
    };
    x = median(along), y = median(across);
  }
};

/// Coordinates of the normals whose facets show a viewer their front: the logarithm of the slope, in which a
/// tail of any length is smooth, and the azimuth, from edge to edge of what is seen of the facets of that
/// slope.
class SeenNormals {
public:
  SeenNormals(const SlopeUnits& units, const Vec3d& wo)
      : units_(units), across_(std::hypot(units.x * wo.x, units.y * wo.y)), up_(wo.z),
        azimuth_(across_ > 0 ? std::atan2(units.y * wo.y, units.x * wo.x) : 0),
        // Flatter ones are a point of no weight; beyond the other end formulas leave the range of floats.
        flattest_(std::log(1e-7)), steepest_(std::log(9e4 / std::max(units.x, units.y))),
        partly_seen_(std::clamp(std::log(wo.z / std::max(across_, 1e-300)), flattest_ + 1, steepest_ - 1)) {}

  double flattest() const { return flattest_; }
  double steepest() const { return steepest_; }
  /// The log slope from which on only a part of a circle is seen: that begins like a square root.
  double partly_seen() const { return partly_seen_; }

  struct Normal {
    Vec3d wm;
    double solid_angle; ///< of a unit of both coordinates
  };
  /// @param turn  in [-1, 1]
  Normal at(double log_slope, double turn) const {
    const double r = std::exp(log_slope);
    const double edge = across_ * r > up_ ? std::acos(-up_ / (across_ * r)) : pi;
    const double phi = azimuth_ + edge * turn;
    const double x = units_.x * r * std::cos(phi), y = units_.y * r * std::sin(phi);
    const double cos_m = 1 / std::sqrt(1 + x * x + y * y);
    return {{x * cos_m, y * cos_m, cos_m}, units_.x * units_.y * r * r * cos_m * cos_m * cos_m * edge};
  }

private:
  SlopeUnits units_;
  double across_, up_, azimuth_, flattest_, steepest_, partly_seen_;
};

/// What is integrated over the solid angle of normals: two values.
using FacetFunction = std::function<std::array<double, 2>(const Vec3d& wm)>;
struct FacetIntegral {
  std::array<double, 2> value{}, error{};
};

/// What the first value would add up to beyond the steepest slope, if it went on as over the last two
/// decades.
double tail(const SeenNormals& seen, const FacetFunction& f) {
  const QuadratureRule around = composite_gauss_legendre(8, 16, -1, 1);
  const auto ring = [&](double log_slope) {
    return integrate(around, [&](double turn) {
      const auto n = seen.at(log_slope, turn);
      return f(n.wm)[0] * n.solid_angle;
    });
  };
  const double last = ring(seen.steepest());
  if (!(last > 1e-9)) return 0;
  // One that hardly falls is taken to fall all the same, else nothing could be judged.
  const double decline = std::log(ring(seen.steepest() - std::log(100.0)) / last) / std::log(100.0);
  return last / std::max(decline, 0.01);
}

FacetIntegral integrate_seen(const SlopeUnits& units, const Vec3d& wo, const FacetFunction& f) {
  constexpr double tolerance = 2e-6; // in each of some two hundred cells
  const SeenNormals seen(units, wo);
  const double middle = seen.partly_seen();
  const double flat = middle - seen.flattest(), steep = seen.steepest() - middle;
  // Rectangles in (z, phi) of a sphere: z below 0 for what is seen all around, its square above.
  const auto at = [&](const Vec3d& w) {
    const double ds = w.z < 0 ? flat : 2 * w.z * steep;
    const auto n = seen.at(middle + (w.z < 0 ? w.z * flat : w.z * w.z * steep), std::atan2(w.y, w.x) / pi);
    const auto x = f(n.wm);
    return Values{x[0] * n.solid_angle * ds / pi, x[1] * n.solid_angle * ds / pi, 0, 0};
  };
  const double beyond = tail(seen, f);
  FacetIntegral total{{beyond, beyond}, {beyond, beyond}}; // the tail may as well end
  const int below = int(std::ceil(flat)), above = int(std::ceil(steep));
  constexpr int around = 6;
  for (int i = -below; i < above; ++i)
    for (int k = 0; k < around; ++k) {
      const double count = i < 0 ? below : above;
      const Integral part = SpherePartition::integrate(
          {i / count, (i + 1) / count, 2 * pi * k / around, 2 * pi * (k + 1) / around}, at, tolerance, 2);
      for (std::size_t v = 0; v < 2; ++v) {
        total.value[v] += part.value[v];
        total.error[v] += 2 * part.error[v]; // the quadrature states the size of its error, no bound
      }
    }
  return total;
}

} // namespace

std::vector<LawResult> facet_laws(const FacetSurface& facets, const Scattering& bsdf, const std::string& name,
                                  const std::vector<double>& azimuths, const ValidateOptions& options) {
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
  const auto judge = [&](LawResult& law, double value, double error, const Vec3d& wo) {
    // The worst is what its error explains least.
    if (!law.where.empty() && !(std::abs(value) - error > law.worst - law.error)) return;
    law.worst = std::abs(value), law.error = error;
    point_at(law, name, wo, azimuths);
  };
  const std::vector<Vec3d> normals = training_normals(facets, bsdf, options);
  if (normals.empty()) return {}; // equal indices: what does not show cannot be wrong
  const SlopeUnits units(normals);
  const Vec3d normal{0, 0, 1};
  const FacetIntegral unit = integrate_seen(units, normal, [&](const Vec3d& wm) {
    return std::array{facets.D(wm) * wm.z, 0.0};
  });
  judge(normalisation, unit.value[0] - 1, unit.error[0], normal);
  normalisation.where = "over all normals";
  std::vector<Vec3d> views;
  for (const double phi : azimuths)
    for (const double theta : {0.0, 30.0, 60.0, 80.0, 89.0})
      if (phi == azimuths[0] || theta == 60 || theta == 89)
        views.push_back(spherical_direction(theta * pi / 180, phi));
  std::vector<FacetIntegral> seen(views.size()), mirrored(views.size());
  parallel_for(views.size(), [&](std::size_t i) {
    check_stopped(options);
    const Vec3d& wo = views[i];
    seen[i] = integrate_seen(units, wo, [&](const Vec3d& wm) {
      // Light leaves single facets into the whole sphere, also downwards: dwi = 4 <wo, wm> dwm, and the
      // normal is the half vector again.
      const double cosine = dot(wo, wm) / wo.z;
      const Vec3d sum = wo + reflect(wo, wm);
      if (!(cosine > 0 && sum.z > 0) || length_squared(sum) < 1e-24) return std::array{0.0, 0.0};
      const Vec3d wh = normalize(sum);
      return std::array{facets.G1(wo, wm) * facets.D(wm) * cosine, facets.G1(wo, wh) * facets.D(wh) * cosine};
    });
    mirrored[i] = integrate_seen(units, wo, [&](const Vec3d& wm) {
      const Vec3d wi = reflect(wo, wm);
      if (!(wi.z > 0 && dot(wo, wm) > 0)) return std::array{0.0, 0.0};
      return std::array{facets.G2(wo, wi) * facets.D(normalize(wo + wi)) * dot(wo, wm) / wo.z, 0.0};
    });
  });
  for (std::size_t i = 0; i < views.size(); ++i) {
    judge(projected, seen[i].value[0] - 1, seen[i].error[0], views[i]);
    judge(furnace, seen[i].value[1] - 1, seen[i].error[1], views[i]);
    if (!(1 - mirrored[i].value[0] > lost.worst)) continue;
    lost.worst = 1 - mirrored[i].value[0], lost.error = mirrored[i].error[0];
    point_at(lost, name, views[i], azimuths);
  }
  for (LawResult* law : {&normalisation, &projected, &furnace})
    if (!(law->worst - law->error <= law->tolerance)) law->verdict = Verdict::violated;
  return {normalisation, projected, furnace, lost};
}

} // namespace nacre

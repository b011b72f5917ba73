// Laws that hold pair by pair of directions.
#include "core/random.h"
#include "core/shell.h"
#include "core/statistics.h"
#include "core/warp.h"
#include "validate/laws.h"

#include <fmt/format.h>

namespace nacre {
namespace {

// Double precision leaves a relative error near 1e-13 in f; 1e-6 also forgives tables of floats.
constexpr double reciprocity_tolerance = 1e-6;
// Beyond six standard errors of both means, which bounded noise passes once in 10^8 pairs.
constexpr double estimate_sigmas = 6, estimate_tolerance = 0.02;
constexpr double jump_tolerance = 0.02;

double degrees(double radians) { return radians * (180 / pi); }
double phi_deg(const Vec3d& w) { return degrees(std::atan2(w.y, w.x)); }
bool finite(const Rgb& f) { return std::isfinite(f[0]) && std::isfinite(f[1]) && std::isfinite(f[2]); }
double smallest(const Rgb& f) { return std::min({f[0], f[1], f[2]}); }

} // namespace

double theta_deg(const Vec3d& w) { return degrees(std::atan2(std::sqrt(sin2_theta(w)), w.z)); }

void point_at(LawResult& law, const std::string& material, const Vec3d& wo, const Vec3d& wi) {
  law.where = fmt::format("theta_o {:.6g}, theta_i {:.6g}, phi {:.6g}", theta_deg(wo), theta_deg(wi),
                          phi_deg(wi) - phi_deg(wo));
  // Every digit: what is wrong may be so within a rounding of the horizon, on one side of it.
  law.command = fmt::format("nacre eval {} --wo={},{},{} --wi={},{},{}", shell_quoted(material), wo.x, wo.y,
                            wo.z, wi.x, wi.y, wi.z);
  law.wo = wo, law.wi = wi;
}
void point_at(LawResult& law, const std::string& material, const Vec3d& wo,
              const std::vector<double>& azimuths) {
  law.where = fmt::format("theta_o {:.6g}", theta_deg(wo));
  if (azimuths.size() > 1) law.where += fmt::format(", phi_o {:.6g}", phi_deg(wo));
  law.command = fmt::format("nacre eval {} --theta-o {:.9g} --phi-o {:.9g} --albedo", shell_quoted(material),
                            theta_deg(wo), phi_deg(wo));
  law.wo = wo;
}
double random_unit(std::uint64_t seed, std::uint64_t index, std::uint64_t dimension) {
  return unit_double(hash(seed, index, dimension));
}
double compression(const Sides& sides, const Vec3d& w_from, const Vec3d& w_to) {
  const double eta2 = sides.eta * sides.eta;
  return (w_to.z < 0 ? eta2 : 1) / (w_from.z < 0 ? eta2 : 1);
}

std::vector<WoWi> adversarial_pairs() {
  std::vector<WoWi> pairs;
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
  return pairs;
}

std::vector<WoWi> random_pairs(int count, std::uint64_t seed) {
  std::vector<WoWi> pairs;
  for (int i = 0; i < count; ++i) {
    const auto u = [&](int d) { return random_unit(seed, std::uint64_t(i), std::uint64_t(d)); };
    Vec3d wo = square_to_sphere(Vec2<double>{u(0), u(1)});
    Vec3d wi = square_to_sphere(Vec2<double>{u(2), u(3)});
    if (i % 4 == 1) wo.z *= 1e-2, wo = normalize(wo);
    if (i % 4 == 2) wi = normalize(Vec3d{-wo.x, -wo.y, wo.z} + 0.05 * wi);
    pairs.push_back({wo, wi});
  }
  return pairs;
}

std::vector<double> judged_azimuths(const Scattering& bsdf, std::uint64_t seed) {
  constexpr int pairs = 1500;
  const auto differ = [](double a, double b) {
    return !(std::abs(a - b) <= 1e-5 * (std::abs(a) + std::abs(b)) + 1e-9);
  };
  const auto changes = [&](const WoWi& pair, const auto& map) {
    const auto& [wo, wi] = pair;
    const Vec3d o = map(wo), i = map(wi);
    if (differ(bsdf.pdf(wo, wi), bsdf.pdf(o, i))) return true;
    if (bsdf.stochastic) return false;
    const Rgb f = bsdf.eval(wo, wi), g = bsdf.eval(o, i);
    return differ(f[0], g[0]) || differ(f[1], g[1]) || differ(f[2], g[2]);
  };
  bool turn = false, half_turn = false, mirror = false; // does it change anything?
  int n = 0;
  for (const WoWi& pair : random_pairs(pairs, hash(seed, 0x7475726e))) {
    const double phi = 2 * pi * random_unit(seed, std::uint64_t(n++), 31), c = std::cos(phi),
                 s = std::sin(phi);
    turn = turn || changes(pair, [&](const Vec3d& w) {
             return Vec3d{c * w.x - s * w.y, s * w.x + c * w.y, w.z};
           });
    if (!turn) continue;
    half_turn = half_turn || changes(pair, [](const Vec3d& w) { return Vec3d{-w.x, -w.y, w.z}; });
    mirror = mirror || changes(pair, [](const Vec3d& w) { return Vec3d{w.x, -w.y, w.z}; });
    if (half_turn && mirror) break;
  }
  std::vector<double> azimuths{0.4};
  if (turn && bsdf.stochastic) return {0.4, 0.4 + 0.5 * pi}; // walks take their time
  if (turn)
    for (int k = 0; k < (half_turn ? 8 : mirror ? 4 : 3); ++k)
      azimuths.push_back(k * 0.25 * pi);
  return azimuths;
}

LawResult finiteness(const Scattering& bsdf, const std::string& name, const std::vector<WoWi>& pairs) {
  LawResult law{.law = "finiteness", .measures = "evaluations that are not numbers"};
  for (const auto& [wo, wi] : pairs)
    if (!finite(bsdf.eval(wo, wi)) || !std::isfinite(bsdf.pdf(wo, wi))) {
      if (law.worst == 0) point_at(law, name, wo, wi);
      law.worst += 1;
    }
  if (law.worst > 0) law.verdict = Verdict::violated;
  return law;
}

LawResult positivity(const Scattering& bsdf, const std::string& name, const std::vector<WoWi>& pairs) {
  LawResult law{.law = "positivity", .measures = "most negative value, 1/sr"};
  for (const auto& [wo, wi] : pairs) {
    const double low = std::min(smallest(bsdf.eval(wo, wi)), bsdf.pdf(wo, wi));
    if (low < law.worst) {
      law.worst = low;
      point_at(law, name, wo, wi);
    }
  }
  if (law.worst < 0) law.verdict = Verdict::violated;
  return law;
}

double reciprocity_departure(const Scattering& bsdf, const Sides& sides, const Vec3d& wo, const Vec3d& wi) {
  // f(wo, wi) / eta_o^2 = f(wi, wo) / eta_i^2, Veach 1997, eq. 5.14
  const Rgb a = bsdf.eval(wo, wi) * compression(sides, wo, wi), b = bsdf.eval(wi, wo);
  double worst = 0;
  // Values below 1e-6 / sr are no one's to see; they do not count relatively.
  for (int c = 0; c < 3; ++c)
    worst = std::max(worst, std::abs(a[c] - b[c]) / (0.5 * (std::abs(a[c]) + std::abs(b[c])) + 1e-6));
  return worst;
}

LawResult reciprocity(const Scattering& bsdf, const std::string& name, const Sides& sides,
                      const std::vector<WoWi>& pairs) {
  LawResult law{.law = "reciprocity",
                .measures = "|f(o,i) - f(i,o)| / mean, eta^2 in transmission",
                .tolerance = reciprocity_tolerance};
  for (const auto& [wo, wi] : pairs) {
    const double departure = reciprocity_departure(bsdf, sides, wo, wi);
    if (departure > law.worst) {
      law.worst = departure;
      point_at(law, name, wo, wi);
    }
  }
  if (law.worst > law.tolerance) law.verdict = Verdict::violated;
  return law;
}

LawResult reciprocity_of_estimates(const Scattering& bsdf, const std::string& name, const Sides& sides,
                                   const std::vector<WoWi>& pairs) {
  LawResult law{.law = "reciprocity",
                .measures = "|f(o,i) - f(i,o)| / mean beyond 6 standard errors, means of 256 estimates",
                .tolerance = estimate_tolerance};
  const auto turned = [](const Vec3d& w, int n) { // by some 1e-10: other noise, the same truth
    return normalize(Vec3d{w.x * (1 + 1e-12 * n), w.y, w.z});
  };
  for (const auto& [wo, wi] : pairs) {
    if (std::abs(wo.z) < 0.05 || std::abs(wi.z) < 0.05) continue;
    std::array<RunningMoments, 3> a, b;
    for (int n = 0; n < 256; ++n) {
      const Vec3d o = turned(wo, n), i = turned(wi, n);
      const Rgb forth = bsdf.eval(o, i) * compression(sides, o, i), back = bsdf.eval(i, o);
      for (std::size_t c = 0; c < 3; ++c)
        a[c].add(forth[int(c)]), b[c].add(back[int(c)]);
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const double noise = estimate_sigmas * std::hypot(a[c].standard_error(), b[c].standard_error());
      const double beyond = std::abs(a[c].mean() - b[c].mean()) - noise;
      const double difference = beyond / (0.5 * (a[c].mean() + b[c].mean()) + 1e-3);
      if (difference > law.worst) {
        law.worst = difference;
        point_at(law, name, wo, wi);
      }
    }
  }
  if (law.worst > law.tolerance) law.verdict = Verdict::violated;
  return law;
}

// A jump is found by bisection: along an arc from the normal to the horizon each interval over which f cos
// changes noticeably is halved, always into the half that changes more, until it is as short as a rounding; a
// continuous function has by then stopped changing.
LawResult continuity(const Scattering& bsdf, const std::string& name, const ValidateOptions& options) {
  LawResult law{.law = "continuity up to grazing",
                .measures = "largest jump of f cos over 1e-9 rad, of its largest value on the arc",
                .tolerance = jump_tolerance};
  constexpr int arcs = 400, steps = 48;
  const double end = 0.5 * pi * (1 - 1e-7); // at the horizon itself f ends
  for (int n = 0; n < arcs; ++n) {
    const auto u = [&](int d) { return random_unit(options.seed + 77, std::uint64_t(n), std::uint64_t(d)); };
    // A third of the viewers beyond 80 degrees, a third of the arcs through the mirror direction.
    const double theta_o = n % 3 == 0 ? (80 + 9.9 * u(0)) * pi / 180 : std::acos(u(0)) * 0.99;
    const double phi_o = 2 * pi * u(1), phi_i = n % 3 == 1 ? phi_o + pi : 2 * pi * u(2);
    const Vec3d wo = spherical_direction(theta_o, phi_o);
    const auto at = [&](double theta) { return spherical_direction(theta, phi_i); };
    const auto value = [&](double theta) {
      const Vec3d wi = at(theta);
      return average(bsdf.eval(wo, wi)) * wi.z;
    };
    std::array<double, steps + 1> f;
    for (int i = 0; i <= steps; ++i)
      f[std::size_t(i)] = value(end * i / steps);
    const double largest = *std::max_element(f.begin(), f.end()) + 1e-6;
    for (int i = 0; i < steps; ++i) {
      double lo = end * i / steps, hi = end * (i + 1) / steps;
      double f_lo = f[std::size_t(i)], f_hi = f[std::size_t(i) + 1];
      while (hi - lo > 1e-9 && std::abs(f_hi - f_lo) > 0.5 * jump_tolerance * largest) {
        const double middle = 0.5 * (lo + hi), f_middle = value(middle);
        if (std::abs(f_middle - f_lo) > std::abs(f_hi - f_middle))
          hi = middle, f_hi = f_middle;
        else
          lo = middle, f_lo = f_middle;
      }
      const double jump =
          hi - lo > 1e-9 ? 0 : std::abs(f_hi - f_lo) / std::max(largest, std::max(f_lo, f_hi));
      if (jump > law.worst) {
        law.worst = jump;
        point_at(law, name, wo, at(lo));
      }
    }
  }
  if (law.worst > law.tolerance) law.verdict = Verdict::violated;
  return law;
}

} // namespace nacre

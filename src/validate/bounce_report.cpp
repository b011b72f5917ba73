#include "validate/bounce_report.h"

#include "bsdf/models/invariance_conductor.h"
#include "bsdf/models/kulla_conty.h"
#include "bsdf/models/turquin.h"
#include "bsdf/models/walk_conductor.h"
#include "bsdf/models/walk_dielectric.h"
#include "core/parallel.h"
#include "core/quadrature.h"
#include "core/random.h"

#include <fmt/format.h>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

using Color = Spectrum<double, 3>;

/// A direction of a quadrature over the sphere, and the solid angle it stands for.
struct Node {
  Vec3d wi;
  double weight;
};

double fraction(double x) { return x - std::floor(x); }

/// Half of the directions where a single bounce goes, half diffuse, joined by the balance heuristic: for
/// lobes with a peak and for those without. Lattices: the additive recurrence of the plastic number (1.3247)
/// and its cousin in three dimensions (1.2207).
template <class Single>
std::vector<Node> nodes_for(const Single& single, const Vec3d& wo, int n) {
  constexpr bool both_sides = Single::laws.transmits;
  constexpr double a = 0.8191725133961645, b = 0.6710436067037893, c = 0.5497004779019703;
  const auto diffuse_pdf = [&](const Vec3d& wi) {
    return both_sides ? 0.5 * inv_pi * std::abs(wi.z) : inv_pi * std::max(wi.z, 0.0);
  };
  std::vector<Node> nodes;
  for (int i = 0; i < n; ++i) {
    const double u_lobe = fraction((i + 0.5) * a);
    const Vec2<double> u{fraction((i + 0.5) * b), fraction((i + 0.5) * c)};
    const auto s = single.sample(wo, u_lobe, u);
    if (s.pdf > 0) nodes.push_back({s.wi, 1 / (n * (s.pdf + diffuse_pdf(s.wi)))});
    Vec3d d = square_to_cosine_hemisphere(u);
    if (both_sides && u_lobe < 0.5) d.z = -d.z;
    const double p = diffuse_pdf(d);
    if (p > 0) nodes.push_back({d, 1 / (n * (p + single.pdf(wo, d)))});
  }
  return nodes;
}

struct Way {
  std::string name;
  std::function<Color(const Vec3d& wo, const Vec3d& wi)> eval;
};
template <class M>
Way way(const M& model) {
  return {std::string(M::name), [model](const Vec3d& wo, const Vec3d& wi) { return model.eval(wo, wi); }};
}

struct Albedo {
  Color all, reflected;
};
/// Energy: radiance that crosses from index n_i to n_o is compressed by (n_o / n_i)^2, which is taken out
/// here.
Albedo albedo_of(const Way& w, const Vec3d& wo, const std::vector<Node>& nodes, double eta_ti) {
  Albedo sum;
  for (const Node& node : nodes) {
    const bool same = node.wi.z * wo.z > 0;
    const Color f = w.eval(wo, node.wi) * (node.weight * std::abs(node.wi.z) * (same ? 1 : sqr(eta_ti)));
    sum.all += f;
    if (same) sum.reflected += f;
  }
  return sum;
}
template <class Walk>
Albedo albedo_of_walk(const Walk& walk, const Vec3d& wo, int n, double eta_ti) {
  Albedo sum;
  for (int i = 0; i < n; ++i) {
    const auto u = [&](int d) { return unit_double(hash(11, i, d)); };
    const auto s = walk.sample(wo, u(0), {u(1), u(2)});
    if (!(s.pdf > 0)) continue;
    const bool same = s.wi.z * wo.z > 0;
    const Color weight = s.f * (std::abs(s.wi.z) / s.pdf / n * (same ? 1 : sqr(eta_ti)));
    sum.all += weight;
    if (same) sum.reflected += weight;
  }
  return sum;
}

/// Mean of the estimates at wi and its nearest neighbours, which draw other random numbers.
template <class Walk>
Color many_walks(Walk walk, const Vec3d& wo, const Vec3d& wi, int pairs, int first) {
  constexpr int at_once = 64;
  walk.walks = std::min(pairs, at_once);
  const int n = std::max(pairs / at_once, 1);
  Color sum;
  for (int i = 0; i < n; ++i)
    sum += walk.eval(wo, normalize(Vec3d{wi.x + 1e-10 * (first + i), wi.y, wi.z})) * (1.0 / n);
  return sum;
}

struct Material {
  std::string name;
  double eta = 1; ///< of glass
};

template <class Single, class Walk>
std::vector<BounceCell> compare(const Material& material, const Single& single, const Walk& walk,
                                const std::vector<Way>& ways, double alpha, double theta_deg, bool lobes,
                                const BounceOptions& options) {
  const Vec3d wo = spherical_direction(theta_deg * pi / 180, 0.0);
  const std::vector<Node> nodes = nodes_for(single, wo, options.nodes);
  const Albedo reference = albedo_of_walk(walk, wo, options.walks, material.eta);
  std::vector<BounceCell> cells;
  for (const Way& w : ways) {
    const Albedo albedo = albedo_of(w, wo, nodes, material.eta);
    int far = 0;
    for (int c = 1; c < 3; ++c)
      if (std::abs(albedo.all[c] - reference.all[c]) > std::abs(albedo.all[far] - reference.all[far]))
        far = c;
    cells.push_back({material.name, w.name, alpha, theta_deg, albedo.all[far], albedo.reflected[far],
                     reference.all[far], reference.reflected[far]});
  }
  if (!lobes) return cells;
  constexpr int n_lobe = 377;
  double noise = 0, total = 0;
  std::vector<double> apart(ways.size(), 0.0);
  for (const Node& node : nodes_for(single, wo, n_lobe)) {
    const double weight = node.weight * std::abs(node.wi.z) * (node.wi.z < 0 ? sqr(material.eta) : 1);
    const Color one = many_walks(walk, wo, node.wi, options.pairs / 2, 1);
    const Color other = many_walks(walk, wo, node.wi, options.pairs / 2, 1000);
    const Color f = (one + other) * 0.5;
    const auto size = [](const Color& c) { return average(c.map([](double x) { return std::abs(x); })); };
    total += weight * size(f);
    noise += weight * size(one - other) * 0.5;
    for (std::size_t k = 0; k < ways.size(); ++k)
      apart[k] += weight * size(ways[k].eval(wo, node.wi) - f);
  }
  for (std::size_t k = 0; k < ways.size(); ++k) {
    cells[k].lobe = apart[k] / total;
    cells[k].lobe_noise = noise / total;
  }
  return cells;
}

std::vector<BounceCell> compare_conductors(const std::string& name, const Color& eta, const Color& k,
                                           double alpha, double theta_deg, bool lobes,
                                           const BounceOptions& options) {
  const GgxConductor<double, 3> single{{}, eta, k, alpha, alpha, Color(1), 0};
  const WalkGgxConductor<double, 3> walk{{}, eta, k, alpha, alpha, 1};
  return compare(Material{name}, single, walk,
                 {way(single), way(KullaContyConductor<double, 3>{{}, eta, k, alpha}),
                  way(TurquinConductor<double, 3>{{}, eta, k, alpha}),
                  way(InvarianceConductor<double, 3>{{}, eta, k, alpha})},
                 alpha, theta_deg, lobes, options);
}
std::vector<BounceCell> compare_glass(double alpha, double theta_deg, bool lobes,
                                      const BounceOptions& options) {
  constexpr double eta = 1.5;
  const GgxDielectric<double, 3> single{{}, eta, alpha, alpha, Color(1), Color(1), 0};
  const WalkGgxDielectric<double, 3> walk{{}, eta, alpha, alpha, 1};
  return compare(Material{"glass", eta}, single, walk,
                 {way(single), way(KullaContyDielectric<double, 3>{{}, eta, alpha}),
                  way(TurquinDielectric<double, 3>{{}, eta, alpha})},
                 alpha, theta_deg, lobes, options);
}

Color rgb(double r, double g, double b) { return Color(std::array<double, 3>{r, g, b}); }

/// 2 int E c dc, the inner integral over the visible normals, where single scattering is smooth.
double kept_of_diffuse_light(double alpha) {
  const Ggx<double> d{alpha, alpha};
  return integrate(
      composite_gauss_legendre(16, 4, 0, 1), [&](double t) { // c = t^2: features lie near grazing
        const Vec3d wo{std::sqrt(1 - sqr(t * t)), 0, t * t};
        const double lo = d.lambda_cos(wo);
        const QuadratureRule height = composite_gauss_legendre(16, 6, 0, 1);
        constexpr int n_azimuth = 48;
        const double E = integrate(height, [&](double u) {
          double sum = 0;
          for (int i = 0; i < n_azimuth; ++i) {
            const Vec3d wi = reflect(wo, d.sample_visible(wo, {0.5 * (i + 0.5) / n_azimuth, u}));
            if (wi.z > 0)
              sum += (wo.z + lo) * wi.z / (wo.z * wi.z + lo * wi.z + d.lambda_cos(wi) * wo.z) / n_azimuth;
          }
          return sum;
        });
        return 4 * t * t * t * E;
      });
}

} // namespace

BounceReport compare_bounces(const BounceOptions& options) {
  const std::size_t n_theta = options.thetas_deg.size(), n = options.alphas.size() * n_theta;
  std::vector<std::vector<BounceCell>> cells(n);
  parallel_for(n, [&](std::size_t i) {
    const double alpha = options.alphas[i / n_theta], theta = options.thetas_deg[i % n_theta];
    const auto& some = options.lobe_thetas_deg;
    const bool lobes = std::find(some.begin(), some.end(), theta) != some.end();
    const auto add = [&](const std::vector<BounceCell>& more) {
      cells[i].insert(cells[i].end(), more.begin(), more.end());
    };
    // No metal is white; an absorption this large comes as near as double resolves.
    add(compare_conductors("white", Color(1e-3), Color(1e5), alpha, theta, lobes, options));
    // Gold, about as at 650, 550 and 450 nm in Johnson and Christy 1972.
    add(compare_conductors("gold", rgb(0.16, 0.43, 1.38), rgb(3.48, 2.46, 1.91), alpha, theta, lobes,
                           options));
    add(compare_glass(alpha, theta, lobes, options));
  });
  BounceReport report;
  for (const auto& c : cells)
    report.cells.insert(report.cells.end(), c.begin(), c.end());
  report.alphas = options.alphas;
  for (const double alpha : options.alphas)
    report.kept.push_back(kept_of_diffuse_light(alpha));
  return report;
}

std::string to_text(const BounceReport& report) {
  std::string text =
      "Share of diffuse light that single scattering from white GGX facets keeps:\n\n| alpha | kept |\n|--"
      "-|---|\n";
  for (std::size_t i = 0; i < report.alphas.size(); ++i)
    text += fmt::format("| {} | {:.4f} |\n", report.alphas[i], report.kept[i]);
  for (const auto& [material, title] :
       {std::pair{"white", "Directional albedo, white facets"},
        std::pair{"gold", "Albedo less that of the random walk, gold, in the channel where it is farthest"},
        std::pair{"glass", "Albedo, and its reflected part less that of the random walk, glass"}}) {
    std::vector<std::string> ways;
    std::map<std::pair<double, double>, std::vector<const BounceCell*>> rows;
    for (const BounceCell& c : report.cells) {
      if (c.material != material) continue;
      if (std::find(ways.begin(), ways.end(), c.way) == ways.end()) ways.push_back(c.way);
      rows[{c.alpha, c.theta_deg}].push_back(&c);
    }
    text += fmt::format("\n{}:\n\n| alpha | theta | walk |", title);
    for (const std::string& w : ways)
      text += fmt::format(" {} |", w);
    text += "\n|---|---|---|";
    for (std::size_t i = 0; i < ways.size(); ++i)
      text += "---|";
    text += '\n';
    for (const auto& [at, row] : rows) {
      text += fmt::format("| {} | {} | {:.4f} |", at.first, at.second, row.front()->walk);
      for (const BounceCell* c : row)
        text += c->material == "white" ? fmt::format(" {:.4f} |", c->albedo)
                : c->material == "gold"
                    ? fmt::format(" {:+.4f} |", c->albedo - c->walk)
                    : fmt::format(" {:.4f}, {:+.4f} |", c->albedo, c->reflected - c->walk_reflected);
      text += '\n';
    }
  }
  text += "\nLobes: mean distance from the random walk's, relative (noise of the walk in brackets):\n\n"
          "| material | alpha | theta | way | distance |\n|---|---|---|---|---|\n";
  for (const BounceCell& c : report.cells)
    if (c.lobe >= 0)
      text += fmt::format("| {} | {} | {} | {} | {:.3f} ({:.3f}) |\n", c.material, c.alpha, c.theta_deg,
                          c.way, c.lobe, c.lobe_noise);
  return text;
}

nlohmann::json to_json(const BounceReport& report) {
  nlohmann::json json{{"alphas", report.alphas}, {"kept_by_single_scattering", report.kept}};
  for (const BounceCell& c : report.cells) {
    nlohmann::json cell{{"material", c.material}, {"way", c.way},
                        {"alpha", c.alpha},       {"theta_deg", c.theta_deg},
                        {"albedo", c.albedo},     {"reflected", c.reflected},
                        {"walk_albedo", c.walk},  {"walk_reflected", c.walk_reflected}};
    if (c.lobe >= 0) cell["lobe_distance"] = c.lobe, cell["lobe_noise"] = c.lobe_noise;
    json["cells"].push_back(cell);
  }
  return json;
}

} // namespace nacre

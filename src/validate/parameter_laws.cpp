// Laws that are asked of a model rather than of one scattering function: its parameters are varied.
#include "core/parallel.h"
#include "validate/laws.h"

#include <algorithm>
#include <fmt/format.h>

namespace nacre {
namespace {

constexpr double mixing_tolerance = 1e-9;

/// Every model at its lows, its highs, each parameter alone at an end, and random points.
std::vector<MaterialSpec> corners(const MaterialSpec& material, std::uint64_t seed) {
  std::vector<MaterialSpec> all;
  for (std::size_t l = 0; l < material.lobes.size(); ++l) {
    if (material.lobes[l].is_table()) continue;
    const ModelInfo& model = model_info(material.lobes[l]);
    const std::size_t n = model.parameters.size();
    for (std::size_t corner = 0; corner < 2 * n + 12; ++corner) {
      MaterialSpec m = material;
      for (std::size_t p = 0; p < n; ++p) {
        const ParameterInfo& info = model.parameters[p];
        const double ends[] = {info.lo, info.hi};
        auto& value = m.lobes[l].values[p];
        if (corner < 2)
          value.fill(ends[corner]);
        else if (corner < 2 * n + 2) {
          if ((corner - 2) / 2 == p) value.fill(ends[corner % 2]);
        } else // a random corner
          value.fill(ends[random_unit(seed, corner, p) < 0.5]);
      }
      if (LobeSpec& lobe = m.lobes[l]; lobe.user) lobe = user_lobe(lobe.user, lobe.values, lobe.weight);
      m.name = m.argument = to_text(m);
      all.push_back(std::move(m));
    }
  }
  return all;
}

LawResult finite_over_domain(const MaterialSpec& material, const ValidateOptions& options) {
  LawResult law{.law = "finiteness over the domain",
                .measures = "evaluations that are not numbers at corners of the parameters' domains"};
  const std::vector<WoWi> pairs = adversarial_pairs();
  const std::vector<MaterialSpec> all = corners(material, options.seed);
  std::vector<LawResult> found(all.size());
  parallel_for(all.size(), [&](std::size_t i) {
    check_stopped(options);
    Scattering bsdf = Scattering::of(all[i]);
    // A shader's density is a table of its own values, finite whatever they are, and takes long to make.
    for (const LobeSpec& lobe : all[i].lobes)
      if (lobe.user) bsdf.pdf = [](const Vec3d&, const Vec3d&) { return 0.0; };
    found[i] = finiteness(bsdf, all[i].name, pairs);
  });
  for (const LawResult& at : found) {
    if (at.worst > 0 && law.worst == 0)
      law.where = at.where, law.command = at.command, law.wo = at.wo, law.wi = at.wi;
    law.worst += at.worst;
  }
  if (law.worst > 0) law.verdict = Verdict::violated;
  return law;
}

// A renderer gives the model wavelengths drawn at random: a value at one must not depend on the others.
LawResult channels_apart(const MaterialSpec& material, const ValidateOptions& options) {
  LawResult law{.law = "channels do not mix",
                .measures = "relative change of a channel when the others change places",
                .tolerance = mixing_tolerance};
  MaterialSpec colored = material;
  for (std::size_t l = 0; l < colored.lobes.size(); ++l) {
    LobeSpec& lobe = colored.lobes[l];
    const ModelInfo& model = model_info(lobe);
    for (std::size_t p = 0; p < model.parameters.size(); ++p) {
      const ParameterInfo& info = model.parameters[p];
      for (std::size_t c = 0; info.per_channel && c < 3; ++c)
        lobe.values[p][c] = std::clamp(lobe.values[p][c] * (0.8 + 0.4 * random_unit(options.seed + l, p, c)),
                                       info.lo, info.hi);
    }
  }
  MaterialSpec swapped = colored; // green stays, red and blue change places
  for (LobeSpec& lobe : swapped.lobes)
    for (auto& value : lobe.values)
      std::swap(value[0], value[2]);
  const Scattering a = Scattering::of(colored), b = Scattering::of(swapped);
  for (const auto& [wo, wi] : random_pairs(400, options.seed + 3)) {
    const Rgb f = a.eval(wo, wi), g = b.eval(wo, wi);
    for (int c = 0; c < 3; ++c) {
      const double change = std::abs(f[c] - g[2 - c]) / (std::abs(f[c]) + 1e-6);
      if (change > law.worst) {
        law.worst = change;
        point_at(law, to_text(colored), wo, wi);
      }
    }
  }
  if (law.worst > law.tolerance) law.verdict = Verdict::violated;
  return law;
}

/// True if the lobe is an interface alone, and its parameters say that there is none: equal indices, or
/// nothing reflected head on.
bool no_interface(const LobeSpec& lobe) {
  if (lobe.measured) return false;
  const ModelInfo& model = model_info(lobe);
  // Over something that scatters too, or under a coat.
  for (const char* more : {"diffuse_reflectance", "reflectance", "albedo", "coat_eta"})
    if (model.has(more)) return false;
  const auto is = [&](std::string_view name, double x) {
    if (!model.has(name)) return false;
    const auto& v = lobe.values[model.parameter_index(name)];
    return v[0] == x && v[1] == x && v[2] == x;
  };
  return is("f0", 0) || (is("eta", 1) && (!model.has("k") || is("k", 0)));
}

LawResult equal_indices(const LobeSpec& lobe, const std::string& name, const ValidateOptions& options) {
  LawResult law{.law = "equal indices reflect nothing",
                .measures = "largest reflected f of an interface that is none, 1/sr",
                .tolerance = 1e-6};
  const Scattering bsdf = Scattering::of(MaterialSpec{name, {lobe}});
  for (auto [wo, wi] : random_pairs(options.directions, options.seed)) {
    if (wo.z * wi.z < 0) wi.z = -wi.z;
    const double f = max_component(bsdf.eval(wo, wi));
    if (f > law.worst) {
      law.worst = f;
      point_at(law, name, wo, wi);
    }
  }
  if (law.worst > law.tolerance) law.verdict = Verdict::violated;
  return law;
}

} // namespace

std::vector<LawResult> parameter_laws(const MaterialSpec& material, const ValidateOptions& options) {
  std::vector<LawResult> laws{finite_over_domain(material, options)};
  const bool stochastic = Scattering::of(material).stochastic;
  // Measurements and users' shaders have three channels and no parameters by wavelength.
  const bool listed = std::none_of(material.lobes.begin(), material.lobes.end(),
                                   [](const LobeSpec& lobe) { return bool(lobe.measured); });
  if (!stochastic && listed) laws.push_back(channels_apart(material, options));
  for (const LobeSpec& lobe : material.lobes)
    if (no_interface(lobe))
      laws.push_back(
          equal_indices(lobe, material.argument.empty() ? material.name : material.argument, options));
  return laws;
}

} // namespace nacre

#include "fit/export_material.h"

#include "core/error.h"
#include "core/file.h"
#include "core/parallel.h"
#include "fit/export/evaluated_material.h"
#include "fit/export/target.h"
#include "fit/fit.h"

#include <filesystem>
#include <fmt/format.h>

namespace nacre {
namespace {

constexpr double max_theta_deg = 80;
constexpr double dark = 1e-3; ///< 1/sr: of values below, differences are taken relative to it
/// Log error up to which the format's own word for a material is taken without a look at its other models.
constexpr double close_enough = 1e-3;

const std::vector<Target>& targets() {
  static const std::vector<Target> all{json_target(), brdf_target(), mitsuba_target(),
                                       pbrt_target(), gltf_target(), materialx_target()};
  return all;
}

const Target& target_of(std::string_view ending) {
  std::vector<std::string> known;
  for (const Target& t : targets()) {
    if (t.ending == ending) return t;
    known.emplace_back(t.ending);
  }
  throw Error(fmt::format("no material is written as '{}'{}", ending, suggestion(ending, known)));
}

/// What a sum of lobes does besides reflecting into a range of directions in front, which alone a fit sees.
struct Unseen {
  bool transmits = false, mirrors = false;
};
Unseen unseen(const MaterialSpec& material) {
  const auto bsdf = make_bsdf<double>(material);
  Unseen u;
  for (int i = 0; i < 8; ++i) {
    const Vec3d wo = spherical_direction(0.15 * i + 0.05, 0.3);
    for (int j = 0; j < 16; ++j) {
      const double a = (j + 0.5) / 16, b = std::fmod(0.618 * (i * 16 + j), 1.0);
      const auto s = bsdf.sample(wo, a, {b, std::fmod(7.1 * a + b, 1.0)});
      if (!(s.pdf > 0)) continue;
      u.mirrors |= bool(s.is_delta);
      u.transmits |= s.wi.z < 0;
    }
  }
  return u;
}

std::string directions_text(const Vec3f& wo, const Vec3f& wi) {
  const auto degrees = [](double radians) { return radians * 180 / pi; };
  double phi = degrees(std::atan2(double(wi.y), double(wi.x)) - std::atan2(double(wo.y), double(wo.x)));
  if (phi < 0) phi += 360;
  return fmt::format("theta_i {:.1f}, theta_o {:.1f}, phi {:.1f}",
                     degrees(std::acos(std::min(double(wi.z), 1.0))),
                     degrees(std::acos(std::min(double(wo.z), 1.0))), phi);
}

/// @param samples  of `source`
MappingError mapping_error(const MeasuredBsdf& source, const MeasuredSamples& samples,
                           const MaterialSpec& target) {
  const MetricErrors errors = metric_errors(source, target, max_theta_deg);
  MappingError e{errors.of(Metric::log), errors.of(Metric::cosine), 0, ""};
  const auto bsdf = make_bsdf<double>(target);
  const float cut = float(std::cos(max_theta_deg * pi / 180));
  const std::size_t channels = std::size_t(source.channels().count());
  constexpr std::size_t part = 1024;
  std::vector<std::pair<double, std::size_t>> worst((samples.size() + part - 1) / part);
  parallel_for(worst.size(), [&](std::size_t p) {
    for (std::size_t i = p * part; i < std::min((p + 1) * part, samples.size()); ++i) {
      const Vec3f &o = samples.wo[i], &w = samples.wi[i];
      if (!(o.z > cut && w.z > cut)) continue;
      const auto written = bsdf.eval({o.x, o.y, o.z}, {w.x, w.y, w.z});
      const auto f = source.channels().to_rgb(std::span(samples.f).subspan(i * channels, channels));
      for (std::size_t c = 0; c < 3; ++c)
        worst[p] = std::max(worst[p], {std::abs(written[int(c)] - f[c]) / std::max(f[c], dark), i});
    }
  });
  const auto largest = std::max_element(worst.begin(), worst.end());
  if (largest == worst.end()) return e;
  e.relative = largest->first;
  e.where = directions_text(samples.wo[largest->second], samples.wi[largest->second]);
  return e;
}

/// Letters, digits, - and _ of the file's name.
std::string identifier(const std::string& path) {
  std::string id;
  for (const char c : std::filesystem::path(path).stem().string())
    id += std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' ? c : '_';
  return id.empty() || std::isdigit(static_cast<unsigned char>(id[0])) ? "m" + id : id;
}

std::string error_text(const Translation& t) {
  if (t.is_exact()) return "none";
  if (std::isnan(t.error.log)) return "not known of mirrors";
  return fmt::format("log {:.4g}, cosine {:.4g} 1/sr; largest relative difference {:.3g} at {} degrees",
                     t.error.log, t.error.cosine, t.error.relative, t.error.where);
}

/// What the material is, how it was translated, how well: for the comment in the file.
std::vector<std::string> comment(const MaterialSpec& material, const Translation& t) {
  std::vector<std::string> lines{"Material: " + material.name};
  if (t.is_exact() && !t.fitted)
    lines.push_back("Written by Nacre: " + models_of(t.target) + ", the same model and parameters");
  else
    lines.push_back(
        fmt::format("Written by Nacre: {}{}", models_of(t.target),
                    t.fitted ? ", its parameters fitted to the material" : ", the nearest to it"));
  lines.push_back("Mapping error: " + error_text(t));
  lines.insert(lines.end(), t.remarks.begin(), t.remarks.end());
  for (std::string& line : lines) // a name may hold what ends a line
    std::replace_if(
        line.begin(), line.end(), [](unsigned char c) { return std::iscntrl(c); }, ' ');
  return lines;
}

Translation translate(const MaterialSpec& material, const Target& target, const std::string& name,
                      const ExportOptions& options) {
  std::vector<std::string> models;
  for (const std::string& model : target.models)
    if (options.model.empty() || models_of(parse_material(model)) == options.model) models.push_back(model);
  std::optional<MaterialSpec> own = target.express(material);
  if (own && !options.model.empty() && models_of(*own) != options.model) own.reset();
  if (models.empty() && !own) {
    std::vector<std::string> known;
    for (const std::string& model : target.models)
      known.push_back(models_of(parse_material(model)));
    throw Error(fmt::format("{}: no model '{}' for {}{}", target.name, options.model, material.name,
                            suggestion(options.model, known)));
  }
  const Unseen hidden = unseen(material);
  if (!own && (hidden.transmits || hidden.mirrors))
    throw Error(fmt::format(
        "{} cannot hold {}, which {}; a fit sees reflection in a range of directions alone{}", target.name,
        material.name, hidden.transmits ? "transmits light" : "mirrors",
        hidden.transmits ? "" : ": give a rough counterpart of it, such as ggx_conductor:alpha_x=0.001"));

  const bool is_table = material.lobes.size() == 1 && material.lobes[0].is_table();
  const std::shared_ptr<const MeasuredBsdf> source =
      is_table ? material.lobes[0].measured : std::make_shared<EvaluatedMaterial>(material, 2, 4);
  const MeasuredSamples samples = source->samples();

  Translation best;
  best.error.log = best.error.relative = std::numeric_limits<double>::infinity();
  const auto consider = [&](const MaterialSpec& candidate, bool fitted) {
    const MappingError error = mapping_error(*source, samples, candidate);
    if (!(error.log < best.error.log)) return;
    best.target = candidate;
    best.fitted = fitted;
    best.error = error;
  };
  if (own) consider(*own, false);
  if (!hidden.transmits && !hidden.mirrors && !best.is_exact()) {
    // Without noise some thousand nodes determine any of the models.
    const std::shared_ptr<const MeasuredBsdf> fitted_to =
        is_table ? source : std::make_shared<EvaluatedMaterial>(material, 8, 18);
    FitOptions fit_options;
    fit_options.isotropic = source->is_isotropic();
    fit_options.seed = options.seed;
    fit_options.refined = 1;
    if (own) {
      fit_options.model = to_text(*own);
      fit_options.starts = 1;
      consider(fit(*fitted_to, fit_options).material, true);
    }
    fit_options.starts = 6;
    for (const std::string& model : models) {
      if (own && best.error.log < close_enough) break;
      fit_options.model = model;
      consider(fit(*fitted_to, fit_options).material, true);
    }
  }
  best.format = target.name;
  best.target.name = models_of(best.target);
  best.remarks = target.remarks(best.target);
  if (hidden.mirrors) {
    best.remarks.push_back(
        "Mirror directions were translated by their parameters; the error leaves them out.");
    if (models_of(best.target) != models_of(material)) { // another model's narrow lobe in place of a mirror
      const double unknown = std::numeric_limits<double>::quiet_NaN();
      best.error = {unknown, unknown, unknown, ""};
    }
  }
  if (hidden.transmits)
    best.remarks.push_back("Transmission was translated by its parameters; the error is that of reflection.");
  best.text = target.write(best.target, name, comment(material, best));
  return best;
}

} // namespace

Translation translate(const MaterialSpec& material, std::string_view ending, const ExportOptions& options) {
  return translate(material, target_of(ending), "material", options);
}

Translation export_material(const MaterialSpec& material, const std::string& path,
                            const ExportOptions& options) {
  const Target& target = target_of(std::filesystem::path(path).extension().string());
  Translation t = translate(material, target, identifier(path), options);
  write_file_atomically(path, t.text);
  return t;
}

std::vector<ExportFormat> export_formats() {
  std::vector<ExportFormat> formats;
  for (const Target& t : targets()) {
    formats.push_back({std::string(t.ending), std::string(t.name), {}});
    for (const std::string& model : t.models) {
      const std::string names = models_of(parse_material(model));
      auto& known = formats.back().models;
      if (std::find(known.begin(), known.end(), names) == known.end()) known.push_back(names);
    }
  }
  return formats;
}

std::string to_text(const Translation& t) {
  MaterialSpec rounded = t.target;
  for (LobeSpec& lobe : rounded.lobes) {
    lobe.weight = std::stod(fmt::format("{:.5g}", lobe.weight));
    for (auto& value : lobe.values)
      for (double& x : value)
        x = std::stod(fmt::format("{:.5g}", x));
  }
  std::string text = fmt::format("{}: {}{}\nmapping error: {}\n", t.format, to_text(rounded),
                                 t.fitted ? " (fitted)" : "", error_text(t));
  for (const std::string& remark : t.remarks)
    text += remark + "\n";
  return text;
}

} // namespace nacre

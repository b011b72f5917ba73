#include "render/material.h"

#include "core/error.h"
#include "core/sobol.h"

#include <fmt/format.h>

namespace nacre {
namespace {

float scalar_at(const ParameterSource& source, Vec2f uv) {
  if (const float* x = std::get_if<float>(&source)) return *x;
  // A spectrum where a number is asked for: its value in the middle of the visible range.
  if (const auto* s = std::get_if<SpectrumSource>(&source)) return s->eval(550.0f);
  return std::get<std::shared_ptr<const Texture>>(source)->eval_scalar(uv);
}

/// The normal of the surface raised by a height along it, in the surface's frame: from the raised point's
/// derivatives by u and v, less what the normal itself turns. Blinn 1978, Simulation of Wrinkled Surfaces.
/// @param slope  derivatives of the height by u and v
Vec3f bumped_normal(const Surface& surface, Vec2f slope) {
  const auto raised = [&](const Vec3f& dp, float dh) {
    const Vec3f d = surface.frame.to_local(dp);
    return Vec3f{d.x, d.y, dh};
  };
  const Vec3f n = cross(raised(surface.dp_du, slope.x), raised(surface.dp_dv, slope.y));
  const float l2 = length_squared(n);
  if (!(l2 > 0)) return {0, 0, 1};
  return n * (std::copysign(1.0f, n.z) / std::sqrt(l2)); // texture coordinates may run against the normal
}

} // namespace

float SurfaceBsdf::shadowing(const Vec3f& wi) const {
  if (bump_alpha2_ == 0) return 1;
  const float c2 = sqr(dot(shading_normal_, wi)), tan2 = std::max(0.0f, 1 - c2) / std::max(c2, 1e-12f);
  return 2 / (1 + std::sqrt(1 + bump_alpha2_ * tan2));
}

SampledSpectrum SurfaceBsdf::eval(const Vec3f& wi) const {
  const Vec3f l = to_local(wi);
  if (wedge_) return WedgeWalk(*wedge_, bsdf_).eval(wo_, l) * opacity_;
  if (!consistent(wi, l.z)) return {};
  return bsdf_.eval(wo_, l) * (std::abs(l.z) * opacity_ * shadowing(wi));
}

float SurfaceBsdf::pdf(const Vec3f& wi) const {
  const Vec3f l = to_local(wi);
  if (wedge_) return WedgeWalk(*wedge_, bsdf_).pdf(wo_, l) * opacity_;
  return consistent(wi, l.z) ? bsdf_.pdf(wo_, l) * opacity_ : 0;
}

SurfaceBsdf::Sample SurfaceBsdf::sample(float u_lobe, Vec2f u) const {
  if (u_lobe >= opacity_) return {-viewer_, SampledSpectrum(1), 1 - opacity_, true};
  u_lobe = std::min(u_lobe / opacity_, 0x1.fffffep-1f);
  Sample result;
  if (wedge_) {
    const auto walk = WedgeWalk(*wedge_, bsdf_).sample(wo_, u_lobe, u);
    return {frame_.to_world({walk.wi.x, walk.wi.y, walk.wi.z * side_}), walk.weight, walk.pdf * opacity_,
            walk.is_delta};
  }
  const auto s = bsdf_.sample(wo_, u_lobe, u);
  if (!(s.pdf > 0)) return result;
  result.wi = frame_.to_world({s.wi.x, s.wi.y, s.wi.z * side_});
  if (!consistent(result.wi, s.wi.z)) return result;
  result.weight = s.f * (std::abs(s.wi.z) / s.pdf * shadowing(result.wi));
  result.pdf = s.pdf * opacity_;
  result.is_delta = s.is_delta;
  if (s.wi.z * wo_.z < 0) result.eta2 = sqr(wo_.z > 0 ? eta_ : 1 / eta_);
  return result;
}

namespace {

/// Each wavelength's own value, in nanometres or micrometres: for models of interference and diffraction.
const ParameterSource& own_wavelength(const ParameterInfo& parameter) {
  const auto line = [](float unit) {
    const std::array<float, 2> nm{300, 900}, value{300 * unit, 900 * unit};
    return ParameterSource(SpectrumSource::tabulated(nm, value));
  };
  static const ParameterSource in_nm = line(1), in_um = line(1e-3f);
  return parameter.wavelength_unit() == 1 ? in_nm : in_um;
}

} // namespace

MaterialTable::PreparedLobe MaterialTable::prepare(const Lobe& lobe, const Material& material, float& eta) {
  PreparedLobe p{-1, lobe.measured.get(), lobe.weight, 1, 0, {}, {}};
  if (!std::isfinite(lobe.weight) || lobe.weight < 0)
    throw Error(fmt::format("material '{}': the weight of {} is {}", material.id, lobe.model, lobe.weight));
  if (lobe.model == measured_lobe) {
    if (!lobe.measured) throw Error(fmt::format("material '{}': no measurement", material.id));
    return p;
  }
  p.model = model_index(lobe.model);
  const ModelInfo& model = model_infos()[std::size_t(p.model)];
  if (model.parameters.size() != lobe.parameters.size())
    throw Error(fmt::format("material '{}': {} takes {} parameters, found {}", material.id, model.name,
                            model.parameters.size(), lobe.parameters.size()));
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    const ParameterInfo& parameter = model.parameters[i];
    const ParameterSource& source =
        parameter.is_wavelength() ? own_wavelength(parameter) : lobe.parameters[i];
    const int size = parameter.per_channel ? 4 : 1;
    const float lo = float(parameter.lo), hi = float(parameter.hi);
    const bool by_wavelength = parameter.per_channel && std::holds_alternative<SpectrumSource>(source);
    if (by_wavelength || std::holds_alternative<std::shared_ptr<const Texture>>(source)) {
      p.varying.push_back({p.count, parameter.per_channel, lo, hi, &source});
      p.count += size;
      continue;
    }
    const float x = scalar_at(source, {0, 0});
    if (!(x >= lo && x <= hi))
      throw Error(fmt::format("material '{}': {} of {} is {}, outside [{}, {}]", material.id, parameter.name,
                              model.name, x, lo, hi));
    for (int k = 0; k < size; ++k)
      p.values[std::size_t(p.count++)] = x;
    if (model.laws.transmits && !model.laws.thin && parameter.name == "eta") eta = x;
  }
  return p;
}

MaterialTable::MaterialTable(const Scene& scene) {
  for (const Material& material : scene.materials) {
    if (material.lobes.size() > std::size_t(Bsdf<float, 4>::max_lobes))
      throw Error(fmt::format("material '{}' has {} lobes; {} are possible", material.id,
                              material.lobes.size(), Bsdf<float, 4>::max_lobes));
    Prepared p{&material, {}, 1};
    const bool has_facets = material.normal_mapping == NormalMapping::microfacet;
    for (const Lobe& lobe : material.lobes) {
      p.lobes.push_back(prepare(lobe, material, p.eta));
      const int model = p.lobes.back().model;
      if (has_facets && model >= 0 && model_infos()[std::size_t(model)].laws.transmits)
        throw Error(fmt::format("material '{}': microfacet normal mapping is for models that reflect, and {} "
                                "transmits light; use turned_frame",
                                material.id, lobe.model));
    }
    choose_by_albedo(p.lobes);
    materials_.push_back(std::move(p));
  }
  const auto check = [&](const Shape& s) {
    if (s.material < -1 || s.material >= int(materials_.size()))
      throw Error(fmt::format("shape '{}' has material {} of {}", s.id, s.material, materials_.size()));
  };
  for (const Shape& s : scene.shapes)
    check(s);
  for (const Group& g : scene.groups)
    for (const Shape& s : g.shapes)
      check(s);
}

BsdfLobe<float, 4> MaterialTable::resolve(const PreparedLobe& lobe, Vec2f uv, const Wavelengths& w) {
  if (lobe.model < 0) return BsdfLobe<float, 4>(MeasuredLobe<float, 4>(lobe.measured, w));
  const std::span constants(lobe.values.data(), std::size_t(lobe.count));
  if (lobe.varying.empty()) return {lobe.model, constants};
  std::array<float, max_parameter_numbers<4>> values;
  std::copy(constants.begin(), constants.end(), values.begin());
  for (const Varying& v : lobe.varying) {
    float* out = &values[std::size_t(v.begin)];
    const auto* texture = std::get_if<std::shared_ptr<const Texture>>(v.source);
    if (!v.per_channel) {
      *out = clamp((*texture)->eval_scalar(uv), v.lo, v.hi);
      continue;
    }
    const SampledSpectrum s = texture ? (*texture)->eval(uv, w) : std::get<SpectrumSource>(*v.source).eval(w);
    for (int i = 0; i < 4; ++i)
      out[i] = clamp(s[i], v.lo, v.hi);
  }
  return {lobe.model, {values.data(), constants.size()}};
}

void MaterialTable::choose_by_albedo(std::vector<PreparedLobe>& lobes) {
  if (lobes.size() < 2) return; // nothing to choose
  constexpr std::uint32_t n = 384;
  // From steep to grazing, where Fresnel makes a faint gloss the brightest lobe.
  const std::array<Vec3f, 3> views{spherical_direction(0.3f, 0.0f), spherical_direction(0.8f, 0.0f),
                                   spherical_direction(1.4f, 0.0f)};
  const Wavelengths w = sample_wavelengths(0.5f);
  float brightest = 0;
  for (PreparedLobe& lobe : lobes) {
    float albedo = 0;
    const BsdfLobe<float, 4> resolved = resolve(lobe, {0.5f, 0.5f}, w);
    for (std::uint32_t i = 0; i < n; ++i) {
      SobolSampler sampler(0, 0, i);
      const float u_lobe = sampler.next_1d();
      const auto s = resolved.sample(views[i % views.size()], u_lobe, sampler.next_2d());
      if (s.pdf > 0) albedo += average(s.f) * std::abs(s.wi.z) / s.pdf / n;
    }
    lobe.selection = lobe.weight * albedo;
    brightest = std::max(brightest, lobe.selection);
  }
  // No lobe is forgotten: it may be bright elsewhere, at other angles or under another texel.
  for (PreparedLobe& lobe : lobes)
    lobe.selection = brightest > 0 ? lobe.selection + 0.05f * brightest : 1;
}

void MaterialTable::map_normal(const Material& material, const Surface& surface, const Vec3f& wo,
                               SurfaceBsdf& result) {
  if (!material.normal_map && !material.bump_map) return;
  Vec3f n;
  if (material.normal_map) {
    const Vec3f c = material.normal_map->eval_raw(surface.uv);
    n = {2 * c.x - 1, 2 * c.y - 1, 2 * c.z - 1};
  } else {
    const Vec2f slope = material.bump_map->gradient(surface.uv);
    n = bumped_normal(surface, {slope.x * material.bump_scale, slope.y * material.bump_scale});
  }
  if (!(length_squared(n) > 1e-12f)) return;
  if (material.normal_mapping == NormalMapping::microfacet) {
    // From behind, a bump is a dent: the local frame of that side has its z reversed.
    result.wedge_.emplace(normalize(Vec3f{n.x * result.side_, n.y * result.side_, n.z}));
    return;
  }
  // A normal that the viewer sees from behind is turned about the surface's own: otherwise black spots
  // (Schuessler et al. 2017, section 3, names the problem; this is Mitsuba 3's answer).
  const Vec3f o = surface.frame.to_local(wo);
  if (o.z * dot(o, n) <= 0) n = {-n.x, -n.y, n.z};
  result.frame_ = Frame<float>::with_tangent(surface.frame.to_world(normalize(n)), surface.frame.s);
  result.bump_alpha2_ = std::min(0.125f * tan2_theta(n), 1.0f);
}

SurfaceBsdf MaterialTable::resolve(const Surface& surface, const Vec3f& wo, const Wavelengths& w) const {
  SurfaceBsdf result;
  result.frame_ = surface.frame;
  result.shading_normal_ = surface.frame.n;
  result.viewer_ = wo;
  if (surface.material < 0) return result;
  const Prepared& prepared = materials_[std::size_t(surface.material)];
  const Material& material = *prepared.material;

  if (material.opacity) result.opacity_ = clamp(scalar_at(*material.opacity, surface.uv), 0.0f, 1.0f);
  if (material.two_sided && dot(surface.frame.n, wo) < 0) result.side_ = -1;
  map_normal(material, surface, wo, result);
  result.wo_ = result.to_local(wo);
  result.eta_ = prepared.eta;

  for (const PreparedLobe& lobe : prepared.lobes)
    if (lobe.weight > 0) result.bsdf_.add(resolve(lobe, surface.uv, w), lobe.weight, lobe.selection);
  return result;
}

} // namespace nacre

#pragma once
// The laws, one function each; what they share of directions and words.

#include "validate/validate.h"

namespace nacre {

using Rgb = Spectrum<double, 3>;
using WoWi = std::pair<Vec3d, Vec3d>; ///< wo, wi

double theta_deg(const Vec3d& w);
/// Puts the pair into the law as its worst, with the command that shows its value again.
void point_at(LawResult& law, const std::string& material, const Vec3d& wo, const Vec3d& wi);
/// The same for what is asked of a view: the azimuth is named where there are several.
void point_at(LawResult& law, const std::string& material, const Vec3d& wo,
              const std::vector<double>& azimuths);
/// Uniform in [0, 1), a function of its arguments.
double random_unit(std::uint64_t seed, std::uint64_t index, std::uint64_t dimension);
/// (eta on w_to's side / eta on w_from's side)^2: what radiance gains by refraction from one to the other.
double compression(const Sides& sides, const Vec3d& w_from, const Vec3d& w_to);

/// Where a viewer stands around the normal to judge the material: one azimuth where it is the same all
/// around; else along the tangent and the bitangent and between them too: over a circle, over half of it
/// where half a turn changes nothing, over a quarter where its mirror image is the same besides. By what eval
/// and pdf answer some thousand pairs of directions; the means of random walks by their pdf alone.
std::vector<double> judged_azimuths(const Scattering& bsdf, std::uint64_t seed);

/// @throws Error if the validation is not to go on
void check_stopped(const ValidateOptions& options);

/// All pairs of directions where formulas break: grazing, normal, mirror, retro, opposite half vectors, below
/// the horizon and in it.
std::vector<WoWi> adversarial_pairs();
/// Random ones: uniform, a quarter near the horizon, a quarter near the mirror direction.
std::vector<WoWi> random_pairs(int count, std::uint64_t seed);

LawResult finiteness(const Scattering& bsdf, const std::string& name, const std::vector<WoWi>& pairs);
LawResult positivity(const Scattering& bsdf, const std::string& name, const std::vector<WoWi>& pairs);
/// |f(o, i) - f(i, o)| over their mean, in transmission with eta^2, of the worst channel.
double reciprocity_departure(const Scattering& bsdf, const Sides& sides, const Vec3d& wo, const Vec3d& wi);
LawResult reciprocity(const Scattering& bsdf, const std::string& name, const Sides& sides,
                      const std::vector<WoWi>& pairs);
/// The means of many estimates, each from a pair turned by a rounding.
LawResult reciprocity_of_estimates(const Scattering& bsdf, const std::string& name, const Sides& sides,
                                   const std::vector<WoWi>& pairs);
LawResult continuity(const Scattering& bsdf, const std::string& name, const ValidateOptions& options);

/// Energy, pdf and sampling, and the albedos; at these azimuths of the viewer.
void sampling_laws(const Scattering& bsdf, const std::string& name, const Sides& sides,
                   const std::vector<double>& azimuths, const ValidateOptions& options,
                   ValidationReport& report);

/// Normalisation of D, the projected area, the weak white furnace, and the energy lost to single scattering.
std::vector<LawResult> facet_laws(const FacetSurface& facets, const Scattering& bsdf, const std::string& name,
                                  const std::vector<double>& azimuths, const ValidateOptions& options);

/// What can be asked only of a model whose parameters can be varied: finite values at the corners of its
/// domain, channels that do not mix, equal indices that reflect nothing.
std::vector<LawResult> parameter_laws(const MaterialSpec& material, const ValidateOptions& options);

} // namespace nacre

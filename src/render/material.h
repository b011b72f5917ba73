#pragma once
// A material at a point: every parameter looked up at this place and these wavelengths, the result a plain
// value on the stack that answers eval, pdf and sample for world directions.

#include "measured/bsdf.h"
#include "render/surface.h"
#include "render/wedge_walk.h"
#include "spectra/wavelengths.h"

#include <optional>

namespace nacre {

/// How a point scatters light towards one viewer.
class SurfaceBsdf {
public:
  struct Sample {
    Vec3f wi;               ///< world
    SampledSpectrum weight; ///< f |cos| / pdf
    float pdf = 0;          ///< 1/sr; 0: the path ends here. Of a delta direction, meaningless but positive
    bool is_delta = false;
    float eta2 = 1; ///< (index behind / index before)^2 of the refraction on this path step, else 1
  };

  /// f |cos theta_i| for light from the world direction `wi`, without delta directions.
  SampledSpectrum eval(const Vec3f& wi) const;
  /// 1/sr
  float pdf(const Vec3f& wi) const;
  Sample sample(float u_lobe, Vec2f u) const;

private:
  friend class MaterialTable;
  Vec3f to_local(const Vec3f& w) const {
    const Vec3f l = frame_.to_local(w);
    return {l.x, l.y, l.z * side_};
  }
  /// A normal map turns the frame; a direction must not change sides by that.
  bool consistent(const Vec3f& wi, float local_z) const {
    return dot(shading_normal_, wi) * local_z * side_ > 0;
  }

  /// Share of the light from `wi` that a rough surface as bumpy as the normal map lets through; without it
  /// light would end in a hard line where the map's normals still face it. Conty Estevez, Lecocq, Stein 2019,
  /// A Microfacet-Based Shadowing Function to Solve the Bump Terminator Problem, eq. 2 and 3.
  float shadowing(const Vec3f& wi) const;

  Bsdf<float, 4> bsdf_;
  /// Under a normal map of facets: then the frame is not turned.
  std::optional<NormalWedge<float>> wedge_;
  Frame<float> frame_;   ///< turned by the normal map
  Vec3f shading_normal_; ///< before the normal map
  Vec3f viewer_, wo_;    ///< towards the viewer: world, and local
  float side_ = 1;       ///< -1 where a two-sided material is seen from behind
  float opacity_ = 1;
  float eta_ = 1;         ///< inside / outside, of the lobe that transmits
  float bump_alpha2_ = 0; ///< squared roughness of that surface; 0 without a normal map
};

/// The materials of a scene, with everything prepared that does not vary.
class MaterialTable {
public:
  /// Keeps a reference to the scene. @throws Error naming the material, its model and parameter if a value is
  /// not finite or outside its domain, a lobe has the wrong number of parameters, or there are too many lobes
  explicit MaterialTable(const Scene& scene);

  /// The material of `surface`, seen from the world direction `wo`. Material -1 absorbs all light.
  SurfaceBsdf resolve(const Surface& surface, const Vec3f& wo, const Wavelengths& wavelengths) const;

private:
  /// A parameter that is looked up at each hit.
  struct Varying {
    int begin; ///< place in the parameter vector
    bool per_channel;
    float lo, hi; ///< domain; textures are clamped to it
    const ParameterSource* source;
  };
  struct PreparedLobe {
    int model; ///< in the closed list, or -1: measured
    const MeasuredBsdf* measured;
    float weight;
    float selection; ///< how often it is sampled, relative to the material's other lobes
    int count;       ///< numbers of the parameter vector
    std::array<float, max_parameter_numbers<4>> values; ///< the parameter vector, constants filled in
    std::vector<Varying> varying;
  };
  struct Prepared {
    const Material* material;
    std::vector<PreparedLobe> lobes;
    float eta = 1;
  };
  /// The lobe with every parameter looked up.
  static BsdfLobe<float, 4> resolve(const PreparedLobe& lobe, Vec2f uv, const Wavelengths& wavelengths);
  /// Lobes of a sum are sampled in proportion to their albedo.
  static void choose_by_albedo(std::vector<PreparedLobe>& lobes);
  /// The frame turned by the map, or the facets instead.
  static void map_normal(const Material& material, const Surface& surface, const Vec3f& wo,
                         SurfaceBsdf& result);
  static PreparedLobe prepare(const Lobe& lobe, const Material& material, float& eta);

  std::vector<Prepared> materials_;
};

} // namespace nacre

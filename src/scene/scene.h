#pragma once
// The description of a scene, as data: what a reader writes and the renderer turns into immutable render
// data. World space, metres or whatever the file's unit is, y or z up as the file has it.

#include "core/vec.h"
#include "scene/texture.h"
#include "scene/transform.h"
#include "spectra/spectrum_source.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace nacre {

class MeasuredBsdf;

/// What a lobe of measured scattering names in place of a model.
inline constexpr std::string_view measured_lobe = "measured";

/// One scattering model with the sources of its parameters.
struct Lobe {
  std::string model;                       ///< a name of the closed list (bsdf/list.h), or measured_lobe
  std::vector<ParameterSource> parameters; ///< in the order the model declares them; empty for a measurement
  std::shared_ptr<const MeasuredBsdf> measured;
  float weight = 1; ///< the lobe's f is multiplied by it
};

/// What a perturbed normal does to a material.
enum class NormalMapping {
  turned_frame, ///< the frame of the lobes is turned, and a rough surface's shadowing hides what would end in
                ///< a hard line; loses light where the map is steep. As Mitsuba 3 has it
  microfacet    ///< a facet along the normal and an upright mirror; keeps all light, for lobes that reflect
};

/// A material: a sum of lobes, seen through modifiers.
struct Material {
  std::string id; ///< as the file names it, for messages
  std::vector<Lobe> lobes;
  bool two_sided = false;                    ///< the back looks like the front
  std::optional<ParameterSource> opacity;    ///< share that is there; light goes straight through the rest
  std::shared_ptr<const Texture> normal_map; ///< tangent-space normals stored as (n + 1) / 2, or null
  std::shared_ptr<const Texture> bump_map;   ///< heights along the normal, or null; not with a normal map
  float bump_scale = 1;                      ///< from the bump map's values to units of the scene
  NormalMapping normal_mapping = NormalMapping::turned_frame;
};

/// Triangles. Positions and normals are already in world space (object space inside a group).
struct TriangleMesh {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals; ///< empty, or one a vertex, unit length: smooth shading
  std::vector<Vec2f> uvs;     ///< empty, or one a vertex
  std::vector<std::array<std::uint32_t, 3>> triangles;
};
struct Sphere {
  Vec3f center{0, 0, 0};
  float radius = 1;
  Transform to_world; ///< gives uv their orientation; scales `radius` uniformly (folded into radius already)
  bool flip_normals = false; ///< normals point inwards
};
/// Flat parallelogram corner + s edge_u + t edge_v with (s, t) in [0,1]^2 = (u, v); normal along edge_u x
/// edge_v.
struct Quad {
  Vec3f corner, edge_u, edge_v;
};
struct Disk {
  Transform to_world; ///< of the unit disk z = 0 with normal +z
};
struct Cylinder {
  Transform to_world; ///< of the cylinder of radius 1 from z = 0 to 1, normals outwards
  bool flip_normals = false;
};

struct Shape {
  std::string id; ///< for messages
  std::variant<TriangleMesh, Sphere, Quad, Disk, Cylinder> geometry;
  int material = -1;                       ///< index into Scene::materials
  std::optional<ParameterSource> emission; ///< radiance in W/(m^2 sr nm) on the side the normal points to
};

/// Shapes described once and placed many times. Shapes of a group do not emit.
struct Group {
  std::string id;
  std::vector<Shape> shapes;
};
struct Instance {
  int group;
  Transform to_world;
};

struct Camera {
  enum class Projection { perspective, orthographic };
  enum class FovAxis { x, y, diagonal, smaller, larger };
  Projection projection = Projection::perspective;
  Transform to_world; ///< +z forward, +y up, +x left
  double fov_deg = 50;
  FovAxis fov_axis = FovAxis::x;
  double near_clip = 1e-2, far_clip = 1e4;
};

struct PointLight {
  Vec3f position;
  SpectrumSource intensity; ///< W/(sr nm)
};
struct SpotLight {
  Transform to_world; ///< shines along +z from the origin
  SpectrumSource intensity;
  float cutoff_rad,
      beam_width_rad; ///< full intensity inside beam_width, linear in angle to 0 at cutoff (Mitsuba 3)
  /// Multiplies the intensity, or null. Looked up at (u, v) = 1/2 + (x, y) / (2 z tan(cutoff)) in light space
  /// (Mitsuba 3), for cutoffs below 90 degrees.
  std::shared_ptr<const Texture> picture;
};
/// A camera that shines: the light that leaves through a point of its film is what the picture has there.
struct ProjectorLight {
  Camera lens; ///< a perspective whose film has the picture's shape; to_world is rigid; nothing is clipped
  /// Times `scale` the radiance, W/(m^2 sr nm), that a white diffuse screen at distance 1 and parallel to the
  /// film shows: pi times it is the irradiance there, everywhere on the screen (Mitsuba 3).
  std::shared_ptr<const Texture> picture;
  float scale = 1;
};
struct DirectionalLight {
  Vec3f direction;           ///< unit; the way the light travels
  SpectrumSource irradiance; ///< on a plane perpendicular to it, W/(m^2 nm)
};
struct ConstantLight {
  SpectrumSource radiance;
};
/// Latitude-longitude map; Mitsuba's orientation: in light space up is +y, u = atan2(x, -z) / 2pi (mod 1) and
/// v = acos(y) / pi. Texel (i, j) is centred at u = (i + 1/2) / width, v = j / (height - 1).
struct EnvironmentLight {
  std::shared_ptr<const Image> radiance; ///< linear sRGB, row 0 at +y
  Transform to_world;
  float scale = 1;
};
using Light =
    std::variant<PointLight, SpotLight, ProjectorLight, DirectionalLight, ConstantLight, EnvironmentLight>;

enum class FilterKind { box, tent, gaussian, mitchell, catmull_rom, lanczos };

struct Film {
  int width = 768, height = 576;
  FilterKind filter = FilterKind::gaussian;
  float filter_radius = 0;   ///< pixels; 0 is the filter's own default
  float filter_stddev = 0.5; ///< gaussian alone
};

/// Which directions find the light of what is not a delta: those the surface chooses, those that lights
/// choose, or both, weighted by multiple importance sampling. All three give the same picture, with different
/// noise.
enum class LightFinding { both, bsdf, lights };

struct IntegratorSettings {
  std::string name = "path"; ///< path or direct
  int max_depth = -1; ///< longest path in edges, camera edge included; 1 sees only emission; -1 unlimited
  int russian_roulette_depth = 5; ///< vertices after which paths are ended at random
  bool hide_emitters = false;
  LightFinding light_finding = LightFinding::both;
};

struct Scene {
  std::string file;
  Camera camera;
  Film film;
  IntegratorSettings integrator;
  int samples_per_pixel = 16;
  std::string sampler = "sobol"; ///< sobol or independent
  std::vector<Material> materials;
  std::vector<Shape> shapes;
  std::vector<Group> groups;
  std::vector<Instance> instances;
  std::vector<Light> lights;
  std::vector<std::string> warnings; ///< what the reader could not honour but the picture survives
};

} // namespace nacre

#include "scene/teapot.h"

#include "core/error.h"

#include <array>
#include <fmt/format.h>
#include <utility>
#include <vector>

namespace nacre {
namespace {

// What Newell measured, z up: profiles that are turned about the axis, and two tubes with a plane of
// symmetry. The numbers are those of the pot as it is drawn since Blinn divided its heights by 1.3; the
// bottom is Crow's.

struct ProfilePoint {
  float r, z;
};
using Profile = std::array<ProfilePoint, 4>;
constexpr std::array<Profile, 6> profiles{{
    {{{1.4f, 2.4f}, {1.3375f, 2.53125f}, {1.4375f, 2.53125f}, {1.5f, 2.4f}}}, // rim
    {{{1.5f, 2.4f}, {1.75f, 1.875f}, {2, 1.35f}, {2, 0.9f}}},                 // body
    {{{2, 0.9f}, {2, 0.45f}, {1.5f, 0.225f}, {1.5f, 0.15f}}},
    {{{1.5f, 0.15f}, {1.5f, 0.075f}, {1.425f, 0}, {0, 0}}},      // bottom
    {{{0, 3.15f}, {0.8f, 3.15f}, {0, 2.85f}, {0.2f, 2.7f}}},     // knob
    {{{0.2f, 2.7f}, {0.4f, 2.55f}, {1.3f, 2.55f}, {1.3f, 2.4f}}} // lid
}};

/// A ring of a tube: where its inner and its outer side meet the plane y = 0, and its half width there.
struct Ring {
  float inner_x, inner_z, outer_x, outer_z, width;
};
using Tube = std::array<Ring, 7>; ///< two patches in a row, which share the fourth ring
constexpr std::array<Tube, 2> tubes{{{{{-1.6f, 2.025f, -1.5f, 2.25f, 0.3f}, // handle
                                       {-2.3f, 2.025f, -2.5f, 2.25f, 0.3f},
                                       {-2.7f, 2.025f, -3, 2.25f, 0.3f},
                                       {-2.7f, 1.8f, -3, 1.8f, 0.3f},
                                       {-2.7f, 1.575f, -3, 1.35f, 0.3f},
                                       {-2.5f, 1.125f, -2.65f, 0.9375f, 0.3f},
                                       {-2, 0.9f, -1.9f, 0.6f, 0.3f}}},
                                     {{{1.7f, 1.425f, 1.7f, 0.6f, 0.66f}, // spout
                                       {2.6f, 1.425f, 3.1f, 0.825f, 0.66f},
                                       {2.3f, 2.1f, 2.4f, 2.025f, 0.25f},
                                       {2.7f, 2.4f, 3.3f, 2.4f, 0.25f},
                                       {2.8f, 2.475f, 3.525f, 2.49375f, 0.25f},
                                       {2.9f, 2.475f, 3.45f, 2.5125f, 0.15f},
                                       {2.8f, 2.4f, 3.2f, 2.4f, 0.15f}}}}};

/// Four rows of four control points, +y up.
using Patch = std::array<std::array<Vec3f, 4>, 4>;

Vec3f y_up(float x, float y, float z) { return {x, z, -y}; }

/// A quarter of a turn about the axis, from the direction (x, y) on. Newell's circles are cubics whose inner
/// control points lie at 0.56 of the radius; he rounded those of the knob to 0.45, which are 0.448 here.
Patch turned(const Profile& profile, float x, float y) {
  constexpr float bend = 0.56f;
  Patch patch;
  for (std::size_t row = 0; row < 4; ++row) {
    const auto [r, z] = profile[row];
    const float u[] = {1, 1, bend, 0}, v[] = {0, bend, 1, 1};
    for (std::size_t k = 0; k < 4; ++k) // clockwise, seen from above
      patch[row][k] = y_up(r * (u[k] * x + v[k] * y), r * (u[k] * y - v[k] * x), z);
  }
  return patch;
}

/// Half of a tube between four rings, on the side of y < 0 or y > 0.
Patch half_tube(const Ring* rings, bool positive) {
  Patch patch;
  for (std::size_t row = 0; row < 4; ++row) {
    const Ring& r = rings[row];
    const float y = positive ? r.width : -r.width;
    patch[row] = {y_up(r.inner_x, 0, r.inner_z), y_up(r.inner_x, y, r.inner_z), y_up(r.outer_x, y, r.outer_z),
                  y_up(r.outer_x, 0, r.outer_z)};
    if (positive) std::swap(patch[row][0], patch[row][3]), std::swap(patch[row][1], patch[row][2]);
  }
  return patch;
}

std::vector<Patch> control_points() {
  std::vector<Patch> patches;
  for (const Profile& profile : profiles)
    for (const auto& [x, y] : {std::pair{1.0f, 0.0f}, {0.0f, -1.0f}, {-1.0f, 0.0f}, {0.0f, 1.0f}})
      patches.push_back(turned(profile, x, y));
  for (const Tube& tube : tubes)
    for (const std::size_t first : {0u, 3u})
      for (const bool positive : {false, true})
        patches.push_back(half_tube(&tube[first], positive));
  return patches;
}

/// Bernstein polynomials of degree 3 at t, and their derivatives.
struct Bernstein {
  std::array<float, 4> value, slope;
  explicit Bernstein(float t) {
    const float s = 1 - t;
    value = {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
    slope = {-3 * s * s, 3 * s * s - 6 * s * t, 6 * s * t - 3 * t * t, 3 * t * t};
  }
};

} // namespace

TriangleMesh teapot_mesh(int segments) {
  if (segments < 1 || segments > 256)
    throw Error(fmt::format("a patch of the teapot has 1 to 256 segments, not {}", segments));
  TriangleMesh mesh;
  const auto n = std::uint32_t(segments);
  for (const Patch& patch : control_points()) {
    const auto first = std::uint32_t(mesh.positions.size());
    for (std::uint32_t iu = 0; iu <= n; ++iu)
      for (std::uint32_t iv = 0; iv <= n; ++iv) {
        const float u = float(iu) / float(n), v = float(iv) / float(n);
        Vec3f p{0, 0, 0}, du{0, 0, 0}, dv{0, 0, 0};
        const auto at = [&](float s, float t) {
          const Bernstein bs(s), bt(t);
          du = dv = {0, 0, 0};
          for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = 0; j < 4; ++j) {
              du += patch[i][j] * (bs.slope[i] * bt.value[j]);
              dv += patch[i][j] * (bs.value[i] * bt.slope[j]);
            }
        };
        const Bernstein bu(u), bv(v);
        for (std::size_t i = 0; i < 4; ++i)
          for (std::size_t j = 0; j < 4; ++j)
            p += patch[i][j] * (bu.value[i] * bv.value[j]);
        at(u, v);
        Vec3f normal = cross(dv, du);
        if (length(normal) < 1e-6f) {
          // An edge of the patch is one point, at the top and the bottom: a little inside there is a normal.
          at(clamp(u, 1e-3f, 0.999f), clamp(v, 1e-3f, 0.999f));
          normal = cross(dv, du);
        }
        mesh.positions.push_back(p);
        mesh.normals.push_back(normalize(normal));
        mesh.uvs.push_back({u, v});
      }
    for (std::uint32_t iu = 0; iu < n; ++iu)
      for (std::uint32_t iv = 0; iv < n; ++iv) {
        const std::uint32_t a = first + iu * (n + 1) + iv, b = a + n + 1;
        mesh.triangles.push_back({a, a + 1, b + 1});
        mesh.triangles.push_back({a, b + 1, b});
      }
  }
  return mesh;
}

} // namespace nacre

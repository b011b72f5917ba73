// What the wrapper around Embree costs: the same rays through Accel and through bare Embree calls on the same
// geometry, one at a time and in packets of 16. items_per_second is rays a second on one core.

#include "ball_in_room.h"
#include "core/random.h"
#include "core/warp.h"
#include "render/accel.h"
#include "render/camera.h"
#include "render/surface.h"

#include <benchmark/benchmark.h>
#include <embree3/rtcore.h>

namespace nacre {
namespace {

/// The scene, and rays of each kind: from the camera in tiles of 4 x 4 pixels, from the points they hit to
/// the light, and from there diffusely onwards.
struct Fixture {
  Scene scene = bench::ball_in_room();
  Accel accel{scene};
  std::vector<Ray> camera, shadow, diffuse;

  Fixture() {
    Film film;
    film.width = film.height = 512;
    const CameraRays rays(scene.camera, film);
    const SurfaceTable surfaces(scene);
    for (int tile = 0; tile < 128 * 128; ++tile)
      for (int i = 0; i < 16; ++i)
        camera.push_back(
            rays.ray(float(tile % 128 * 4 + i % 4) + 0.5f, float(tile / 128 * 4 + i / 4) + 0.5f));
    for (std::size_t i = 0; i < camera.size(); ++i) {
      Hit hit;
      if (!accel.intersect(camera[i], hit)) continue;
      const Surface s = surfaces.at(camera[i], hit);
      const Vec2f u{uniform(1, 0, i, 0), uniform(1, 0, i, 1)};
      const Vec3f target{u.x - 0.5f, u.y - 0.5f, 2.88f};
      Ray to_light = s.spawn(target - s.p);
      to_light.t_max = 1;
      shadow.push_back(to_light);
      const Vec3f n = dot(s.ng, camera[i].direction) < 0 ? s.ng : -s.ng;
      diffuse.push_back(s.spawn(Frame<float>::around(n).to_world(square_to_cosine_hemisphere(u))));
    }
  }
  const std::vector<Ray>& rays(int kind) const { return kind == 0 ? camera : kind == 1 ? diffuse : shadow; }
};
const Fixture& fixture() {
  static const Fixture f;
  return f;
}

/// The same triangles and quads, handed to Embree by hand.
struct Bare {
  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene scene = rtcNewScene(device);

  Bare() {
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    for (const Shape& shape : fixture().scene.shapes) {
      const auto* mesh = std::get_if<TriangleMesh>(&shape.geometry);
      const auto* quad = std::get_if<Quad>(&shape.geometry);
      RTCGeometry g = rtcNewGeometry(device, mesh ? RTC_GEOMETRY_TYPE_TRIANGLE : RTC_GEOMETRY_TYPE_QUAD);
      const std::vector<Vec3f> corners =
          mesh ? mesh->positions
               : std::vector<Vec3f>{quad->corner, quad->corner + quad->edge_u,
                                    quad->corner + quad->edge_u + quad->edge_v, quad->corner + quad->edge_v};
      auto* v = static_cast<Vec3f*>(
          rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, corners.size()));
      std::copy(corners.begin(), corners.end(), v);
      if (mesh) {
        auto* t = static_cast<std::array<std::uint32_t, 3>*>(rtcSetNewGeometryBuffer(
            g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh->triangles.size()));
        std::copy(mesh->triangles.begin(), mesh->triangles.end(), t);
      } else {
        auto* t = static_cast<std::uint32_t*>(
            rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 16, 1));
        for (std::uint32_t i = 0; i < 4; ++i)
          t[i] = i;
      }
      rtcCommitGeometry(g);
      rtcAttachGeometry(scene, g);
      rtcReleaseGeometry(g);
    }
    rtcCommitScene(scene);
  }
};
const Bare& bare() {
  static const Bare b;
  return b;
}

void count(benchmark::State& state, const std::vector<Ray>& rays) {
  state.SetItemsProcessed(std::int64_t(state.iterations()) * std::int64_t(rays.size()));
  const char* const names[] = {"camera", "diffuse", "shadow"};
  state.SetLabel(names[state.range(0)]);
}

void accel_single(benchmark::State& state) {
  const Accel& accel = fixture().accel;
  const auto& rays = fixture().rays(int(state.range(0)));
  const bool shadow = state.range(0) == 2;
  for (auto _ : state)
    for (const Ray& ray : rays) {
      Hit hit;
      bool found = shadow ? accel.occluded(ray) : accel.intersect(ray, hit);
      benchmark::DoNotOptimize(found);
      benchmark::DoNotOptimize(hit);
    }
  count(state, rays);
}

void bare_single(benchmark::State& state) {
  const auto& rays = fixture().rays(int(state.range(0)));
  const bool shadow = state.range(0) == 2;
  RTCScene scene = bare().scene;
  for (auto _ : state)
    for (const Ray& r : rays) {
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      RTCRayHit h;
      h.ray = {r.origin.x, r.origin.y, r.origin.z, r.t_min, r.direction.x, r.direction.y, r.direction.z, 0,
               r.t_max,    ~0u,        0,          0};
      h.hit.geomID = h.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      if (shadow)
        rtcOccluded1(scene, &context, &h.ray);
      else
        rtcIntersect1(scene, &context, &h);
      benchmark::DoNotOptimize(h);
    }
  count(state, rays);
}

void accel_packet(benchmark::State& state) {
  const Accel& accel = fixture().accel;
  const auto& rays = fixture().rays(int(state.range(0)));
  std::vector<Hit> hits(rays.size());
  std::vector<std::uint8_t> occluded(rays.size());
  for (auto _ : state) {
    if (state.range(0) == 2)
      accel.occluded(rays, occluded);
    else
      accel.intersect(rays, hits);
    benchmark::ClobberMemory();
  }
  count(state, rays);
}

/// Packets laid out beforehand: the limit that the wrapper's conversion is measured against.
void bare_packet(benchmark::State& state) {
  const auto& rays = fixture().rays(int(state.range(0)));
  const bool shadow = state.range(0) == 2;
  RTCScene scene = bare().scene;
  const std::size_t n = rays.size() / 16;
  std::vector<RTCRay16> packets(n);
  for (std::size_t p = 0; p < n; ++p)
    for (std::size_t i = 0; i < 16; ++i) {
      const Ray& r = rays[p * 16 + i];
      RTCRay16& k = packets[p];
      k.org_x[i] = r.origin.x, k.org_y[i] = r.origin.y, k.org_z[i] = r.origin.z, k.tnear[i] = r.t_min;
      k.dir_x[i] = r.direction.x, k.dir_y[i] = r.direction.y, k.dir_z[i] = r.direction.z, k.time[i] = 0;
      k.tfar[i] = r.t_max, k.mask[i] = ~0u, k.id[i] = 0, k.flags[i] = 0;
    }
  alignas(64) int valid[16];
  std::fill(valid, valid + 16, -1);
  for (auto _ : state)
    for (const RTCRay16& packet : packets) {
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
      alignas(64) RTCRayHit16 h;
      h.ray = packet;
      for (std::size_t i = 0; i < 16; ++i)
        h.hit.geomID[i] = h.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
      if (shadow)
        rtcOccluded16(valid, scene, &context, &h.ray);
      else
        rtcIntersect16(valid, scene, &context, &h);
      benchmark::DoNotOptimize(h);
    }
  count(state, rays);
}

BENCHMARK(accel_single)->DenseRange(0, 2)->Unit(benchmark::kMillisecond);
BENCHMARK(bare_single)->DenseRange(0, 2)->Unit(benchmark::kMillisecond);
BENCHMARK(accel_packet)->DenseRange(0, 2)->Unit(benchmark::kMillisecond);
BENCHMARK(bare_packet)->DenseRange(0, 2)->Unit(benchmark::kMillisecond);

} // namespace
} // namespace nacre

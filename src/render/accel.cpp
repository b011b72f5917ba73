#include "render/accel.h"

#include "core/error.h"
#include "render/quadric.h"

#include <embree3/rtcore.h>

#include <cstring>
#include <deque>

namespace nacre {
namespace {

struct DeviceDeleter {
  void operator()(RTCDevice d) const { rtcReleaseDevice(d); }
};
struct SceneDeleter {
  void operator()(RTCScene s) const { rtcReleaseScene(s); }
};
struct GeometryDeleter {
  void operator()(RTCGeometry g) const { rtcReleaseGeometry(g); }
};
using Device = std::unique_ptr<RTCDeviceTy, DeviceDeleter>;
using SceneHandle = std::unique_ptr<RTCSceneTy, SceneDeleter>;
using Geometry = std::unique_ptr<RTCGeometryTy, GeometryDeleter>;

void check(RTCDevice device, const std::string& doing) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  throw Error(doing + ": " +
              (error == RTC_ERROR_OUT_OF_MEMORY ? "out of memory"
                                                : "ray tracing kernel error " + std::to_string(int(error))));
}

/// Calls f(i, ray) for each active ray of a packet that Embree passes to a quadric.
template <class Args, class F>
void for_active(const Args* args, RTCRayN* rays, F f) {
  for (unsigned i = 0; i < args->N; ++i) {
    if (!args->valid[i]) continue;
    const RTCRay r = rtcGetRayFromRayN(rays, args->N, i);
    f(i, Ray{{r.org_x, r.org_y, r.org_z}, r.tnear, {r.dir_x, r.dir_y, r.dir_z}, r.tfar});
  }
}

void quadric_bounds(const RTCBoundsFunctionArguments* args) {
  const auto& q = *static_cast<const Quadric*>(args->geometryUserPtr);
  const auto box = q.bounds();
  *args->bounds_o = {box.lo.x, box.lo.y, box.lo.z, 0, box.hi.x, box.hi.y, box.hi.z, 0};
}
void quadric_intersect(const RTCIntersectFunctionNArguments* args) {
  const auto& q = *static_cast<const Quadric*>(args->geometryUserPtr);
  const unsigned n = args->N;
  RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, n);
  RTCHitN* hits = RTCRayHitN_HitN(args->rayhit, n);
  for_active(args, rays, [&](unsigned i, const Ray& ray) {
    Hit hit;
    if (!q.intersect(ray, hit)) return;
    RTCRayN_tfar(rays, n, i) = hit.t;
    RTCHitN_u(hits, n, i) = hit.u;
    RTCHitN_v(hits, n, i) = hit.v;
    RTCHitN_primID(hits, n, i) = 0;
    RTCHitN_geomID(hits, n, i) = args->geomID;
    RTCHitN_instID(hits, n, i, 0) = args->context->instID[0];
  });
}
void quadric_occluded(const RTCOccludedFunctionNArguments* args) {
  const auto& q = *static_cast<const Quadric*>(args->geometryUserPtr);
  for_active(args, args->ray, [&](unsigned i, const Ray& ray) {
    Hit hit;
    if (q.intersect(ray, hit)) RTCRayN_tfar(args->ray, args->N, i) = -infinity;
  });
}

} // namespace

struct Accel::Built {
  Device device;
  std::deque<Quadric> quadrics; ///< addresses stay
  std::vector<SceneHandle> groups;
  SceneHandle scene;
  std::uint32_t shape_count = 0; ///< geometries from here on are instances
  Vec3f center{0, 0, 0};
  float radius = 0;

  explicit Built(const Scene& s);
  SceneHandle new_scene() const;
  void attach(RTCScene to, const Shape& shape, unsigned id);
  Geometry make(const TriangleMesh& mesh, const Shape& shape);
  Geometry make(const Quad& quad, const Shape& shape);
  Geometry make_quadric(Quadric quadric);
  Hit to_hit(const RTCHit& h, float t) const;
};

SceneHandle Accel::Built::new_scene() const {
  SceneHandle s(rtcNewScene(device.get()));
  rtcSetSceneFlags(s.get(), RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(s.get(), RTC_BUILD_QUALITY_HIGH);
  return s;
}

Geometry Accel::Built::make(const TriangleMesh& mesh, const Shape& shape) {
  if (mesh.positions.size() >= Hit::none || mesh.triangles.size() >= Hit::none)
    throw Error("shape '" + shape.id + "': too many vertices or triangles");
  Geometry g(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
  if (mesh.triangles.empty() || mesh.positions.empty()) return g;
  void* positions = rtcSetNewGeometryBuffer(g.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                            sizeof(Vec3f), mesh.positions.size());
  void* triangles = rtcSetNewGeometryBuffer(g.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            3 * sizeof(std::uint32_t), mesh.triangles.size());
  check(device.get(), "shape '" + shape.id + "'");
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const std::uint32_t v : mesh.triangles[i])
      if (v >= mesh.positions.size())
        throw Error("shape '" + shape.id + "': triangle " + std::to_string(i) + " names vertex " +
                    std::to_string(v) + " of " + std::to_string(mesh.positions.size()));
  std::memcpy(positions, mesh.positions.data(), mesh.positions.size() * sizeof(Vec3f));
  std::memcpy(triangles, mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]));
  return g;
}

Geometry Accel::Built::make(const Quad& q, const Shape&) {
  Geometry g(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_QUAD));
  auto* corners = static_cast<Vec3f*>(
      rtcSetNewGeometryBuffer(g.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f), 4));
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      g.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 4 * sizeof(std::uint32_t), 1));
  corners[0] = q.corner;
  corners[1] = q.corner + q.edge_u;
  corners[2] = q.corner + q.edge_u + q.edge_v;
  corners[3] = q.corner + q.edge_v;
  for (std::uint32_t i = 0; i < 4; ++i)
    indices[i] = i;
  return g;
}

Geometry Accel::Built::make_quadric(Quadric quadric) {
  quadrics.push_back(std::move(quadric));
  Geometry g(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_USER));
  rtcSetGeometryUserPrimitiveCount(g.get(), 1);
  rtcSetGeometryUserData(g.get(), &quadrics.back());
  rtcSetGeometryBoundsFunction(g.get(), quadric_bounds, nullptr);
  rtcSetGeometryIntersectFunction(g.get(), quadric_intersect);
  rtcSetGeometryOccludedFunction(g.get(), quadric_occluded);
  return g;
}

void Accel::Built::attach(RTCScene to, const Shape& shape, unsigned id) {
  const Geometry g = std::visit(
      [&](const auto& geometry) {
        using T = std::decay_t<decltype(geometry)>;
        if constexpr (std::is_same_v<T, TriangleMesh> || std::is_same_v<T, Quad>)
          return make(geometry, shape);
        else
          return make_quadric(Quadric(geometry));
      },
      shape.geometry);
  rtcCommitGeometry(g.get());
  rtcAttachGeometryByID(to, g.get(), id);
  check(device.get(), "shape '" + shape.id + "'");
}

Accel::Built::Built(const Scene& s) : device(rtcNewDevice(nullptr)) {
  if (!device) check(nullptr, "cannot start the ray tracing kernels");
  for (const Group& group : s.groups) {
    groups.push_back(new_scene());
    for (std::size_t i = 0; i < group.shapes.size(); ++i)
      attach(groups.back().get(), group.shapes[i], unsigned(i));
    rtcCommitScene(groups.back().get());
    check(device.get(), "group '" + group.id + "'");
  }
  scene = new_scene();
  shape_count = std::uint32_t(s.shapes.size());
  for (std::size_t i = 0; i < s.shapes.size(); ++i)
    attach(scene.get(), s.shapes[i], unsigned(i));
  for (std::size_t i = 0; i < s.instances.size(); ++i) {
    const Instance& instance = s.instances[i];
    if (instance.group < 0 || std::size_t(instance.group) >= groups.size())
      throw Error("instance " + std::to_string(i) + " places group " + std::to_string(instance.group) +
                  " of " + std::to_string(groups.size()));
    const Geometry g(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
    rtcSetGeometryInstancedScene(g.get(), groups[std::size_t(instance.group)].get());
    float rows[12];
    for (std::size_t k = 0; k < 12; ++k)
      rows[k] = float(instance.to_world.m[k / 4][k % 4]);
    rtcSetGeometryTransform(g.get(), 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, rows);
    rtcCommitGeometry(g.get());
    rtcAttachGeometryByID(scene.get(), g.get(), shape_count + unsigned(i));
  }
  rtcCommitScene(scene.get());
  check(device.get(), "building the acceleration structure");
  RTCBounds b;
  rtcGetSceneBounds(scene.get(), &b);
  if (b.lower_x <= b.upper_x) {
    const Vec3f lo{b.lower_x, b.lower_y, b.lower_z}, hi{b.upper_x, b.upper_y, b.upper_z};
    center = (lo + hi) * 0.5f;
    radius = 0.5f * length(hi - lo);
  }
}

Hit Accel::Built::to_hit(const RTCHit& h, float t) const {
  Hit hit;
  if (h.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  hit.t = t;
  hit.u = h.u;
  hit.v = h.v;
  hit.shape = h.geomID;
  hit.primitive = h.primID;
  hit.instance = h.instID[0] == RTC_INVALID_GEOMETRY_ID ? Hit::none : h.instID[0] - shape_count;
  return hit;
}

Accel::Accel(const Scene& scene) : built_(std::make_unique<const Built>(scene)) {}
Accel::~Accel() = default;
Vec3f Accel::center() const { return built_->center; }
float Accel::radius() const { return built_->radius; }

namespace {
RTCRay to_embree(const Ray& r) {
  return {r.origin.x, r.origin.y, r.origin.z, r.t_min, r.direction.x, r.direction.y, r.direction.z, 0,
          r.t_max,    ~0u,        0,          0};
}

constexpr std::size_t packet = 16;

/// Fills lanes [0, n) of a packet.
void to_embree(std::span<const Ray> rays, RTCRay16& p, int* valid) {
  for (std::size_t i = 0; i < packet; ++i) {
    const Ray& r = rays[std::min(i, rays.size() - 1)];
    valid[i] = i < rays.size() ? -1 : 0;
    p.org_x[i] = r.origin.x, p.org_y[i] = r.origin.y, p.org_z[i] = r.origin.z, p.tnear[i] = r.t_min;
    p.dir_x[i] = r.direction.x, p.dir_y[i] = r.direction.y, p.dir_z[i] = r.direction.z, p.time[i] = 0;
    p.tfar[i] = r.t_max, p.mask[i] = ~0u, p.id[i] = 0, p.flags[i] = 0;
  }
}
} // namespace

bool Accel::intersect(const Ray& ray, Hit& hit) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit r;
  r.ray = to_embree(ray);
  r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(built_->scene.get(), &context, &r);
  hit = built_->to_hit(r.hit, r.ray.tfar);
  return bool(hit);
}

bool Accel::occluded(const Ray& ray) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay r = to_embree(ray);
  rtcOccluded1(built_->scene.get(), &context, &r);
  return r.tfar < 0;
}

void Accel::intersect(std::span<const Ray> rays, std::span<Hit> hits) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  for (std::size_t begin = 0; begin < rays.size(); begin += packet) {
    const std::size_t n = std::min(packet, rays.size() - begin);
    alignas(64) RTCRayHit16 p;
    alignas(64) int valid[packet];
    to_embree(rays.subspan(begin, n), p.ray, valid);
    for (std::size_t i = 0; i < packet; ++i)
      p.hit.geomID[i] = p.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect16(valid, built_->scene.get(), &context, &p);
    for (std::size_t i = 0; i < n; ++i) {
      RTCHit h;
      h.u = p.hit.u[i], h.v = p.hit.v[i];
      h.primID = p.hit.primID[i], h.geomID = p.hit.geomID[i], h.instID[0] = p.hit.instID[0][i];
      hits[begin + i] = built_->to_hit(h, p.ray.tfar[i]);
    }
  }
}

void Accel::occluded(std::span<const Ray> rays, std::span<std::uint8_t> occluded) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  for (std::size_t begin = 0; begin < rays.size(); begin += packet) {
    const std::size_t n = std::min(packet, rays.size() - begin);
    alignas(64) RTCRay16 p;
    alignas(64) int valid[packet];
    to_embree(rays.subspan(begin, n), p, valid);
    rtcOccluded16(valid, built_->scene.get(), &context, &p);
    for (std::size_t i = 0; i < n; ++i)
      occluded[begin + i] = p.tfar[i] < 0;
  }
}

} // namespace nacre

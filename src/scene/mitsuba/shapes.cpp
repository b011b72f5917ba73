// Shapes, groups of shapes, and their instances.

#include "core/error.h"
#include "scene/mesh.h"
#include "scene/mitsuba/context.h"

#include <cmath>

namespace nacre::mitsuba {
namespace {

const std::vector<std::string> known_shapes{"obj",  "ply",  "serialized", "sphere",     "rectangle",
                                            "cube", "disk", "cylinder",   "shapegroup", "instance"};

Vec3f single(const Vec3d& v) { return vec3<float>(v); }

void flip_v(TriangleMesh& mesh) {
  for (auto& uv : mesh.uvs)
    uv.y = 1 - uv.y;
}

/// A mesh from a file, as Mitsuba 3 treats it: missing normals become smooth ones after the transform, unless
/// the scene or the file asks for facets.
TriangleMesh mesh_from_file(Context& context, Parameters& p) {
  const std::string path = p.file();
  const bool flip_normals = p.boolean("flip_normals", false);
  const bool flip_uvs = p.boolean("flip_tex_coords", p.type() == "obj");
  bool facets = p.boolean("face_normals", false);
  if (p.find("max_smooth_angle") != nullptr) // Mitsuba 0.x
    context.warn(p.at("max_smooth_angle"),
                 "'max_smooth_angle' is not supported: the mesh keeps the normals it has");
  p.ignore({"srgb"}); // of vertex colours in Mitsuba 0.x, which no material here reads
  const Transform to_world = p.transform();
  TriangleMesh mesh;
  if (p.type() == "serialized") {
    SerializedMesh read = read_serialized(path, p.integer("shape_index", 0));
    facets = facets || read.face_normals;
    mesh = std::move(read.mesh);
  } else {
    mesh = p.type() == "obj" ? read_obj(path) : read_ply(path);
  }
  if (flip_uvs) flip_v(mesh);
  const bool had_normals = !mesh.normals.empty();
  if (facets) mesh.normals.clear();
  located(p.node(), [&] {
    // Faces of a mirrored mesh keep their order where Mitsuba would compute normals from it.
    place_mesh(mesh, to_world, flip_normals);
    return 0;
  });
  if (!facets && !had_normals) complete_vertex_normals(mesh);
  return mesh;
}

TriangleMesh cube(Parameters& p) {
  TriangleMesh mesh = cube_mesh();
  const bool flip = p.boolean("flip_normals", false);
  const Transform to_world = p.transform();
  located(p.node(), [&] { return place_mesh(mesh, to_world, flip), 0; });
  return mesh;
}

Sphere sphere(Parameters& p) {
  Sphere result;
  const Vec3d center = p.vector("center").value_or(Vec3d{0, 0, 0});
  const double radius = p.number("radius", 1);
  if (!(std::abs(radius) > 0)) p.at("radius").fail("the radius must not be 0");
  // A negative radius is Mitsuba's other way to turn a sphere inside out.
  result.flip_normals = p.boolean("flip_normals", false) != (radius < 0);
  const double r = std::abs(radius);
  result.to_world = p.transform() * Transform::translate(center) * Transform::scale({r, r, r});
  const Vec3d x = result.to_world.vector({1, 0, 0}), y = result.to_world.vector({0, 1, 0}),
              z = result.to_world.vector({0, 0, 1});
  const double l = length(x), tolerance = 1e-4 * l;
  if (!(l > 0) || !std::isfinite(l)) p.at("to_world").fail("to_world shrinks the sphere to nothing");
  if (std::abs(length(y) - l) > tolerance || std::abs(length(z) - l) > tolerance ||
      std::abs(dot(x, y)) > tolerance * l || std::abs(dot(y, z)) > tolerance * l ||
      std::abs(dot(z, x)) > tolerance * l)
    p.at("to_world").fail("a sphere's to_world may scale all axes alike, not stretch or shear");
  result.center = single(result.to_world.point({0, 0, 0}));
  result.radius = static_cast<float>(l);
  return result;
}

/// [-1, 1]^2 in the plane z = 0 with normal +z. Where the normal is turned round, by flip_normals or by a
/// mirroring transform, the cross product of the edges cannot give it, so the rectangle becomes two triangles
/// that keep its uv.
std::variant<TriangleMesh, Quad> rectangle(Parameters& p) {
  const bool flip = p.boolean("flip_normals", false);
  const Transform t = p.transform();
  located(p.at("to_world"), [&] { return t.inverse(); });
  if (flip == (t.determinant3() < 0))
    return Quad{single(t.point({-1, -1, 0})), single(t.vector({2, 0, 0})), single(t.vector({0, 2, 0}))};
  TriangleMesh mesh;
  for (const Vec2f& uv : {Vec2f{0, 0}, Vec2f{1, 0}, Vec2f{1, 1}, Vec2f{0, 1}}) {
    mesh.positions.push_back(single(t.point({2.0 * uv.x - 1, 2.0 * uv.y - 1, 0})));
    mesh.uvs.push_back(uv);
  }
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  return mesh;
}

Disk disk(Parameters& p) {
  const bool flip = p.boolean("flip_normals", false);
  const Transform t = p.transform();
  located(p.at("to_world"), [&] { return t.inverse(); });
  return {flip ? t * Transform::scale({1, 1, -1}) : t};
}

Cylinder cylinder(Parameters& p) {
  const Vec3d p0 = p.vector("p0").value_or(Vec3d{0, 0, 0}), p1 = p.vector("p1").value_or(Vec3d{0, 0, 1});
  const double radius = p.number("radius", 1), height = length(p1 - p0);
  if (!(radius > 0)) p.at("radius").fail("the radius must be positive");
  if (!(height > 0)) p.node().fail("the ends p0 and p1 of the cylinder must differ");
  const auto f = Frame<double>::around((p1 - p0) / height);
  Transform axes;
  for (int i = 0; i < 3; ++i) {
    const auto component = [i](const Vec3d& v) { return i == 0 ? v.x : i == 1 ? v.y : v.z; };
    axes.m[i][0] = radius * component(f.s);
    axes.m[i][1] = radius * component(f.t);
    axes.m[i][2] = height * component(f.n);
    axes.m[i][3] = component(p0);
  }
  Cylinder result{p.transform() * axes, p.boolean("flip_normals", false)};
  located(p.at("to_world"), [&] { return result.to_world.inverse(); });
  return result;
}

} // namespace

std::optional<Shape> Context::simple_shape(Parameters& p) {
  Shape shape;
  const std::string& type = p.type();
  if (type == "obj" || type == "ply" || type == "serialized")
    shape.geometry = mesh_from_file(*this, p);
  else if (type == "cube")
    shape.geometry = cube(p);
  else if (type == "sphere")
    shape.geometry = sphere(p);
  else if (type == "rectangle")
    std::visit([&](auto&& g) { shape.geometry = std::move(g); }, rectangle(p));
  else if (type == "disk")
    shape.geometry = disk(p);
  else if (type == "cylinder")
    shape.geometry = cylinder(p);
  else
    return std::nullopt;
  return shape;
}

void Context::finish_shape(Parameters& p, Shape& shape, bool may_emit) {
  shape.id =
      p.node().get("id").empty() ? p.type() + " at " + p.node().location() : std::string(p.node().get("id"));
  const Node* named = p.find("bsdf");
  const auto nested = p.objects("bsdf");
  if (nested.size() + (named != nullptr) > 1) p.node().fail("the shape has more than one bsdf");
  if (named != nullptr && named->tag != "bsdf")
    p.at("bsdf").fail("expected a bsdf, found <" + named->tag + ">");
  if (named == nullptr && !nested.empty()) named = nested[0];
  shape.material = named == nullptr ? default_material() : material(*named);
  const auto emitters = p.objects("emitter");
  if (emitters.size() > 1) p.node().fail("the shape has more than one emitter");
  if (!emitters.empty()) {
    if (!may_emit) p.node().fail("a shape of a shapegroup cannot emit light");
    shape.emission = area_emission(*emitters[0]);
  }
  for (const std::string_view name : {"interior", "exterior"})
    if (p.has(name)) p.at(name).fail("participating media are not supported");
  p.finish();
}

int Context::group(const Node& node) {
  const auto known = groups_.find(&node);
  if (known != groups_.end()) return known->second;
  const Opened opened(*this, node);
  Parameters p(node, document);
  Group result;
  result.id = node.get("id").empty() ? node.location() : std::string(node.get("id"));
  for (const Node* child : p.objects("shape")) {
    Parameters inner(*child, document);
    auto shape = simple_shape(inner);
    if (!shape) {
      if (inner.type() == "shapegroup" || inner.type() == "instance")
        child->fail("a shapegroup cannot hold a shapegroup or an instance");
      unknown_plugin(*child, known_shapes);
    }
    finish_shape(inner, *shape, false);
    result.shapes.push_back(std::move(*shape));
  }
  if (result.shapes.empty()) node.fail("the shapegroup is empty");
  p.finish();
  scene.groups.push_back(std::move(result));
  return groups_[&node] = static_cast<int>(scene.groups.size()) - 1;
}

void Context::instance(Parameters& p) {
  const auto shapes = p.objects("shape");
  if (shapes.size() != 1 || shapes[0]->get("type") != "shapegroup")
    p.node().fail("an instance needs one reference to a shapegroup");
  const Transform to_world = p.transform();
  located(p.at("to_world"), [&] { return to_world.inverse(); });
  p.finish();
  scene.instances.push_back({group(*shapes[0]), to_world});
}

void Context::shape(const Node& node) {
  const Opened opened(*this, node);
  Parameters p(node, document);
  if (p.type() == "instance") return instance(p);
  if (auto simple = simple_shape(p)) {
    finish_shape(p, *simple, true);
    scene.shapes.push_back(std::move(*simple));
    return;
  }
  unknown_plugin(node, known_shapes);
}

} // namespace nacre::mitsuba

#include "core/error.h"
#include "core/file.h"
#include "core/text_scanner.h"
#include "scene/mesh.h"

#include <algorithm>
#include <limits>

namespace nacre {
namespace {

/// Where a face names no uv or no normal.
constexpr std::uint32_t absent = std::numeric_limits<std::uint32_t>::max();

class ObjReader {
public:
  ObjReader(std::string_view text, std::string_view name) : scanner_(text, name), name_(name) {}
  TriangleMesh read();

private:
  using Corner = std::array<std::uint32_t, 3>; ///< position, uv, normal

  void statement(std::string_view keyword);
  void face();
  Corner corner(std::string_view token) const;
  std::uint32_t index(std::string_view token, std::size_t count, std::string_view what) const;
  std::uint32_t vertex(const Corner& corner);

  TextScanner scanner_;
  std::string_view name_;
  std::vector<Vec3f> positions_, normals_;
  std::vector<Vec2f> uvs_;
  std::vector<Corner> corners_;                   ///< of the vertices of the mesh
  std::vector<std::uint32_t> newest_of_position_; ///< the vertices at one position form a list
  std::vector<std::uint32_t> earlier_same_position_;
  std::vector<std::uint32_t> polygon_;
  TriangleMesh mesh_;
};

std::uint32_t ObjReader::index(std::string_view token, std::size_t count, std::string_view what) const {
  const std::int64_t i = scanner_.integer(token, "an index of a " + std::string(what));
  const std::int64_t n = static_cast<std::int64_t>(count), from_zero = i < 0 ? n + i : i - 1;
  if (i == 0 || from_zero < 0 || from_zero >= n)
    scanner_.fail_at(token, "there is no " + std::string(what) + " " + std::to_string(i) + ": the file has " +
                                std::to_string(n) + " so far");
  return static_cast<std::uint32_t>(from_zero);
}

ObjReader::Corner ObjReader::corner(std::string_view token) const {
  Corner result{absent, absent, absent};
  const std::size_t slash = token.find('/');
  result[0] = index(token.substr(0, slash), positions_.size(), "vertex");
  if (slash == std::string_view::npos) return result;
  const std::string_view rest = token.substr(slash + 1);
  const std::size_t second = rest.find('/');
  const std::string_view uv = rest.substr(0, second);
  if (!uv.empty()) result[1] = index(uv, uvs_.size(), "texture coordinate");
  if (second == std::string_view::npos) return result;
  const std::string_view normal = rest.substr(second + 1);
  if (!normal.empty()) result[2] = index(normal, normals_.size(), "normal");
  return result;
}

std::uint32_t ObjReader::vertex(const Corner& corner) {
  newest_of_position_.resize(positions_.size(), absent);
  std::uint32_t& newest = newest_of_position_[corner[0]];
  for (std::uint32_t v = newest; v != absent; v = earlier_same_position_[v])
    if (corners_[v] == corner) return v;
  if (corners_.size() >= absent) scanner_.fail("more vertices than 32 bits can number");
  corners_.push_back(corner);
  earlier_same_position_.push_back(newest);
  return newest = static_cast<std::uint32_t>(corners_.size() - 1);
}

void ObjReader::face() {
  polygon_.clear();
  for (auto t = scanner_.token_on_line(true); !t.empty(); t = scanner_.token_on_line(true))
    polygon_.push_back(vertex(corner(t)));
  if (polygon_.size() < 3)
    scanner_.fail("a face needs at least 3 vertices, this one has " + std::to_string(polygon_.size()));
  for (std::size_t i = 2; i < polygon_.size(); ++i)
    mesh_.triangles.push_back({polygon_[0], polygon_[i - 1], polygon_[i]});
}

void ObjReader::statement(std::string_view keyword) {
  static const std::vector<std::string> passed_over = {
      "g",          "o",         "s",   "usemtl", "mtllib",   "l",        "p",  "vp",   "usemap", "maplib",
      "shadow_obj", "trace_obj", "lod", "bevel",  "c_interp", "d_interp", "mg", "call", "csh"};
  static const std::vector<std::string> free_form = {"cstype", "deg",  "bmat", "step", "curv",
                                                     "curv2",  "surf", "parm", "trim", "hole",
                                                     "scrv",   "sp",   "end",  "con"};
  if (keyword == "v") {
    const float x = scanner_.number_on_line("x of a vertex"), y = scanner_.number_on_line("y of a vertex");
    positions_.push_back({x, y, scanner_.number_on_line("z of a vertex")});
  } else if (keyword == "vn") {
    const float x = scanner_.number_on_line("x of a normal"), y = scanner_.number_on_line("y of a normal");
    normals_.push_back({x, y, scanner_.number_on_line("z of a normal")});
  } else if (keyword == "vt") {
    const float u = scanner_.number_on_line("u of a texture coordinate");
    const std::string_view v = scanner_.token_on_line(true); // a texture along a line has u alone
    uvs_.push_back({u, v.empty() ? 0.0f : scanner_.finite_float(v, "v of a texture coordinate")});
  } else if (keyword == "f" || keyword == "fo") {
    face();
  } else if (std::find(free_form.begin(), free_form.end(), keyword) != free_form.end()) {
    scanner_.fail_at(keyword, "free-form curves and surfaces are not supported, only polygons");
  } else if (std::find(passed_over.begin(), passed_over.end(), keyword) == passed_over.end()) {
    scanner_.fail_at(keyword,
                     "expected an OBJ statement such as v, vt, vn or f, found " + in_quotes(keyword));
  }
}

TriangleMesh ObjReader::read() {
  do {
    const std::string_view keyword = scanner_.token_on_line(true);
    if (!keyword.empty()) statement(keyword);
  } while (scanner_.next_line());
  if (mesh_.triangles.empty()) throw Error::in_file(name_, "an OBJ mesh needs faces, this file has none");

  const auto any_has = [&](int part) {
    return std::any_of(corners_.begin(), corners_.end(), [&](const Corner& c) { return c[part] != absent; });
  };
  const bool has_uv = any_has(1), has_normal = any_has(2);
  for (const Corner& c : corners_) {
    mesh_.positions.push_back(positions_[c[0]]);
    if (has_uv) mesh_.uvs.push_back(c[1] == absent ? Vec2f{0, 0} : uvs_[c[1]]);
    if (has_normal) {
      const Vec3f n = c[2] == absent ? Vec3f{0, 0, 0} : normals_[c[2]];
      const double l = length(Vec3d{n.x, n.y, n.z});
      mesh_.normals.push_back(l > 0 ? vec3<float>(Vec3d{n.x / l, n.y / l, n.z / l}) : Vec3f{0, 0, 0});
    }
  }
  if (has_normal) complete_vertex_normals(mesh_);
  return std::move(mesh_);
}

} // namespace

TriangleMesh parse_obj(std::string_view text, std::string_view name) { return ObjReader(text, name).read(); }
TriangleMesh read_obj(const std::string& path) { return parse_obj(read_text_file(path), path); }

} // namespace nacre

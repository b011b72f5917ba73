// The triangles of a glTF 2.0 file (Khronos 2021, glTF 2.0 specification, 3.3 to 3.7 and 4.4).
#include "core/error.h"
#include "core/file.h"
#include "scene/mesh.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

using nlohmann::json;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t float_type = 5126;
constexpr std::uint64_t most_vertices = 1u << 28;

std::uint32_t word(const Bytes& b, std::size_t at) {
  return std::uint32_t(b[at]) | std::uint32_t(b[at + 1]) << 8 | std::uint32_t(b[at + 2]) << 16 |
         std::uint32_t(b[at + 3]) << 24;
}

/// RFC 4648, section 4; blanks between are no part of it. @throws Error
Bytes decode_base64(std::string_view text, const std::string& path) {
  static const std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  Bytes bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=' || std::isspace(static_cast<unsigned char>(c))) continue;
    const std::size_t digit = digits.find(c);
    if (digit == std::string_view::npos) throw Error::in_file(path, "a data URI that is not base64");
    bits = bits << 6 | std::uint32_t(digit);
    if ((count += 6) < 8) continue;
    count -= 8;
    bytes.push_back(std::uint8_t(bits >> count));
  }
  return bytes;
}

/// One file. What it says of itself is checked where it is used.
class GltfFile {
public:
  explicit GltfFile(const std::string& path) : path_(path), bytes_(read_file(path)) {
    const bool binary = bytes_.size() >= 12 && std::memcmp(bytes_.data(), "glTF", 4) == 0;
    std::size_t begin = 0, end = bytes_.size();
    if (binary) {
      if (word(bytes_, 4) != 2) fail(fmt::format("glTF of version {}; 2 is read", word(bytes_, 4)));
      std::tie(begin, end) = chunk(12, 0x4e4f534a); // JSON
      if (end < bytes_.size()) glb_ = chunk(end, 0x004e4942);
    }
    try {
      root_ = json::parse(bytes_.begin() + std::ptrdiff_t(begin), bytes_.begin() + std::ptrdiff_t(end));
    } catch (const json::parse_error& e) {
      throw Error::in_binary(path_, begin + e.byte, "not valid JSON, and no glTF");
    }
    if (!root_.is_object() || !root_.contains("asset")) fail("not a glTF file: it has no 'asset'");
    if (root_.contains("extensionsRequired") && root_["extensionsRequired"].is_array())
      for (const json& name : root_["extensionsRequired"])
        if (name != "KHR_mesh_quantization" && name.is_string() &&
            name.get<std::string>().find("compression") != std::string::npos)
          fail(fmt::format("its meshes are compressed by {}, which is not read: export it without",
                           name.dump()));
  }

  TriangleMesh read() {
    if (root_.contains("nodes")) {
      std::vector<std::size_t> roots;
      if (root_.contains("scenes"))
        for (const json& node : list(entry("scenes", index(root_, "scene", 0)), "nodes"))
          roots.push_back(whole(node, "a node of the scene"));
      for (const std::size_t node : roots)
        add_node(node, Transform(), 0);
    } else { // a library of meshes
      for (std::size_t m = 0; m < list(root_, "meshes").size(); ++m)
        add_mesh(m, Transform());
    }
    if (mesh_.triangles.empty()) fail("its scene holds no triangle");
    if (has_normals_) complete_vertex_normals(mesh_);
    if (!has_normals_) mesh_.normals.clear();
    if (!has_uvs_) mesh_.uvs.clear();
    return std::move(mesh_);
  }

private:
  [[noreturn]] void fail(const std::string& what) const { throw Error::in_file(path_, what); }

  std::pair<std::size_t, std::size_t> chunk(std::size_t at, std::uint32_t kind) const {
    if (bytes_.size() - at < 8) throw Error::in_binary(path_, at, "the file ends before a chunk");
    const std::size_t size = word(bytes_, at);
    if (word(bytes_, at + 4) != kind) throw Error::in_binary(path_, at + 4, "a chunk of another kind");
    if (size > bytes_.size() - at - 8)
      throw Error::in_binary(path_, at,
                             fmt::format("a chunk of {} bytes, {} are left", size, bytes_.size() - at - 8));
    return {at + 8, at + 8 + size};
  }
  std::uint64_t whole(const json& value, const char* what) const {
    if (!value.is_number_unsigned()) fail(fmt::format("{} is no whole number", what));
    return value.get<std::uint64_t>();
  }
  std::uint64_t index(const json& of, const char* name, std::uint64_t otherwise) const {
    return of.contains(name) ? whole(of[name], name) : otherwise;
  }
  const json& list(const json& of, const char* name) const {
    static const json none = json::array();
    if (!of.contains(name)) return none;
    if (!of[name].is_array()) fail(fmt::format("'{}' is no list", name));
    return of[name];
  }
  const json& entry(const char* name, std::uint64_t i) const {
    const json& all = list(root_, name);
    if (i >= all.size()) fail(fmt::format("there is no entry {} of the {} '{}'", i, all.size(), name));
    if (!all[i].is_object()) fail(fmt::format("entry {} of '{}' is no object", i, name));
    return all[i];
  }
  std::vector<double> numbers(const json& of, const char* name, std::vector<double> otherwise) const {
    if (!of.contains(name)) return otherwise;
    const json& values = list(of, name);
    if (values.size() != otherwise.size()) fail(fmt::format("'{}' has {} numbers", name, otherwise.size()));
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!values[i].is_number()) fail(fmt::format("'{}' has {} numbers", name, otherwise.size()));
      otherwise[i] = values[i].get<double>();
    }
    return otherwise;
  }

  Transform transform_of(const json& node) const {
    if (node.contains("matrix")) { // column by column
      const auto m = numbers(node, "matrix", std::vector<double>(16));
      Transform t;
      for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 4; ++column)
          t.m[row][column] = m[4 * column + row];
      return t;
    }
    const auto move = numbers(node, "translation", {0, 0, 0}), factor = numbers(node, "scale", {1, 1, 1}),
               q = numbers(node, "rotation", {0, 0, 0, 1});
    const Vec3d axis{q[0], q[1], q[2]};
    const double sine = length(axis);
    Transform t = Transform::translate({move[0], move[1], move[2]});
    if (sine > 0) t = t * Transform::rotate(axis, 2 * std::atan2(sine, q[3]) * 180 / pi);
    return t * Transform::scale({factor[0], factor[1], factor[2]});
  }
  void add_node(std::uint64_t i, const Transform& parent, int depth) {
    constexpr int deepest = 64;
    if (depth > deepest || ++nodes_seen_ > 1000000) fail("its nodes are nested without end");
    const json& node = entry("nodes", i);
    const Transform to_world = parent * transform_of(node);
    if (node.contains("mesh")) add_mesh(whole(node["mesh"], "mesh"), to_world);
    for (const json& child : list(node, "children"))
      add_node(whole(child, "a child"), to_world, depth + 1);
  }
  void add_mesh(std::uint64_t i, const Transform& to_world) {
    for (const json& primitive : list(entry("meshes", i), "primitives")) {
      const std::uint64_t mode = index(primitive, "mode", 4);
      if (mode < 4) continue; // points and lines
      if (mode > 6) fail(fmt::format("a primitive of mode {}; 4, 5 and 6 are triangles", mode));
      add_primitive(primitive, mode, to_world);
    }
  }

  void add_primitive(const json& primitive, std::uint64_t mode, const Transform& to_world) {
    if (!primitive.contains("attributes") || !primitive["attributes"].is_object() ||
        !primitive["attributes"].contains("POSITION"))
      fail("a primitive without POSITION");
    const json& attributes = primitive["attributes"];
    const auto values = [&](const char* name, std::size_t components) {
      return attributes.contains(name) ? accessor(whole(attributes[name], name), components)
                                       : std::vector<double>();
    };
    const std::vector<double> p = values("POSITION", 3), n = values("NORMAL", 3),
                              uv = values("TEXCOORD_0", 2);
    const std::size_t count = p.size() / 3;
    if ((!n.empty() && n.size() != p.size()) || (!uv.empty() && uv.size() != 2 * count))
      fail("attributes of different lengths");
    TriangleMesh part;
    for (std::size_t v = 0; v < count; ++v) {
      part.positions.push_back({float(p[3 * v]), float(p[3 * v + 1]), float(p[3 * v + 2])});
      if (!n.empty()) {
        const Vec3d normal{n[3 * v], n[3 * v + 1], n[3 * v + 2]};
        const double size = length(normal);
        part.normals.push_back(
            size > 0 ? Vec3f{float(normal.x / size), float(normal.y / size), float(normal.z / size)}
                     : Vec3f{0, 0, 0});
      }
      // v downwards in glTF, upwards here.
      if (!uv.empty()) part.uvs.push_back({float(uv[2 * v]), float(1 - uv[2 * v + 1])});
    }
    std::vector<std::uint32_t> corners;
    if (primitive.contains("indices")) {
      for (const double i : accessor(whole(primitive["indices"], "indices"), 1)) {
        if (!(i < double(count))) fail(fmt::format("index {} of {} vertices", i, count));
        corners.push_back(std::uint32_t(i));
      }
    } else {
      for (std::size_t v = 0; v < count; ++v)
        corners.push_back(std::uint32_t(v));
    }
    if (mode == 4)
      for (std::size_t c = 0; c + 2 < corners.size(); c += 3)
        part.triangles.push_back({corners[c], corners[c + 1], corners[c + 2]});
    else
      for (std::size_t c = 0; c + 2 < corners.size(); ++c)
        part.triangles.push_back(mode == 6    ? std::array{corners[0], corners[c + 1], corners[c + 2]}
                                 : c % 2 == 0 ? std::array{corners[c], corners[c + 1], corners[c + 2]}
                                              : std::array{corners[c + 1], corners[c], corners[c + 2]});
    place_mesh(part, to_world, false);
    append(part);
  }
  void append(const TriangleMesh& part) {
    const auto first = std::uint32_t(mesh_.positions.size());
    if (mesh_.positions.size() + part.positions.size() > most_vertices) fail("too many vertices");
    mesh_.positions.insert(mesh_.positions.end(), part.positions.begin(), part.positions.end());
    // Where a part has none, 0 stands for a normal that is found later.
    has_normals_ |= !part.normals.empty(), has_uvs_ |= !part.uvs.empty();
    mesh_.normals.insert(mesh_.normals.end(), part.normals.begin(), part.normals.end());
    mesh_.uvs.insert(mesh_.uvs.end(), part.uvs.begin(), part.uvs.end());
    mesh_.normals.resize(mesh_.positions.size(), {0, 0, 0});
    mesh_.uvs.resize(mesh_.positions.size(), {0, 0});
    for (const auto& t : part.triangles)
      mesh_.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }

  struct View {
    const std::uint8_t* data;
    std::uint64_t size, stride;
  };
  View view(std::uint64_t i) {
    const json& v = entry("bufferViews", i);
    const Bytes& bytes = buffer(index(v, "buffer", 0));
    const std::uint64_t offset = index(v, "byteOffset", 0), size = index(v, "byteLength", 0);
    if (offset > bytes.size() || size > bytes.size() - offset)
      fail(fmt::format("view {} of {} bytes at {} leaves its buffer of {}", i, size, offset, bytes.size()));
    return {bytes.data() + offset, size, index(v, "byteStride", 0)};
  }
  const Bytes& buffer(std::uint64_t i) {
    if (const auto known = buffers_.find(i); known != buffers_.end()) return known->second;
    const json& b = entry("buffers", i);
    Bytes bytes;
    if (!b.contains("uri")) {
      if (glb_.second == 0) fail(fmt::format("buffer {} has no 'uri'", i));
      bytes.assign(bytes_.begin() + std::ptrdiff_t(glb_.first), bytes_.begin() + std::ptrdiff_t(glb_.second));
    } else {
      if (!b["uri"].is_string()) fail("'uri' is no text");
      const std::string uri = b["uri"].get<std::string>();
      if (uri.starts_with("data:")) {
        const std::size_t comma = uri.find(";base64,");
        if (comma == std::string::npos) fail("a data URI that is not base64");
        bytes = decode_base64(std::string_view(uri).substr(comma + 8), path_);
      } else {
        bytes = read_file((std::filesystem::path(path_).parent_path() / uri).string());
      }
    }
    return buffers_[i] = std::move(bytes);
  }

  /// All numbers of an accessor, normalised ones as they stand for.
  std::vector<double> accessor(std::uint64_t i, std::size_t components) {
    const json& a = entry("accessors", i);
    if (a.contains("sparse")) fail("a sparse accessor, which is not read");
    const char* names[] = {"SCALAR", "VEC2", "VEC3"};
    if (!a.contains("type") || a["type"] != names[components - 1])
      fail(fmt::format("accessor {} is no {}", i, names[components - 1]));
    const std::uint64_t type = index(a, "componentType", 0), count = index(a, "count", 0);
    const std::map<std::uint64_t, std::uint64_t> sizes{{5120, 1}, {5121, 1}, {5122, 2},
                                                       {5123, 2}, {5125, 4}, {float_type, 4}};
    if (!sizes.count(type)) fail(fmt::format("accessor {} has the unknown component type {}", i, type));
    if (count > most_vertices) fail(fmt::format("accessor {} claims {} entries", i, count));
    if (!a.contains("bufferView")) return std::vector<double>(count * components);
    const View v = view(whole(a["bufferView"], "bufferView"));
    const std::uint64_t size = sizes.at(type), stride = v.stride ? v.stride : size * components,
                        offset = index(a, "byteOffset", 0);
    // At most 2^28 entries, 2^32 apart: no overflow.
    if (stride > 0xffffffffu || offset > v.size ||
        (count > 0 && (count - 1) * stride + size * components > v.size - offset))
      fail(fmt::format("accessor {} leaves its view of {} bytes", i, v.size));
    const bool normalised = a.contains("normalized") && a["normalized"] == true;
    std::vector<double> values;
    values.reserve(count * components);
    for (std::uint64_t k = 0; k < count; ++k)
      for (std::uint64_t c = 0; c < components; ++c)
        values.push_back(number(v.data + offset + k * stride + c * size, type, normalised));
    return values;
  }
  double number(const std::uint8_t* at, std::uint64_t type, bool normalised) const {
    const auto as = [&]<class T>(T value) {
      std::memcpy(&value, at, sizeof value);
      return normalised && std::is_integral_v<T>
                 ? std::max(double(value) / double(std::numeric_limits<T>::max()), -1.0)
                 : double(value);
    };
    switch (type) {
    case 5120:
      return as(std::int8_t());
    case 5121:
      return as(std::uint8_t());
    case 5122:
      return as(std::int16_t());
    case 5123:
      return as(std::uint16_t());
    case 5125:
      return as(std::uint32_t());
    default:
      break;
    }
    const double x = as(float());
    if (!std::isfinite(x)) fail("a coordinate that is not finite");
    return x;
  }

  const std::string path_;
  Bytes bytes_;
  json root_;
  std::pair<std::size_t, std::size_t> glb_{0, 0}; ///< the binary chunk
  std::map<std::uint64_t, Bytes> buffers_;
  TriangleMesh mesh_;
  bool has_normals_ = false, has_uvs_ = false;
  int nodes_seen_ = 0;
};

} // namespace

TriangleMesh read_gltf(const std::string& path) { return GltfFile(path).read(); }

} // namespace nacre

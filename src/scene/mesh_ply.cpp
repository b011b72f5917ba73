#include "core/error.h"
#include "core/file.h"
#include "core/text_scanner.h"
#include "scene/mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

namespace nacre {
namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class Format { ascii, little_endian, big_endian };

struct TypeName {
  std::string_view name;
  Type type;
};
constexpr TypeName type_names[] = {
    {"char", Type::int8},       {"int8", Type::int8},       {"uchar", Type::uint8},
    {"uint8", Type::uint8},     {"short", Type::int16},     {"int16", Type::int16},
    {"ushort", Type::uint16},   {"uint16", Type::uint16},   {"int", Type::int32},
    {"int32", Type::int32},     {"uint", Type::uint32},     {"uint32", Type::uint32},
    {"float", Type::float32},   {"float32", Type::float32}, {"double", Type::float64},
    {"float64", Type::float64},
};

std::size_t size_of(Type type) {
  switch (type) {
  case Type::int8:
  case Type::uint8:
    return 1;
  case Type::int16:
  case Type::uint16:
    return 2;
  case Type::int32:
  case Type::uint32:
  case Type::float32:
    return 4;
  case Type::float64:
    break;
  }
  return 8;
}
bool is_integer(Type type) { return type != Type::float32 && type != Type::float64; }

struct Property {
  std::string name;
  Type type;
  std::optional<Type> count_type; ///< of a list
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

class PlyReader {
public:
  PlyReader(std::span<const std::uint8_t> bytes, std::string_view name)
      : bytes_(bytes), text_(reinterpret_cast<const char*>(bytes.data()), bytes.size()), name_(name),
        scanner_(text_, name) {}
  TriangleMesh read();

private:
  void read_header();
  void header_line(std::string_view keyword);
  Type type(std::string_view token) const;
  void check_size(const Element& element) const;
  void read_vertices(const Element& element);
  void read_faces(const Element& element);
  void skip(const Element& element);

  double value(Type type, std::string_view what);
  std::uint64_t list_length(const Property& list);
  [[noreturn]] void fail(std::size_t token_size, std::string_view message) const;

  std::span<const std::uint8_t> bytes_;
  std::string_view text_, name_;
  TextScanner scanner_;    ///< of the header, and of an ascii body
  std::size_t offset_ = 0; ///< in a binary body
  std::string_view token_; ///< the number read last, in an ascii body
  Format format_ = Format::ascii;
  bool has_format_ = false;
  std::vector<Element> elements_;
  TriangleMesh mesh_;
};

Type PlyReader::type(std::string_view token) const {
  for (const auto& t : type_names)
    if (t.name == token) return t.type;
  std::vector<std::string> known;
  for (const auto& t : type_names)
    known.emplace_back(t.name);
  scanner_.fail_at(token, "unknown type " + in_quotes(token) + suggestion(token, known));
}

void PlyReader::header_line(std::string_view keyword) {
  const auto word = [&](std::string_view what) {
    const std::string_view t = scanner_.token_on_line(false);
    if (t.empty()) scanner_.fail("expected " + std::string(what) + ", found the end of the line");
    return t;
  };
  if (keyword == "comment" || keyword == "obj_info") return;
  if (keyword == "format") {
    const std::string_view format = word("a format");
    if (format == "ascii")
      format_ = Format::ascii;
    else if (format == "binary_little_endian")
      format_ = Format::little_endian;
    else if (format == "binary_big_endian")
      format_ = Format::big_endian;
    else
      scanner_.fail_at(format, "expected ascii, binary_little_endian or binary_big_endian, found " +
                                   in_quotes(format));
    has_format_ = true;
  } else if (keyword == "element") {
    Element element;
    element.name = word("the name of an element");
    const std::string_view count = word("the number of elements");
    const std::int64_t n = scanner_.integer(count, "the number of elements");
    if (n < 0 || n > std::numeric_limits<std::uint32_t>::max())
      scanner_.fail_at(count, "the number of elements must be between 0 and 4294967295");
    element.count = static_cast<std::uint64_t>(n);
    elements_.push_back(std::move(element));
  } else if (keyword == "property") {
    if (elements_.empty()) scanner_.fail_at(keyword, "a property comes before any element");
    std::string_view token = word("the type of a property");
    std::optional<Type> count_type;
    if (token == "list") {
      token = word("the type of a list's length");
      count_type = type(token);
      if (!is_integer(*count_type)) scanner_.fail_at(token, "a list's length must be an integer");
      token = word("the type of a list's items");
    }
    const Type item = type(token);
    elements_.back().properties.push_back({std::string(word("the name of a property")), item, count_type});
  } else {
    scanner_.fail_at(keyword, "expected a line of a PLY header (format, element, property, comment, "
                              "end_header), found " +
                                  in_quotes(keyword));
  }
}

void PlyReader::read_header() {
  if (scanner_.token_on_line(false) != "ply")
    throw Error::in_text(name_, 1, 1, "not a PLY file: it does not begin with 'ply'");
  while (scanner_.next_line()) {
    const std::string_view keyword = scanner_.token_on_line(false);
    if (keyword == "end_header") {
      if (!has_format_) scanner_.fail_at(keyword, "the header states no format");
      scanner_.next_line();
      offset_ = scanner_.offset();
      return;
    }
    if (!keyword.empty()) header_line(keyword);
  }
  scanner_.fail("the file ends inside its header: 'end_header' is missing");
}

void PlyReader::fail(std::size_t token_size, std::string_view message) const {
  if (format_ != Format::ascii) throw Error::in_binary(name_, offset_ - token_size, message);
  if (token_.data() != nullptr) scanner_.fail_at(token_, message);
  scanner_.fail(message);
}

double PlyReader::value(Type type, std::string_view what) {
  if (format_ == Format::ascii) {
    token_ = scanner_.token();
    if (token_.empty()) scanner_.fail("expected " + std::string(what) + ", found the end of the file");
    double v = 0;
    if (!parse_number(token_, v))
      scanner_.fail_at(token_, "expected " + std::string(what) + ", found " + in_quotes(token_));
    return v;
  }
  const std::size_t size = size_of(type);
  if (size > bytes_.size() - offset_)
    throw Error::in_binary(name_, offset_, "expected " + std::string(what) + ", found the end of the file");
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t shift = format_ == Format::little_endian ? i : size - 1 - i;
    bits |= static_cast<std::uint64_t>(bytes_[offset_ + i]) << (8 * shift);
  }
  offset_ += size;
  switch (type) {
  case Type::int8:
    return static_cast<std::int8_t>(bits);
  case Type::uint8:
    return static_cast<std::uint8_t>(bits);
  case Type::int16:
    return static_cast<std::int16_t>(bits);
  case Type::uint16:
    return static_cast<std::uint16_t>(bits);
  case Type::int32:
    return static_cast<std::int32_t>(bits);
  case Type::uint32:
    return static_cast<std::uint32_t>(bits);
  case Type::float32:
    return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  case Type::float64:
    break;
  }
  return std::bit_cast<double>(bits);
}

std::uint64_t PlyReader::list_length(const Property& list) {
  const double n = value(*list.count_type, "the length of a list");
  // Each item takes a byte at least, in every format.
  if (!(n >= 0) || n != std::floor(n) || n > static_cast<double>(bytes_.size()))
    fail(size_of(*list.count_type), "the length of the list '" + list.name + "' is impossible");
  return static_cast<std::uint64_t>(n);
}

/// A count that the rest of the file cannot hold is an error before anything is allocated for it.
void PlyReader::check_size(const Element& element) const {
  std::uint64_t smallest = 0;
  for (const Property& p : element.properties)
    smallest += format_ == Format::ascii ? 2 : size_of(p.count_type ? *p.count_type : p.type);
  const std::size_t position = format_ == Format::ascii ? scanner_.offset() : offset_;
  const std::uint64_t left = bytes_.size() - position + 1; // the last ascii number needs no blank after it
  if (smallest != 0 && element.count > left / smallest)
    throw Error::in_binary(name_, position,
                           "the header promises " + std::to_string(element.count) + " elements '" +
                               element.name + "', more than the rest of the file can hold");
}

void PlyReader::skip(const Element& element) {
  for (std::uint64_t i = 0; i < element.count && !element.properties.empty(); ++i)
    for (const Property& p : element.properties) {
      const std::uint64_t n = p.count_type ? list_length(p) : 1;
      for (std::uint64_t k = 0; k < n; ++k)
        value(p.type, "a value of '" + p.name + "'");
    }
}

void PlyReader::read_vertices(const Element& element) {
  if (!mesh_.positions.empty()) throw Error::in_file(name_, "two elements 'vertex'");
  // The slot of each property in (x, y, z, nx, ny, nz, u, v), or -1.
  const auto find = [&](std::string_view name) {
    for (std::size_t i = 0; i < element.properties.size(); ++i)
      if (element.properties[i].name == name && !element.properties[i].count_type) return static_cast<int>(i);
    return -1;
  };
  std::vector<int> slot(element.properties.size(), -1);
  const auto use = [&](std::initializer_list<std::string_view> names, int first) {
    for (const auto name : names)
      if (find(name) < 0) return false;
    for (const auto name : names)
      slot[find(name)] = first++;
    return true;
  };
  if (!use({"x", "y", "z"}, 0)) throw Error::in_file(name_, "the element 'vertex' lacks x, y or z");
  const bool has_normal = use({"nx", "ny", "nz"}, 3);
  const bool has_uv = use({"u", "v"}, 6) || use({"texture_u", "texture_v"}, 6) || use({"s", "t"}, 6);
  check_size(element);
  mesh_.positions.reserve(element.count);
  if (has_normal) mesh_.normals.reserve(element.count);
  if (has_uv) mesh_.uvs.reserve(element.count);

  for (std::uint64_t i = 0; i < element.count; ++i) {
    std::array<float, 8> v{};
    for (std::size_t k = 0; k < slot.size(); ++k) {
      const Property& p = element.properties[k];
      const std::uint64_t n = p.count_type ? list_length(p) : 1;
      for (std::uint64_t j = 0; j < n; ++j) {
        const double number = value(p.type, p.name);
        if (slot[k] < 0) continue;
        v[slot[k]] = static_cast<float>(number);
        if (!std::isfinite(v[slot[k]]))
          fail(size_of(p.type), p.name + " of vertex " + std::to_string(i) + " is not a finite number");
      }
    }
    mesh_.positions.push_back({v[0], v[1], v[2]});
    if (has_normal) {
      const Vec3d normal{v[3], v[4], v[5]};
      const double l = length(normal);
      mesh_.normals.push_back(l > 0 ? vec3<float>(normal / l) : Vec3f{0, 0, 0});
    }
    if (has_uv) mesh_.uvs.push_back({v[6], v[7]});
  }
}

void PlyReader::read_faces(const Element& element) {
  const auto& all = element.properties;
  const auto list = std::find_if(all.begin(), all.end(), [](const Property& p) {
    return p.count_type && (p.name == "vertex_indices" || p.name == "vertex_index");
  });
  if (list == all.end())
    throw Error::in_file(name_, "the element 'face' has no list 'vertex_indices' or 'vertex_index'");
  if (!is_integer(list->type))
    throw Error::in_file(name_, "the list '" + list->name + "' must be of integers");
  check_size(element);
  mesh_.triangles.reserve(mesh_.triangles.size() + element.count);
  const auto vertex_count = static_cast<double>(mesh_.positions.size());
  for (std::uint64_t i = 0; i < element.count; ++i)
    for (auto p = all.begin(); p != all.end(); ++p) {
      const std::uint64_t n = p->count_type ? list_length(*p) : 1;
      if (p == list && n < 3)
        fail(size_of(*p->count_type),
             "face " + std::to_string(i) + " has " + std::to_string(n) + " vertices, expected at least 3");
      std::uint32_t first = 0, previous = 0;
      for (std::uint64_t k = 0; k < n; ++k) {
        const double number = value(p->type, p == list ? "an index of a vertex" : p->name);
        if (p != list) continue;
        if (!(number >= 0 && number < vertex_count) || number != std::floor(number))
          fail(size_of(p->type), "face " + std::to_string(i) +
                                     " names a vertex that is not there: the file has " +
                                     std::to_string(mesh_.positions.size()));
        const auto index = static_cast<std::uint32_t>(number);
        if (k == 0) first = index;
        if (k >= 2) mesh_.triangles.push_back({first, previous, index});
        previous = index;
      }
    }
}

TriangleMesh PlyReader::read() {
  read_header();
  const auto has = [&](std::string_view name) {
    return std::any_of(elements_.begin(), elements_.end(), [&](const Element& e) { return e.name == name; });
  };
  if (!has("vertex") || !has("face"))
    throw Error::in_file(name_,
                         "a PLY mesh needs the elements 'vertex' and 'face' (strips and points are not "
                         "supported)");
  for (const Element& element : elements_) {
    if (element.name == "vertex")
      read_vertices(element);
    else if (element.name == "face")
      read_faces(element);
    else
      skip(element);
  }
  if (mesh_.triangles.empty()) throw Error::in_file(name_, "the mesh has no faces");
  if (!mesh_.normals.empty()) complete_vertex_normals(mesh_);
  return std::move(mesh_);
}

} // namespace

TriangleMesh parse_ply(std::span<const std::uint8_t> bytes, std::string_view name) {
  return PlyReader(bytes, name).read();
}
TriangleMesh read_ply(const std::string& path) { return parse_ply(read_file(path), path); }

} // namespace nacre

#include "core/error.h"
#include "core/file.h"
#include "scene/mesh.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <zlib.h>

namespace nacre {
namespace {

// Format: Mitsuba's documentation of the plugin `serialized`. All numbers are little-endian.
constexpr std::uint16_t file_identifier = 0x041c;
constexpr std::size_t longest_name = 65536;
enum Flag : std::uint32_t { // numbers are single-precision unless said otherwise
  has_normals = 0x0001,
  has_uvs = 0x0002,
  has_colors = 0x0008,
  face_normals = 0x0010,
  double_precision = 0x2000
};

/// Numbers at any offset of the file.
class Bytes {
public:
  Bytes(std::span<const std::uint8_t> bytes, std::string_view file) : bytes_(bytes), file_(file) {}
  template <class T>
  T at(std::uint64_t offset, std::string_view what) const {
    if (offset > bytes_.size() || sizeof(T) > bytes_.size() - offset)
      throw Error::in_binary(file_, offset, "expected " + std::string(what) + ", found the end of the file");
    T value;
    std::memcpy(&value, bytes_.data() + offset, sizeof(T));
    return value;
  }
  std::uint64_t size() const { return bytes_.size(); }

private:
  std::span<const std::uint8_t> bytes_;
  std::string_view file_;
};

/// The numbers inside a zlib stream.
class Inflater {
public:
  Inflater(std::span<const std::uint8_t> bytes, std::uint64_t offset, std::string_view file)
      : bytes_(bytes), start_(offset), file_(file) {
    if (inflateInit(&stream_) != Z_OK) throw Error::in_file(file, "zlib could not be started");
    stream_.next_in = const_cast<Bytef*>(bytes.data() + offset); // zlib only reads it
    left_ = bytes.size() - offset;
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&stream_); }

  void read(void* out, std::uint64_t size, std::string_view what) {
    auto* next = static_cast<Bytef*>(out);
    while (size > 0) {
      constexpr std::uint64_t most = 1u << 30;
      if (stream_.avail_in == 0) {
        stream_.avail_in = static_cast<uInt>(std::min(left_, most));
        left_ -= stream_.avail_in;
      }
      const auto wanted = static_cast<uInt>(std::min(size, most));
      stream_.next_out = next;
      stream_.avail_out = wanted;
      const int status = inflate(&stream_, Z_NO_FLUSH);
      const uInt got = wanted - stream_.avail_out;
      next += got;
      size -= got;
      if (size == 0 || status == Z_OK) continue;
      if (status == Z_STREAM_END || status == Z_BUF_ERROR)
        fail("expected " + std::string(what) + ", found the end of the data");
      fail("the compressed data is damaged");
    }
  }
  template <class T>
  T get(std::string_view what) {
    T value;
    read(&value, sizeof value, what);
    return value;
  }
  /// True if what is left of the file can inflate to that many bytes: deflate never shrinks more than
  /// 1032-fold (zlib's technical notes).
  bool can_hold(std::uint64_t size) const { return size / 1032 <= left_ + stream_.avail_in; }
  [[noreturn]] void fail(std::string_view message) const {
    throw Error::in_binary(file_, start_ + stream_.total_in, message);
  }

private:
  std::span<const std::uint8_t> bytes_;
  std::uint64_t start_, left_;
  std::string_view file_;
  z_stream stream_{};
};

/// Where the mesh of that index begins, by the table at the end of the file: one offset a mesh, then their
/// number in 32 bits.
std::uint64_t mesh_offset(const Bytes& bytes, int shape_index, std::uint16_t version, std::string_view file) {
  if (shape_index == 0) return 0;
  if (bytes.size() < 4) throw Error::in_binary(file, bytes.size(), "the table of meshes is missing");
  const std::uint64_t entry = version == 4 ? 8 : 4, end = bytes.size() - 4;
  const auto count = bytes.at<std::uint32_t>(end, "the number of meshes");
  if (count > end / entry)
    throw Error::in_binary(file, end,
                           "the file claims " + std::to_string(count) + " meshes, more than it can hold");
  if (static_cast<std::uint32_t>(shape_index) >= count)
    throw Error::in_binary(file, end,
                           "there is no mesh of shape_index " + std::to_string(shape_index) +
                               ": the file has " + std::to_string(count));
  const std::uint64_t slot = end - entry * (count - static_cast<std::uint32_t>(shape_index));
  const std::uint64_t offset = version == 4 ? bytes.at<std::uint64_t>(slot, "the offset of a mesh")
                                            : bytes.at<std::uint32_t>(slot, "the offset of a mesh");
  if (offset >= bytes.size())
    throw Error::in_binary(file, slot,
                           "the offset of mesh " + std::to_string(shape_index) + " is outside the file");
  return offset;
}

class Reader {
public:
  Reader(std::span<const std::uint8_t> bytes, std::uint64_t offset, std::string_view file)
      : in_(bytes, offset, file) {}

  SerializedMesh read(std::uint16_t version) {
    SerializedMesh result;
    const auto flags = in_.get<std::uint32_t>("flags");
    doubles_ = (flags & double_precision) != 0;
    if (version == 4) {
      for (char c = in_.get<char>("a name"); c != 0; c = in_.get<char>("a name")) {
        if (result.name.size() == longest_name) in_.fail("the mesh's name does not end within 65536 bytes");
        result.name += c;
      }
    }
    vertices_ = in_.get<std::uint64_t>("the number of vertices");
    const auto triangles = in_.get<std::uint64_t>("the number of triangles");
    if (vertices_ == 0 || triangles == 0) in_.fail("the mesh is empty");
    if (vertices_ > std::numeric_limits<std::uint32_t>::max())
      in_.fail("the mesh has " + std::to_string(vertices_) + " vertices, more than 32 bits can number");
    if (triangles > std::numeric_limits<std::uint64_t>::max() / 12 || !in_.can_hold(triangles * 12))
      in_.fail("the mesh claims " + std::to_string(triangles) + " triangles, more than the file can hold");

    TriangleMesh& mesh = result.mesh;
    for (const auto& p : numbers<3>("vertex positions"))
      mesh.positions.push_back({p[0], p[1], p[2]});
    if ((flags & has_normals) != 0)
      for (const auto& n : numbers<3>("vertex normals")) {
        const double l = length(Vec3d{n[0], n[1], n[2]});
        mesh.normals.push_back(l > 0 ? vec3<float>(Vec3d{n[0] / l, n[1] / l, n[2] / l}) : Vec3f{0, 0, 0});
      }
    if ((flags & has_uvs) != 0)
      for (const auto& uv : numbers<2>("texture coordinates"))
        mesh.uvs.push_back({uv[0], uv[1]});
    if ((flags & has_colors) != 0) numbers<3>("vertex colours");
    result.face_normals = (flags & face_normals) != 0;

    mesh.triangles.resize(triangles);
    in_.read(mesh.triangles.data(), triangles * 12, "triangles");
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      for (const std::uint32_t index : mesh.triangles[i])
        if (index >= vertices_)
          in_.fail("triangle " + std::to_string(i) + " names vertex " + std::to_string(index) +
                   ", but the mesh has " + std::to_string(vertices_));
    if (!mesh.normals.empty()) complete_vertex_normals(mesh);
    return result;
  }

private:
  /// N numbers a vertex, in the file's precision.
  template <int N>
  std::vector<std::array<float, N>> numbers(std::string_view what) {
    if (!in_.can_hold(vertices_ * N * (doubles_ ? 8 : 4)))
      in_.fail("the mesh claims " + std::to_string(vertices_) + " vertices, more than the file can hold");
    std::vector<std::array<float, N>> result(vertices_);
    if (doubles_) {
      std::vector<std::array<double, N>> stored(vertices_);
      in_.read(stored.data(), vertices_ * sizeof stored[0], what);
      for (std::size_t i = 0; i < stored.size(); ++i)
        for (int k = 0; k < N; ++k)
          result[i][k] = static_cast<float>(stored[i][k]);
    } else {
      in_.read(result.data(), vertices_ * sizeof result[0], what);
    }
    for (std::size_t i = 0; i < result.size(); ++i)
      for (const float v : result[i])
        if (!std::isfinite(v))
          in_.fail("the " + std::string(what) + " hold a value at vertex " + std::to_string(i) +
                   " that is not a finite number");
    return result;
  }

  Inflater in_;
  bool doubles_ = false;
  std::uint64_t vertices_ = 0;
};

} // namespace

SerializedMesh parse_serialized(std::span<const std::uint8_t> data, int shape_index, std::string_view name) {
  if (shape_index < 0)
    throw Error::in_file(name, "shape_index must be 0 or more, found " + std::to_string(shape_index));
  const Bytes bytes(data, name);
  if (bytes.at<std::uint16_t>(0, "the identifier of a serialized mesh") != file_identifier)
    throw Error::in_binary(name, 0, "not a serialized mesh: it does not begin with 0x041C");
  const auto file_version = bytes.at<std::uint16_t>(2, "the version of the format");
  const std::uint64_t offset = mesh_offset(bytes, shape_index, file_version, name);
  if (bytes.at<std::uint16_t>(offset, "the identifier of a mesh") != file_identifier)
    throw Error::in_binary(name, offset, "the table of meshes leads to something that is no mesh");
  const auto version = bytes.at<std::uint16_t>(offset + 2, "the version of the format");
  if (version != 3 && version != 4)
    throw Error::in_binary(name, offset + 2,
                           "version " + std::to_string(version) + " is not supported, only 3 and 4");
  return Reader(data, offset + 4, name).read(version);
}

SerializedMesh read_serialized(const std::string& path, int shape_index) {
  return parse_serialized(read_file(path), shape_index, path);
}

} // namespace nacre

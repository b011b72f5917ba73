#pragma once
// Writes small meshes in binary formats, as tests need them.

#include "core/vec.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <zlib.h>

namespace nacre {

template <class T>
void append(std::string& bytes, T value, bool big_endian = false) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof value);
  if (big_endian) std::reverse(raw, raw + sizeof raw);
  bytes.append(raw, sizeof raw);
}

inline std::vector<std::uint8_t> bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

/// A unit square in z = 0: one quad, with normals, uv, a property and an element to skip.
inline std::string binary_ply(bool big_endian) {
  std::string ply =
      std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
      "_endian 1.0\ncomment a square\nelement camera 1\nproperty list uchar short marks\n"
      "element vertex 4\nproperty double x\nproperty float y\nproperty float z\nproperty uchar red\n"
      "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n"
      "element face 1\nproperty list uchar uint vertex_indices\nproperty int mark\nend_header\n";
  append<std::uint8_t>(ply, 2);
  append<std::int16_t>(ply, -5, big_endian);
  append<std::int16_t>(ply, 7, big_endian);
  for (const Vec2f& p : {Vec2f{0, 0}, Vec2f{1, 0}, Vec2f{1, 1}, Vec2f{0, 1}}) {
    append<double>(ply, p.x, big_endian);
    append<float>(ply, p.y, big_endian);
    append<float>(ply, 0, big_endian);
    append<std::uint8_t>(ply, 200);
    for (const float n : {0.0f, 0.0f, 2.0f})
      append<float>(ply, n, big_endian);
    append<float>(ply, p.x, big_endian);
    append<float>(ply, p.y, big_endian);
  }
  append<std::uint8_t>(ply, 4);
  for (const std::uint32_t i : {0u, 1u, 2u, 3u})
    append<std::uint32_t>(ply, i, big_endian);
  append<std::int32_t>(ply, -1, big_endian);
  return ply;
}

inline std::string deflated(const std::string& data) {
  uLongf size = compressBound(data.size());
  std::string out(size, '\0');
  compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(data.data()),
           data.size());
  out.resize(size);
  return out;
}

/// Triangle number `k` lies in z = k. Single precision with normals, or double precision with uv.
inline std::string serialized_mesh(int k, std::uint16_t version, bool doubles) {
  std::string body;
  append<std::uint32_t>(body, doubles ? 0x2002 : 0x1011);
  if (version == 4) body += std::string("mesh") + std::to_string(k) + '\0';
  append<std::uint64_t>(body, 3);
  append<std::uint64_t>(body, 1);
  const auto number = [&](double v) {
    if (doubles)
      append<double>(body, v);
    else
      append<float>(body, static_cast<float>(v));
  };
  for (const Vec2f& p : {Vec2f{0, 0}, Vec2f{1, 0}, Vec2f{0, 1}})
    for (const double v : {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(k)})
      number(v);
  if (doubles)
    for (const Vec2f& p : {Vec2f{0, 0}, Vec2f{1, 0}, Vec2f{0, 1}})
      number(p.x), number(p.y);
  else
    for (int i = 0; i < 3; ++i)
      number(0), number(0), number(1);
  for (const std::uint32_t i : {0u, 1u, 2u})
    append<std::uint32_t>(body, i);
  std::string file;
  append<std::uint16_t>(file, 0x041c);
  append<std::uint16_t>(file, version);
  return file + deflated(body);
}

/// A file of several meshes and its table.
inline std::string serialized_file(int meshes, std::uint16_t version = 4, bool doubles = false) {
  std::string file;
  std::vector<std::uint64_t> offsets;
  for (int k = 0; k < meshes; ++k) {
    offsets.push_back(file.size());
    file += serialized_mesh(k, version, doubles);
  }
  for (const auto offset : offsets)
    if (version == 4)
      append<std::uint64_t>(file, offset);
    else
      append<std::uint32_t>(file, static_cast<std::uint32_t>(offset));
  append<std::uint32_t>(file, static_cast<std::uint32_t>(meshes));
  return file;
}

} // namespace nacre

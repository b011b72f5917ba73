#pragma once
// Triangle meshes from files. What comes back is in object space, as the file has it: `place_mesh` moves it
// to the world. Triangles of no area are kept; they are never hit and weigh nothing in vertex normals.
// Polygons become fans about their first corner.

#include "scene/scene.h"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace nacre {

/// Wavefront OBJ: v, vt, vn, f with negative indices and polygons; groups, materials, lines and points are
/// passed over. Corners that share position, uv and normal share a vertex. Where some corners have a normal,
/// those without get the smooth one.
/// @throws Error with line and column: a number that is none or not finite, an index out of range, a keyword
/// that is not OBJ's, a free-form surface, no face at all
TriangleMesh read_obj(const std::string& path);
TriangleMesh parse_obj(std::string_view text, std::string_view name);

/// Stanford PLY: ascii, binary little and big endian; x y z, nx ny nz, and u v, s t or texture_u texture_v.
/// Other properties and elements are skipped. @throws Error with line and column or byte offset
TriangleMesh read_ply(const std::string& path);
TriangleMesh parse_ply(std::span<const std::uint8_t> bytes, std::string_view name);

/// The triangles of a glTF 2.0 file, .gltf or .glb, as its scene places them: positions, normals, the first
/// uv. Materials, cameras, skins and animations are passed over. @throws Error, also for compressed meshes
TriangleMesh read_gltf(const std::string& path);

struct SerializedMesh {
  std::string name;
  TriangleMesh mesh;
  bool face_normals = false; ///< the file asks for faceted shading
};
/// One of the meshes of Mitsuba's `.serialized` file, versions 3 and 4. Vertex colours are skipped.
/// @throws Error with byte offset
SerializedMesh read_serialized(const std::string& path, int shape_index = 0);
SerializedMesh parse_serialized(std::span<const std::uint8_t> bytes, int shape_index, std::string_view name);

/// Gives every vertex whose normal is missing or 0 the mean of the normals of its faces, weighted by their
/// angles there (Thuermer and Wuethrich 1998, Computing Vertex Normals from Polygonal Facets). A vertex of no
/// proper face gets +x.
void complete_vertex_normals(TriangleMesh& mesh);

/// Moves a mesh by `to_world`. Where the transform mirrors and the mesh has normals, faces are turned round,
/// so that both still agree about the outside. `flip_normals` turns faces and normals.
/// @throws Error if the transform is singular or a position leaves the range of float
void place_mesh(TriangleMesh& mesh, const Transform& to_world, bool flip_normals);

/// [-1, 1]^3 with outward normals; each face has uv over [0, 1]^2, laid out as in Mitsuba 3.
TriangleMesh cube_mesh();

} // namespace nacre

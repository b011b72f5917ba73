#pragma once
// The object that pictures of materials are made with since 1975.

#include "scene/scene.h"

namespace nacre {

/// The Utah teapot, +y up, some 6.4 long and 3.2 high, with normals and each patch's own uv.
/// Source: Newell 1975, The Utilization of Procedure Models in Digital Image Synthesis; Crow 1987, The
/// Origins of the Teapot, which prints the numbers.
/// @param segments  of an edge of its 32 bicubic patches, in [1, 256]. @throws Error outside
TriangleMesh teapot_mesh(int segments);

} // namespace nacre

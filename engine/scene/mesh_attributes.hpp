// SPDX-License-Identifier: MIT
// What a mesh must have and its file may lack: normals, tangents. Works on positions before or after centring.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.hpp"

namespace sheaf {

/// New vertex i is old vertex order[i], with all its attributes and morph deltas. Triangles are left as they are.
void reorder_vertices(Mesh& mesh, const std::vector<std::uint32_t>& order);

/// Gives each triangle three vertices of its own and the face's normal (glTF 2.0, 3.7.2.1). Tangents and the morph
/// deltas of normals are dropped: they mean nothing without the normals that the file left out. Sets `flat`.
void make_flat_normals(Mesh& mesh);

/// Makes every normal unit length; one of no length becomes its first triangle's.
void normalize_normals(Mesh& mesh);

/// Unit tangents along +u of the texture coordinates that `use` reads, transformed as it says, w = handedness.
/// Weighted by corner angle; a vertex between mirrored charts is split. Any perpendicular where u has no direction.
/// Of a flat mesh also the way +u runs in each triangle however it is deformed (Mesh::face_tangents).
void make_tangents(Mesh& mesh, const TextureUse& use);

}  // namespace sheaf

// SPDX-License-Identifier: MIT
#pragma once

#include "scene/gltf_primitive.hpp"

namespace sheaf {

/// Joints and weights: of each vertex at most eight, whose weights sum to 1.
void read_skinning(const PrimitiveReader& in, Mesh& mesh);

/// Morph targets, for the attributes that the mesh has.
void read_targets(const PrimitiveReader& in, Mesh& mesh);

}  // namespace sheaf

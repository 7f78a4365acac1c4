// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "scene/broken_objects.hpp"

namespace sheaf {

/// Checks the types, ranges and cross references of a glTF document before anything else reads it: tinygltf wraps large
/// integers, passes over values of the wrong type, and follows some references unchecked.
/// An element of a collection (an accessor, a camera …) that breaks a rule becomes a blank one and is named in the
/// result. Anything else throws Error{input}: "FILE: asset.version: "1.0" is not supported, only 2.x is".
[[nodiscard]] BrokenObjects check_gltf_document(nlohmann::json& document, const std::string& file);

}  // namespace sheaf

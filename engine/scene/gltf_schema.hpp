// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace sheaf {

/// Checks the types, ranges and cross references of a glTF document before anything else reads it: tinygltf wraps large
/// integers, passes over values of the wrong type, and follows some references unchecked.
/// Throws Error{input}: "FILE: accessors[3].bufferView: 7 is out of range, the file has 2 bufferViews".
void check_gltf_document(const nlohmann::json& document, const std::string& file);

}  // namespace sheaf

// SPDX-License-Identifier: MIT
// The layers that a frame may have beside its colours: their names, and which of them are asked for.
#pragma once

#include <array>
#include <string>

namespace sheaf {

struct LayerSet {
  bool depth = false, normal = false, position = false, albedo = false, uv = false, id = false, tests = false;
  [[nodiscard]] bool any_surface() const { return depth || normal || position || albedo || uv || id; }
};

struct LayerName {
  const char* name;
  bool LayerSet::*layer;
};

/// Every layer; "all" names them all.
inline constexpr std::array<LayerName, 7> layer_names{{{"Z", &LayerSet::depth},
                                                       {"N", &LayerSet::normal},
                                                       {"P", &LayerSet::position},
                                                       {"albedo", &LayerSet::albedo},
                                                       {"UV", &LayerSet::uv},
                                                       {"id", &LayerSet::id},
                                                       {"tests", &LayerSet::tests}}};

/// "Z, N, P, albedo, UV, id, tests, all".
[[nodiscard]] std::string list_of_layers();

/// Names with commas between them; none is no layer. Error{usage} for a name that there is not, with those that there
/// are.
[[nodiscard]] LayerSet parse_layers(const std::string& list);

}  // namespace sheaf

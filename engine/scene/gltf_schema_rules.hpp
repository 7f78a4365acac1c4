// SPDX-License-Identifier: MIT
// What a glTF document's values must be, as a table. A property that no rule names is not looked at.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace sheaf {

enum class JsonKind { object, objects, text, texts, boolean, integer, number, numbers, index, indices, index_map };

inline constexpr double schema_any =
    std::numeric_limits<float>::max();  // numbers end up as float: larger ones would become infinite

struct SchemaRule {
  const char* key;  // "" is the owner itself
  JsonKind kind;
  const char* of = "";  // index kinds: the collection they point into
  double lo = -schema_any, hi = schema_any;
  int size = 0;  // numbers: how many, 0 is any number
  bool required = false;
};

struct SchemaGroup {
  std::string owner;  // "accessors[].sparse": [] stands for every element
  std::vector<SchemaRule> rules;
};

inline constexpr double schema_max_size = 9007199254740992.0;  // 2^53, what a JSON number holds exactly
inline constexpr double schema_max_int = 2147483647.0;

/// Owners before what they own.
[[nodiscard]] std::vector<SchemaGroup> schema_rules();

}  // namespace sheaf

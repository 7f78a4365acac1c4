// SPDX-License-Identifier: MIT
#include "scene/gltf_mend.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "core/quote.hpp"
#include "scene/gltf_schema_rules.hpp"

namespace sheaf {
namespace {

using nlohmann::json;

// Properties that are integers wherever glTF has them, and lists and maps of integers.
constexpr std::string_view integers[] = {
    "buffer",   "byteOffset", "byteLength", "byteStride", "bufferView", "componentType", "count",
    "material", "mesh",       "skin",       "camera",     "indices",    "mode",          "sampler",
    "source",   "index",      "texCoord",   "input",      "output",     "node",          "scene",
    "light",    "skeleton",   "magFilter",  "minFilter",  "wrapS",      "wrapT",         "inverseBindMatrices"};
constexpr std::string_view integer_groups[] = {"joints", "children", "nodes", "attributes", "targets"};

template <class List>
bool contains(const List& list, std::string_view key) {
  return std::ranges::find(list, key) != std::end(list);
}

class Mender {
 public:
  explicit Mender(WarningList& warnings) : warnings_(warnings) {}

  // `whole` says that numbers within are integers. Recursion is bounded by the parser's limit of depth.
  void visit(json& value, const std::string& place, bool whole) {
    if (value.is_array()) {
      for (std::size_t i = 0; i < value.size(); ++i) {
        const json::value_t type = value[i].type();
        const bool plain = type != json::value_t::object && type != json::value_t::array;
        if (plain && !(whole && type == json::value_t::number_float)) continue;  // most of a large file
        visit(value[i], place + "[" + std::to_string(i) + "]", whole);
      }
    } else if (value.is_object()) {
      visit_members(value, place, whole);
    } else if (whole && value.is_number_float()) {
      make_integer(value, place);
    }
  }

 private:
  void visit_members(json& object, const std::string& place, bool whole) {
    for (auto member = object.begin(); member != object.end();) {
      const std::string& key = member.key();
      if (key == "extras") {  // belongs to who wrote it
        ++member;
        continue;
      }
      const std::string inner = place.empty() ? quote(key, 60) : place + "." + quote(key, 60);
      if (const char* reason = surplus(key, *member)) {
        warnings_.add(inner, reason);
        member = object.erase(member);
        continue;
      }
      const bool list = member->is_structured();
      visit(*member, inner, whole || (list ? holds_integers(key, *member) : contains(integers, key)));
      ++member;
    }
  }

  // A scene's `nodes` are numbers, the document's are objects.
  static bool holds_integers(const std::string& key, const json& list) {
    return contains(integer_groups, key) && !(key == "nodes" && !list.empty() && list.front().is_object());
  }

  // Why a property is taken away, or null.
  static const char* surplus(const std::string& key, const json& value) {
    if (value.is_null()) return "is null, taken as not given";
    if (key == "byteStride" && value.is_number() && value.get<double>() == 0) return "is 0, taken as not given";
    if (key == "uri" && value.is_string() && value.get_ref<const std::string&>().empty())
      return "is empty, taken as not given";
    return nullptr;
  }

  void make_integer(json& value, const std::string& place) {
    const double number = value.get<double>();
    if (number != std::floor(number) || std::abs(number) > schema_max_size) return;
    warnings_.add(place, "is written " + value.dump() + ", with a fraction, and must be a whole number");
    if (number >= 0) {
      value = static_cast<std::uint64_t>(number);
    } else {
      value = static_cast<std::int64_t>(number);
    }
  }

  WarningList& warnings_;
};

}  // namespace

void mend_document(json& document, WarningList& warnings) {
  if (!document.is_object()) return;
  Mender(warnings).visit(document, "", false);
  const auto asset = document.find("asset");
  if (asset == document.end() || !asset->is_object()) return;
  const auto version = asset->find("version");
  if (version == asset->end() || !version->is_number()) return;
  warnings.add("asset.version", "is a number, and must be a string");
  *version = version->dump();
}

}  // namespace sheaf

// SPDX-License-Identifier: MIT
#include "json_mutator.hpp"

#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <vector>

namespace sheaf::fuzz {
namespace {

using nlohmann::json;

/// The values of the tree, its root first, each with the one that holds it.
struct Place {
  json* value;
  json* parent;
};

void collect(json& value, json* parent, std::vector<Place>& places) {
  if (places.size() > 4096) return;
  places.push_back({&value, parent});
  if (!value.is_structured()) return;
  for (json& inner : value) collect(inner, &value, places);
}

template <typename Random>
json odd_number(Random& random, const json& was) {
  static const std::vector<json> odd{0,
                                     1,
                                     -1,
                                     2,
                                     3,
                                     4,
                                     255,
                                     256,
                                     65535,
                                     65536,
                                     5120,
                                     5121,
                                     5123,
                                     5125,
                                     5126,
                                     2147483647,
                                     2147483648LL,
                                     4294967295LL,
                                     4294967296LL,
                                     std::numeric_limits<std::int64_t>::max(),
                                     std::numeric_limits<std::uint64_t>::max(),
                                     std::numeric_limits<std::int64_t>::min(),
                                     0.5,
                                     1e-320,
                                     1e38,
                                     -1e300,
                                     1e308};
  switch (random() % 4) {
    case 0:
      return was.is_number() ? json(was.get<double>() * 2) : json(7);
    case 1:
      return was.is_number_integer() ? json(static_cast<std::int64_t>(was.get<std::uint64_t>() + random() % 9 - 4))
                                     : json(0);
    default:
      return odd[random() % odd.size()];
  }
}

void remove(Place place, std::size_t at) {
  if (place.value->empty()) return;
  at %= place.value->size();
  if (place.value->is_array()) place.value->erase(at);
  if (place.value->is_object()) place.value->erase(std::next(place.value->begin(), static_cast<std::ptrdiff_t>(at)));
}

}  // namespace

std::string mutated_json(const std::string& text, unsigned seed) {
  json document = json::parse(text, nullptr, false);
  if (document.is_discarded()) return text;
  std::minstd_rand random(seed);
  std::vector<Place> places;
  collect(document, nullptr, places);
  const Place place = places[random() % places.size()], other = places[random() % places.size()];
  switch (random() % 8) {
    case 0:
    case 1:
    case 2:
      *place.value = odd_number(random, *place.value);
      break;
    case 3:
      *place.value = json(*other.value);
      break;
    case 4:
      remove(place, random());
      break;
    case 5:
      if (place.value->is_array()) {
        json copy = *other.value;
        place.value->push_back(std::move(copy));
      }
      if (place.value->is_object() && other.parent && other.parent->is_object()) {
        const json more = *other.parent;  // the place may lie within it
        place.value->update(more);
      }
      break;
    case 6:
      if (place.value->is_array() && !place.value->empty()) {
        const json first = place.value->front();
        for (unsigned more = random() % 64; more > 0; --more) place.value->push_back(first);
      }
      break;
    default: {
      static const std::vector<json> kinds{nullptr, true, "", "x", json::array(), json::object(), json::array({0})};
      *place.value = kinds[random() % kinds.size()];
    }
  }
  return document.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace sheaf::fuzz

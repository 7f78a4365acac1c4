// SPDX-License-Identifier: MIT
#include "scene/camera_path_json.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "core/error.hpp"
#include "scene/last_row.hpp"
#include "scene/rigid.hpp"

namespace sheaf {

JsonObject::JsonObject(const nlohmann::json& value, std::string file, std::string place)
    : value_(value), file_(std::move(file)), place_(std::move(place)) {
  if (!value.is_object()) fail("", std::string("must be an object, not ") + value.type_name());
}

void JsonObject::fail(const std::string& key, const std::string& reason) const {
  const std::string dot = place_.empty() || key.empty() ? "" : ".";
  const std::string where = place_ + dot + key;
  throw input_error(file_ + (where.empty() ? "" : ": " + where), reason);
}

void JsonObject::only(std::initializer_list<const char*> known) const {
  for (const auto& [key, value] : value_.items()) {
    const std::string& name = key;
    if (std::ranges::none_of(known, [&](const char* k) { return name == k; })) {
      fail("", "unknown key " + in_quotes(name));
    }
  }
}

const nlohmann::json& JsonObject::get(const char* key) const {
  const auto found = value_.find(key);
  if (found == value_.end()) fail(key, "is missing");
  return *found;
}

double JsonObject::number(const char* key) const {
  const nlohmann::json& value = get(key);
  if (!value.is_number()) fail(key, std::string("must be a number, not ") + value.type_name());
  return value.get<double>();  // JSON holds no NaN or infinity, and the parser refuses overflow
}

std::vector<double> JsonObject::numbers(const char* key, std::size_t count) const {
  const nlohmann::json& value = get(key);
  if (!value.is_array() || value.size() != count) fail(key, "must be a list of " + std::to_string(count) + " numbers");
  for (const auto& element : value) {
    if (!element.is_number()) fail(key, std::string("must hold numbers, not ") + element.type_name());
  }
  return value.get<std::vector<double>>();
}

std::vector<double> JsonObject::rows_of_4(const char* key) const {
  const nlohmann::json& value = get(key);
  const auto refuse = [&] { fail(key, "must be a list of 16 numbers, or 4 rows of 4"); };
  if (!value.is_array()) refuse();
  std::vector<double> out;
  const auto append = [&](const nlohmann::json& list) {
    for (const auto& element : list) {
      if (!element.is_number()) fail(key, std::string("must hold numbers, not ") + element.type_name());
      out.push_back(element.get<double>());
    }
  };
  const bool nested = !value.empty() && value.front().is_array();
  if (!nested && value.size() <= 16) append(value);
  if (nested && value.size() <= 4) {
    for (const auto& row : value) {
      if (!row.is_array() || row.size() != 4) refuse();
      append(row);
    }
  }
  if (out.size() == 12) out.insert(out.end(), {0, 0, 0, 1});
  if (out.size() != 16) refuse();
  return out;
}

glm::dvec3 JsonObject::vec3(const char* key) const {
  const std::vector<double> v = numbers(key, 3);
  return {v[0], v[1], v[2]};
}

bool JsonObject::boolean_or(const char* key, bool otherwise) const {
  if (!has(key)) return otherwise;
  if (!get(key).is_boolean()) fail(key, std::string("must be true or false, not ") + get(key).type_name());
  return get(key).get<bool>();
}

std::string JsonObject::text(const char* key) const {
  if (!get(key).is_string()) fail(key, std::string("must be a string, not ") + get(key).type_name());
  return get(key).get<std::string>();
}

std::vector<JsonObject> JsonObject::objects(const char* key) const {
  const nlohmann::json& list = get(key);
  if (!list.is_array() || list.empty()) fail(key, "must be a list with at least one element");
  std::vector<JsonObject> out;
  for (std::size_t i = 0; i < list.size(); ++i) {
    out.emplace_back(list[i], file_, (place_.empty() ? "" : place_ + ".") + key + "[" + std::to_string(i) + "]");
  }
  return out;
}

void pose_from_matrix(const JsonObject& object, const char* key, glm::dmat4 matrix, CameraKey& out) {
  if (round_last_row(matrix) == Rounding::impossible) object.fail(key, "has a last row other than 0 0 0 1");
  const glm::dmat3 basis(matrix);
  const double lengths = glm::length(basis[0]) * glm::length(basis[1]) * glm::length(basis[2]);
  const double determinant = glm::determinant(basis);
  // Relative to its columns, so that scale does not matter: 1 is a rotation, 0 is flat.
  if (!(lengths > 0) || !std::isfinite(lengths) || std::abs(determinant) < 1e-6 * lengths) {
    object.fail(key, "is singular");
  }
  if (determinant < 0) object.fail(key, "is a reflection");
  out.position = glm::dvec3(matrix[3]);
  out.rotation = unit_or_identity(glm::quat_cast(orthonormal_basis(basis)));
}

double read_fps(const JsonObject& object, const nlohmann::json& value) {
  double fps = 0;
  if (value.is_number()) {
    fps = value.get<double>();
  } else if (value.is_string()) {
    const std::string text = value.get<std::string>();
    const char *begin = text.data(), *end = begin + text.size();
    unsigned numerator = 0, denominator = 1;
    auto [at, error] = std::from_chars(begin, end, numerator);
    if (error == std::errc{} && at != end && *at == '/') {
      const auto second = std::from_chars(at + 1, end, denominator);
      at = second.ptr, error = second.ec;
    }
    if (error == std::errc{} && at == end && denominator > 0) fps = double(numerator) / denominator;
  }
  if (!(fps > 0) || fps > 1e6) object.fail("fps", "must be a positive number or a fraction such as \"24000/1001\"");
  return fps;
}

}  // namespace sheaf

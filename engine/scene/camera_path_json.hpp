// SPDX-License-Identifier: MIT
// A JSON object read strictly: values by type with the place in every error, and keys that nobody asked for refused.
#pragma once

#include <glm/glm.hpp>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scene/camera_path.hpp"

namespace sheaf {

class JsonObject {
 public:
  /// `place` is "" for the document itself. Throws where `value` is no object.
  JsonObject(const nlohmann::json& value, std::string file, std::string place);

  [[noreturn]] void fail(const std::string& key, const std::string& reason) const;
  void only(std::initializer_list<const char*> known) const;  // refuses any other key, by name

  /// Null stands for a key that is not there.
  [[nodiscard]] bool has(const char* key) const { return value_.contains(key) && !value_.at(key).is_null(); }
  [[nodiscard]] double number(const char* key) const;
  [[nodiscard]] double number_or(const char* key, double otherwise) const { return has(key) ? number(key) : otherwise; }
  [[nodiscard]] std::vector<double> numbers(const char* key, std::size_t count) const;
  /// The rows of a matrix, each a list of numbers, one after another; or all numbers in one list. 4 rows of 4, or the
  /// upper 3 of them, completed by 0 0 0 1.
  [[nodiscard]] std::vector<double> rows_of_4(const char* key) const;
  [[nodiscard]] glm::dvec3 vec3(const char* key) const;
  [[nodiscard]] bool boolean_or(const char* key, bool otherwise) const;
  [[nodiscard]] std::string text(const char* key) const;
  /// The elements of a list of objects; at least one.
  [[nodiscard]] std::vector<JsonObject> objects(const char* key) const;

 private:
  [[nodiscard]] const nlohmann::json& get(const char* key) const;

  const nlohmann::json& value_;
  std::string file_, place_;
};

/// Camera-to-world, already column-major: a key's position and rotation, scale removed. Refuses reflections, singular
/// matrices and projective ones; a last row that was rounded is made exact.
void pose_from_matrix(const JsonObject& object, const char* key, glm::dmat4 matrix, CameraKey& out);

/// The fps of a path: a positive number, or "24000/1001".
[[nodiscard]] double read_fps(const JsonObject& object, const nlohmann::json& value);

/// Nerfstudio's camera_path.json.
[[nodiscard]] CameraPath read_nerfstudio_path(const JsonObject& object, const nlohmann::json& document);

}  // namespace sheaf

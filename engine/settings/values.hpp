// SPDX-License-Identifier: MIT
// The types that settings have. `Value<T>` says how a T is written on the command line and in JSON, and how it is read,
// shown and held against a range. A setting of a type that stands here needs nothing beside its entry in table.def; a
// new type is a specialization here.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/choice.hpp"
#include "output/layer_set.hpp"
#include "sampling/sample_count.hpp"

namespace sheaf {

// Texts that mean something. They are strings, so that whoever uses them needs no conversion.
struct NameOrIndex : std::string {};   // of a thing in the scene or of a device
struct FrameList : std::string {};     // see parse_frames
struct FramePattern : std::string {};  // see FrameNames
struct PresetName : std::string {};    // see presets
struct FilePath : std::string {};
struct FolderPath : std::string {};

struct ImageSize {
  std::uint32_t width = 1280, height = 720;
};
struct NumberOrInfinity {
  float value = 0;                          // a NaN is what was too large for a float
  operator float() const { return value; }  // NOLINT(google-explicit-constructor): it is a float that JSON cannot hold
};
struct Rate : std::optional<double> {};  // a number or a fraction

/// Bounds of a number; of a colour's components and of an image's sides alike. None where low = high.
struct Range {
  double low = 0, high = 0;
  bool above = false;  // low itself is not allowed
  [[nodiscard]] bool bounded() const { return low < high; }
};

/// What JSON may give for a value beside what the command line takes. The schema and the reading of JSON follow it.
struct JsonForm {
  const char* scalar = nullptr;   // "boolean", "integer" or "number"
  bool text = false;              // a string, as on the command line
  const char* pattern = nullptr;  // of the string. Then a string that is a plain number is refused.
  const char* items = nullptr;    // an array of these becomes a string
  std::size_t count = 0;          // of the items; 0: one or more
  char separator = ',';           // between the items
  std::size_t most_bytes = 255;   // of the string
};

struct Kind {
  const char* name;    // in `sheaf options` and in the schema
  const char* syntax;  // on the command line; empty: none
  JsonForm json{};
  std::span<const char* const> choices{};
};

/// What most types need not say. Reasons are empty where there is nothing to complain about.
template <typename T>
struct PlainValue {
  static std::string outside(const T&, const Range&) { return {}; }  // why it is out of the range
  static std::uint64_t amount(const T&) { return 0; }                // what a service's limit counts
};

template <typename T>
struct Value;

[[nodiscard]] std::string outside_range(double value, const Range& range);
[[nodiscard]] std::string one_of(std::span<const char* const> choices);  // "must be one of a, b, c"
/// The whole text as a number. A leading plus is allowed; what is too large becomes infinite.
[[nodiscard]] bool read_number(std::string_view text, double& number);
/// As decimal digits that give the same float back, for JSON without the digits of the double nearest to it.
[[nodiscard]] double short_double(float value);

template <>
struct Value<bool> : PlainValue<bool> {
  static constexpr Kind kind{"flag", "", {.scalar = "boolean"}};
  static std::string read(std::string_view text, bool& value);
  static nlohmann::ordered_json show(bool value) { return value; }
};

[[nodiscard]] std::string read_whole(std::string_view text, std::uint64_t most, std::uint64_t& value);

template <std::unsigned_integral T>
struct Value<T> {
  static constexpr Kind kind{"integer", "N", {.scalar = "integer"}};
  static std::string read(std::string_view text, T& value) {
    std::uint64_t wide = 0;
    std::string reason = read_whole(text, std::numeric_limits<T>::max(), wide);
    value = static_cast<T>(wide);
    return reason;
  }
  static nlohmann::ordered_json show(T value) { return value; }
  static std::string outside(T value, const Range& range) { return outside_range(static_cast<double>(value), range); }
  static std::uint64_t amount(T value) { return value; }
};

template <std::floating_point T>
struct Value<T> : PlainValue<T> {
  static constexpr Kind kind{"number", "X", {.scalar = "number"}};
  static std::string read(std::string_view text, T& value) {
    double wide = 0;
    if (!read_number(text, wide)) return "must be a number";
    value = static_cast<T>(wide);
    return {};
  }
  static nlohmann::ordered_json show(T value) {
    if constexpr (sizeof(T) == sizeof(float)) return short_double(value);
    return value;
  }
  static std::string outside(T value, const Range& range) { return outside_range(value, range); }
};

template <>
struct Value<NumberOrInfinity> : PlainValue<NumberOrInfinity> {
  static constexpr Kind kind{"number-or-inf", "X|inf", {.scalar = "number", .text = true, .pattern = "^[+-]?inf$"}};
  static std::string read(std::string_view text, NumberOrInfinity& value);
  static nlohmann::ordered_json show(const NumberOrInfinity& value);
  static std::string outside(const NumberOrInfinity& value, const Range& range);
};

template <NamedEnum E>
struct Value<E> : PlainValue<E> {
  static constexpr Kind kind{"choice", "NAME", {.text = true}, choices_of<E>};
  static std::string read(std::string_view text, E& value) {
    const auto found = find_choice<E>(text);
    if (!found) return one_of(choices_of<E>);
    value = *found;
    return {};
  }
  static nlohmann::ordered_json show(E value) { return name_of(value); }
};

template <std::derived_from<std::string> T>
struct TextValue : PlainValue<T> {
  static std::string read(std::string_view text, T& value) {
    value.assign(text);
    return {};
  }
  static nlohmann::ordered_json show(const T& value) {
    return value.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(static_cast<const std::string&>(value));
  }
};

template <>
struct Value<NameOrIndex> : TextValue<NameOrIndex> {
  static constexpr Kind kind{"name-or-index", "NAME|INDEX", {.scalar = "integer", .text = true}};
};
template <>
struct Value<FilePath> : TextValue<FilePath> {
  static constexpr Kind kind{"file", "FILE"};
};
template <>
struct Value<FolderPath> : TextValue<FolderPath> {
  static constexpr Kind kind{"folder", "DIR"};
};

template <>
struct Value<FrameList> : TextValue<FrameList> {
  static constexpr Kind kind{
      "frames", "A-B[:STEP]|N,M,...", {.scalar = "integer", .text = true, .items = "integer", .most_bytes = 1U << 20U}};
  static std::string read(std::string_view text, FrameList& value);
  static std::uint64_t amount(const FrameList& value);
};

template <>
struct Value<FramePattern> : TextValue<FramePattern> {
  static constexpr Kind kind{"text", "PATTERN", {.text = true}};
  static std::string read(std::string_view text, FramePattern& value);
};

template <>
struct Value<Rate> : PlainValue<Rate> {
  static constexpr Kind kind{
      "rate", "N|N/M", {.scalar = "number", .text = true, .pattern = "^[0-9.eE+-]+/[0-9.eE+-]+$"}};
  static std::string read(std::string_view text, Rate& value);
  static nlohmann::ordered_json show(const Rate& value) {
    return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
  }
  static std::string outside(const Rate& value, const Range& range) { return outside_range(*value, range); }
};

template <>
struct Value<SampleCount> {
  static constexpr Kind kind{"samples",
                             "N|adaptive:ERROR[:MOST]",
                             {.scalar = "integer", .text = true, .pattern = "^adaptive:[0-9.eE+-]+(:[0-9]+)?$"}};
  static std::string read(std::string_view text, SampleCount& value);
  static nlohmann::ordered_json show(const SampleCount& value);
  static std::string outside(const SampleCount& value, const Range& range);
  static std::uint64_t amount(const SampleCount& value) { return value.most; }
};

template <>
struct Value<ImageSize> {
  static constexpr Kind kind{
      "size", "WxH", {.text = true, .pattern = "^[0-9]+x[0-9]+$", .items = "integer", .count = 2, .separator = 'x'}};
  static std::string read(std::string_view text, ImageSize& value);
  static nlohmann::ordered_json show(const ImageSize& value);
  static std::string outside(const ImageSize& value, const Range& range);
  static std::uint64_t amount(const ImageSize& value) { return std::uint64_t{value.width} * value.height; }
};

template <>
struct Value<std::optional<glm::vec3>> : PlainValue<std::optional<glm::vec3>> {
  static constexpr Kind kind{"color", "R,G,B", {.text = true, .items = "number", .count = 3}};
  static std::string read(std::string_view text, std::optional<glm::vec3>& value);
  static nlohmann::ordered_json show(const std::optional<glm::vec3>& value);
  static std::string outside(const std::optional<glm::vec3>& value, const Range& range);
};

template <>
struct Value<LayerSet> : PlainValue<LayerSet> {
  static constexpr auto names = [] {
    std::array<const char*, layer_names.size() + 1> list{};
    for (std::size_t i = 0; i < layer_names.size(); ++i) list[i] = layer_names[i].name;
    list.back() = "all";
    return list;
  }();
  static constexpr Kind kind{"layers", "LIST", {.text = true, .items = "string", .most_bytes = 1024}, names};
  static std::string read(std::string_view text, LayerSet& value);
  static nlohmann::ordered_json show(const LayerSet& value);
};

}  // namespace sheaf

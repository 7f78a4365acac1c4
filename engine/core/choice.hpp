// SPDX-License-Identifier: MIT
// Enumerations whose values have names. Beside the enumeration E stands `constexpr auto choice_names(E)`: an array of
// the names in the order of the values, which count from 0.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <type_traits>

namespace sheaf {

template <typename E>
concept NamedEnum = std::is_enum_v<E> && requires(E value) {
  choice_names(value).size();
};

template <NamedEnum E>
inline constexpr auto choices_of = choice_names(E{});

template <NamedEnum E>
[[nodiscard]] constexpr const char* name_of(E value) {
  return choices_of<E>[static_cast<std::size_t>(value)];
}

/// Nothing where there is no value of that name.
template <NamedEnum E>
[[nodiscard]] constexpr std::optional<E> find_choice(std::string_view name) {
  for (std::size_t i = 0; i < choices_of<E>.size(); ++i)
    if (name == choices_of<E>[i]) return static_cast<E>(i);
  return std::nullopt;
}

}  // namespace sheaf

// SPDX-License-Identifier: MIT
// The table of settings as JSON, and values of settings that come as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "settings/setting.hpp"

namespace sheaf {

/// What `sheaf options --json` prints: an array, an object for each setting.
[[nodiscard]] nlohmann::ordered_json settings_description();

/// The JSON Schema of a job's settings, `properties` of an object. Keys that begin with x- are what the page and
/// clients may want to know beside it.
[[nodiscard]] nlohmann::ordered_json settings_schema();

/// A JSON value as the command line's text. Gives the reason why it is none that the setting takes; empty: `text` is
/// it.
[[nodiscard]] std::string text_from_json(const Setting& setting, const nlohmann::json& value, std::string& text);

}  // namespace sheaf

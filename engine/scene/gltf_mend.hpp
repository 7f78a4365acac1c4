// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>

#include "scene/warning_list.hpp"

namespace sheaf {

/// Puts right what exporters write against the rules of form though it has one meaning: null for a property that is not
/// there, 3.0 for the integer 3, byteStride 0 for none, an empty URI, a version that is a number. Each is a warning.
void mend_document(nlohmann::json& document, WarningList& warnings);

}  // namespace sheaf

// SPDX-License-Identifier: MIT
#pragma once

namespace sheaf::server {

// Files of server/resources, put into the program by the build.
extern const char* const openapi_json;
extern const char* const index_html;

}  // namespace sheaf::server

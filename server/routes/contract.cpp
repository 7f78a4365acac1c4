// SPDX-License-Identifier: MIT
#include "routes/contract.hpp"

#include "routes/limit_table.hpp"
#include "routes/resources.hpp"
#include "settings/setting_json.hpp"

namespace sheaf::server {

nlohmann::ordered_json contract_of(const ServiceOptions& options) {
  auto contract = nlohmann::ordered_json::parse(openapi_json);
  contract.at("components").at("schemas").at("Settings")["properties"] = settings_schema();
  contract["x-limits"] = limit_table(options);
  return contract;
}

}  // namespace sheaf::server

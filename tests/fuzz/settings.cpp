// SPDX-License-Identifier: MIT
// The settings part of a submission. What is accepted keeps the limits and makes no argument that another program could
// take for something else.
#include "jobs/settings.hpp"

#include "target.hpp"
#include "util/problem.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sheaf;
  using namespace sheaf::server;
  if (size == 0) return 0;
  const auto given = nlohmann::json::parse(fuzz::as_text(data + 1, size - 1), nullptr, false);
  if (given.is_discarded()) return 0;
  try {
    const Limits limits;
    const Settings settings = parse_settings(given, data[0] % 2 == 1, limits);
    fuzz::require(!settings.frames || settings.frames->size() <= limits.frames, "the limit of frames holds");
    for (const std::string& argument : settings.arguments) {
      fuzz::require(argument.starts_with("--") && argument.find('\0') == std::string::npos, "an option, whole");
      fuzz::require(
          !argument.starts_with("--out") && !argument.starts_with("--dump") && !argument.starts_with("--stats"),
          "no file of the client's choice is written");
    }
    (void)settings.resolved.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  } catch (const Problem&) {
    // Refused, with a reason.
  }
  return 0;
}

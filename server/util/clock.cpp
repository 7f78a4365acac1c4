// SPDX-License-Identifier: MIT
#include "util/clock.hpp"

#include <cstdio>
#include <ctime>

namespace sheaf::server {

std::string rfc3339(WallTime time) {
  using namespace std::chrono;
  const auto ms = floor<milliseconds>(time);
  const auto whole = floor<seconds>(ms);
  const std::time_t t = system_clock::to_time_t(time_point_cast<system_clock::duration>(whole));
  std::tm utc{};
  ::gmtime_r(&t, &utc);
  char text[80];
  std::snprintf(text, sizeof text, "%04d-%02d-%02dT%02d:%02d:%02d.%03dZ", utc.tm_year + 1900, utc.tm_mon + 1,
                utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec, static_cast<int>((ms - whole).count()));
  return text;
}

}  // namespace sheaf::server

// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace sheaf {

/// What a file's reader has to say without refusing the file: each line once, and of one kind no more than twenty. A
/// kind is a reason without its numbers and quotations.
class WarningList {
 public:
  void add(const std::string& place, const std::string& reason);

  /// The lines in order, then for each kind that had more how many those were. Empties the list.
  [[nodiscard]] std::vector<std::string> take();

 private:
  struct Kind {
    std::size_t shown = 0, left_out = 0;
    std::string first;  // its line
  };
  std::vector<std::string> lines_;
  std::set<std::string> known_;
  std::map<std::string, Kind> kinds_;
};

}  // namespace sheaf

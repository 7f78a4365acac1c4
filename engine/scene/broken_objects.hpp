// SPDX-License-Identifier: MIT
// Objects of a glTF file that break its rules. Each is replaced by a blank one, so that all others keep their numbers;
// who needs it meets the reason, and where nobody does the file is read.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>

namespace sheaf {

struct Fault {
  std::string place, reason;
};

class BrokenObjects {
 public:
  /// `collection` is the last word of "accessors" or "extensions.KHR_lights_punctual.lights". The first fault stays.
  void mark(const std::string& collection, std::size_t index, Fault fault) {
    faults_[collection].try_emplace(index, std::move(fault));
  }
  [[nodiscard]] const Fault* find(const std::string& collection, std::size_t index) const {
    if (faults_.empty()) return nullptr;
    const auto list = faults_.find(collection);
    if (list == faults_.end()) return nullptr;
    const auto found = list->second.find(index);
    return found == list->second.end() ? nullptr : &found->second;
  }
  [[nodiscard]] const std::map<std::string, std::map<std::size_t, Fault>>& all() const { return faults_; }

 private:
  std::map<std::string, std::map<std::size_t, Fault>> faults_;
};

}  // namespace sheaf

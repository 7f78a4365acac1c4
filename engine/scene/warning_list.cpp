// SPDX-License-Identifier: MIT
#include "scene/warning_list.hpp"

#include "core/quote.hpp"

namespace sheaf {
namespace {

constexpr std::size_t most_of_a_kind = 20;

std::string kind_of(const std::string& reason) {
  std::string kind;
  bool in_quotes = false;
  for (const char c : reason) {
    if (c == '"') in_quotes = !in_quotes;
    if (!in_quotes && (c < '0' || c > '9')) kind += c;
  }
  return kind;
}

}  // namespace

void WarningList::add(const std::string& place, const std::string& reason) {
  Kind& kind = kinds_[kind_of(reason)];
  if (kind.shown == most_of_a_kind) {
    ++kind.left_out;
    return;
  }
  const std::string line = one_line(bounded_words(place + ": " + reason));
  if (!known_.insert(line).second) return;
  if (++kind.shown == 1) kind.first = line;
  lines_.push_back(line);
}

std::vector<std::string> WarningList::take() {
  for (const auto& [text, kind] : kinds_) {
    if (kind.left_out > 0)
      lines_.push_back(std::to_string(kind.left_out) + " more warnings like \"" + kind.first + "\"");
  }
  known_.clear();
  kinds_.clear();
  return std::exchange(lines_, {});
}

}  // namespace sheaf

// SPDX-License-Identifier: MIT
// The command line of `sheaf render`: an option for each setting of the table.
#pragma once

#include <string>
#include <vector>

#include "settings/setting.hpp"

namespace CLI {
class App;
}

namespace sheaf {

class RenderLine {
 public:
  /// Adds the options to a subcommand; this object is what they are parsed into, and must stay where it is.
  explicit RenderLine(CLI::App& command);
  RenderLine(const RenderLine&) = delete;
  RenderLine& operator=(const RenderLine&) = delete;

  /// How progress is shown, which is known before anything else is looked at. Throws Error{usage}.
  [[nodiscard]] ProgressMode progress() const;

  /// Throws Error{usage} or Error{input} naming the option and the reason.
  [[nodiscard]] RenderOptions options() const;

 private:
  [[nodiscard]] std::vector<Given> given() const;

  CLI::App& command_;
  std::string scene_;
  std::vector<std::string> texts_;  // of the table's settings, in its order
};

}  // namespace sheaf

// SPDX-License-Identifier: MIT
#include "output/layer_set.hpp"

#include <sstream>

#include "core/error.hpp"
#include "core/quote.hpp"

namespace sheaf {

std::string list_of_layers() {
  std::string list;
  for (const LayerName& known : layer_names) list += std::string(known.name) + ", ";
  return list + "all";
}

LayerSet parse_layers(const std::string& list) {
  LayerSet layers;
  std::stringstream parts(list);
  for (std::string part; std::getline(parts, part, ',');) {
    bool found = false;
    for (const LayerName& known : layer_names)
      if (part == "all" || part == known.name) layers.*known.layer = found = true;
    if (!found) throw Error(ErrorKind::usage, "--aov " + quote(part) + ": there is " + list_of_layers());
  }
  return layers;
}

}  // namespace sheaf

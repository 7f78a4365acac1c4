// SPDX-License-Identifier: MIT
// For targets whose input is JSON behind SHEAF_JSON_AT bytes.
#include <algorithm>

#include "json_mutator.hpp"

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  constexpr std::size_t head = SHEAF_JSON_AT;
  if (size <= head || seed % 2 == 0) return LLVMFuzzerMutate(data, size, max_size);
  const std::string all =
      std::string(data, data + head) + sheaf::fuzz::mutated_json(std::string(data + head, data + size), seed);
  std::copy_n(all.begin(), std::min(all.size(), max_size), data);
  return std::min(all.size(), max_size);
}

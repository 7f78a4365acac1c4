// SPDX-License-Identifier: MIT
// Mutations of JSON that leave it JSON: bytes changed blindly seldom get past the parser. Beside them libFuzzer's own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace sheaf::fuzz {

/// `text` changed in one place of its tree; as it was if it is no JSON.
[[nodiscard]] std::string mutated_json(const std::string& text, unsigned seed);

}  // namespace sheaf::fuzz

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

// SPDX-License-Identifier: MIT
// SHA-256 (FIPS 180-4), of data that arrives in pieces too: uploads on their way to disk, frames read back in blocks.
#pragma once

#include <openssl/evp.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace sheaf {

class Sha256 {
 public:
  Sha256();
  void update(std::string_view bytes);

  /// Ends the message: 64 lower-case hexadecimal digits. The object is spent afterwards.
  [[nodiscard]] std::string finish();

 private:
  struct Free {
    void operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }
  };
  std::unique_ptr<EVP_MD_CTX, Free> context_;
};

[[nodiscard]] std::string sha256_of(std::string_view bytes);
[[nodiscard]] std::string sha256_of(std::span<const std::uint8_t> bytes);

}  // namespace sheaf

// SPDX-License-Identifier: MIT
#include "core/sha256.hpp"

#include <array>
#include <new>

namespace sheaf {
namespace {

void require(int done) {
  if (done != 1) throw std::bad_alloc();  // the one way in which libcrypto's SHA-256 can fail
}

}  // namespace

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  if (!context_) throw std::bad_alloc();
  require(EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr));
}

void Sha256::update(std::string_view bytes) { require(EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size())); }

std::string Sha256::finish() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int length = 0;
  require(EVP_DigestFinal_ex(context_.get(), digest.data(), &length));
  std::string hex;
  for (unsigned int i = 0; i < length; ++i) {
    constexpr const char* digits = "0123456789abcdef";
    hex += digits[digest[i] >> 4U];
    hex += digits[digest[i] & 15U];
  }
  return hex;
}

std::string sha256_of(std::string_view bytes) {
  Sha256 hash;
  hash.update(bytes);
  return hash.finish();
}

std::string sha256_of(std::span<const std::uint8_t> bytes) {
  return sha256_of({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace sheaf

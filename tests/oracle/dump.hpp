// SPDX-License-Identifier: MIT
// The arrays that `sheaf render --dump` writes: one frame's triangles, and a batch of rays and hits a generation and
// kind.
#pragma once

#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "truth.hpp"

namespace oracle {

/// A dump that is not what it should be.
struct BadDump : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A .npy file mapped into memory. Its dtype and shape must be as wanted; a row has `row_bytes`.
class NpyArray {
 public:
  NpyArray(const std::filesystem::path& path, const std::string& descr, std::size_t row_bytes);
  ~NpyArray();
  NpyArray(NpyArray&& other) noexcept;
  NpyArray(const NpyArray&) = delete;
  NpyArray& operator=(const NpyArray&) = delete;
  NpyArray& operator=(NpyArray&&) = delete;
  template <typename Row>
  [[nodiscard]] std::span<const Row> rows() const {
    return {reinterpret_cast<const Row*>(static_cast<const char*>(memory_) + data_at_), rows_};
  }

 private:
  void* memory_ = nullptr;
  std::size_t size_ = 0, data_at_ = 0, rows_ = 0;
};

struct Batch {
  std::uint32_t generation;
  std::string kind;  // primary, shadow, reflection, refraction
  std::filesystem::path rays, hits;
};

struct Frame {
  std::string name;  // f0012
  std::filesystem::path triangles;
  std::vector<Batch> batches;
};

/// Every frame in a folder, in order.
std::vector<Frame> frames_in(const std::filesystem::path& folder);

NpyArray open_triangles(const std::filesystem::path& path);
NpyArray open_rays(const std::filesystem::path& path);
NpyArray open_hits(const std::filesystem::path& path);

}  // namespace oracle

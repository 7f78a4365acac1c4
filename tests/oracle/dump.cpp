// SPDX-License-Identifier: MIT
#include "dump.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <regex>
#include <utility>

namespace oracle {
namespace {

static_assert(sizeof(Ray) == 32 && sizeof(Hit) == 16 && sizeof(Triangle) == 36);

BadDump bad(const std::filesystem::path& path, const std::string& reason) {
  return BadDump(path.string() + ": " + reason);
}

std::string value_of(const std::string& header, const std::string& pattern, const std::filesystem::path& path) {
  std::smatch found;
  if (!std::regex_search(header, found, std::regex(pattern))) throw bad(path, "header is not understood: " + header);
  return found[1];
}

}  // namespace

NpyArray::NpyArray(const std::filesystem::path& path, const std::string& descr, std::size_t row_bytes) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) throw bad(path, "cannot be opened");
  struct stat info {};
  ::fstat(file, &info);
  size_ = static_cast<std::size_t>(info.st_size);
  if (size_ > 10) memory_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file, 0);
  ::close(file);
  if (memory_ == nullptr || memory_ == MAP_FAILED) throw bad(path, "too short, or cannot be mapped");
  const char* bytes = static_cast<const char*>(memory_);
  if (std::memcmp(bytes, "\x93NUMPY\x01", 7) != 0) throw bad(path, "not a .npy file of version 1");
  const std::size_t header_size =
      static_cast<unsigned char>(bytes[8]) + std::size_t{256} * static_cast<unsigned char>(bytes[9]);
  data_at_ = 10 + header_size;
  if (data_at_ > size_) throw bad(path, "cut short");
  const std::string header(bytes + 10, header_size);
  if (header.find(descr) == std::string::npos) throw bad(path, "dtype is not " + descr + ": " + header);
  value_of(header, "'fortran_order': (False)", path);
  rows_ = std::stoull(value_of(header, R"('shape': \((\d+),)", path));
  if (size_ - data_at_ != rows_ * row_bytes) throw bad(path, "size does not fit the shape: " + header);
}

NpyArray::~NpyArray() {
  if (memory_ != nullptr) ::munmap(memory_, size_);
}

NpyArray::NpyArray(NpyArray&& other) noexcept
    : memory_(std::exchange(other.memory_, nullptr)),
      size_(other.size_),
      data_at_(other.data_at_),
      rows_(other.rows_) {}

std::vector<Frame> frames_in(const std::filesystem::path& folder) {
  std::vector<Frame> frames;
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  const std::regex triangles(R"((f-?\d+)_triangles\.npy)"), rays(R"((f-?\d+)_g(\d+)_([a-z]+)_rays\.npy)");
  std::smatch found;
  for (const auto& name : names)
    if (std::regex_match(name, found, triangles)) frames.push_back({found[1], folder / name, {}});
  for (const auto& name : names) {
    if (!std::regex_match(name, found, rays)) continue;
    const auto frame = std::find_if(frames.begin(), frames.end(), [&](const Frame& f) { return f.name == found[1]; });
    if (frame == frames.end()) throw bad(folder / name, "its frame has no triangles");
    const std::string stem = name.substr(0, name.size() - 8);
    frame->batches.push_back(
        {static_cast<std::uint32_t>(std::stoul(found[2])), found[3], folder / name, folder / (stem + "hits.npy")});
  }
  if (frames.empty()) throw bad(folder, "no frame has been dumped here");
  return frames;
}

NpyArray open_triangles(const std::filesystem::path& path) { return {path, "'<f4'", sizeof(Triangle)}; }
NpyArray open_rays(const std::filesystem::path& path) { return {path, "'<f4'", sizeof(Ray)}; }
NpyArray open_hits(const std::filesystem::path& path) {
  return {path, "[('t', '<f4'), ('triangle', '<i4'), ('u', '<f4'), ('v', '<f4')]", sizeof(Hit)};
}

}  // namespace oracle

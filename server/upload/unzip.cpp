// SPDX-License-Identifier: MIT
#include "upload/unzip.hpp"

#include <minizip/unzip.h>
#include <sys/stat.h>

#include <array>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/quote.hpp"
#include "upload/archive_names.hpp"
#include "upload/new_file.hpp"
#include "upload/safe_path.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

constexpr std::uint64_t ratio_free_bytes = std::uint64_t{1} << 20;  // small files may well be this compressible
constexpr std::size_t max_name = 1024;

[[noreturn]] void refuse(const std::string& why) { throw Problem(ProblemKind::bad_scene, "zip: " + why); }

[[noreturn]] void too_large(const std::string& what, const char* name, std::uint64_t value, std::uint64_t limit) {
  throw Problem(ProblemKind::too_large,
                "zip: " + what + " is at least " + std::to_string(value) + ", the limit is " + std::to_string(limit))
      .exceeded(name, limit, value);
}

class Unzipper {
 public:
  Unzipper(const std::filesystem::path& archive, std::filesystem::path folder, const Limits& limits)
      : zip_(::unzOpen64(archive.c_str()), &::unzClose),
        folder_(std::move(folder)),
        limits_(limits),
        packed_(std::filesystem::file_size(archive)) {
    if (!zip_) refuse("this is not a zip archive");
  }

  std::filesystem::path run() {
    unz_global_info64 info{};
    if (::unzGetGlobalInfo64(zip_.get(), &info) != UNZ_OK) refuse("the directory cannot be read");
    if (info.number_entry > limits_.zip_entries)
      too_large("the number of entries", "max-zip-entries", info.number_entry, limits_.zip_entries);
    for (std::uint64_t i = 0; i < info.number_entry; ++i) {
      const int moved = i == 0 ? ::unzGoToFirstFile(zip_.get()) : ::unzGoToNextFile(zip_.get());
      if (moved != UNZ_OK) refuse("the directory is damaged");
      unpack_entry();
    }
    return find_scene(std::move(scenes_));
  }

 private:
  void unpack_entry() {
    unz_file_info64 info{};
    std::array<char, max_name + 1> text{};
    if (::unzGetCurrentFileInfo64(zip_.get(), &info, text.data(), text.size(), nullptr, 0, nullptr, 0) != UNZ_OK)
      refuse("the directory is damaged");
    if (info.size_filename > max_name || std::strlen(text.data()) != info.size_filename)
      refuse("an entry's name is longer than 1024 bytes or holds a zero");
    const std::string name = text.data();
    if (is_file_manager_metadata(name) || is_folder(name, info)) return;  // folders are made for the files in them
    const auto refuse_entry = [&](const char* why) { refuse("entry '" + quote(name) + "' " + why); };
    const auto mode = static_cast<mode_t>(info.external_fa >> 16);
    if (S_ISLNK(mode)) refuse_entry("is a link");
    if (info.flag & 1) refuse_entry("is encrypted");
    if (info.compression_method != 0 && info.compression_method != Z_DEFLATED)
      refuse_entry("is neither stored nor deflated");
    unpack_file(name);
  }

  static bool is_folder(const std::string& name, const unz_file_info64& info) {
    constexpr unsigned long dos_folder = 0x10;
    if (name.ends_with('/') || name.ends_with('\\')) return true;
    return info.uncompressed_size == 0 && (info.external_fa & dos_folder) != 0;
  }

  void unpack_file(const std::string& name) {
    const std::filesystem::path path = safe_relative_path(name);
    const std::string shown = "entry '" + quote(name) + "' ";
    NewFile file(folder_, path);
    if (::unzOpenCurrentFile(zip_.get()) != UNZ_OK) refuse(shown + "cannot be read");
    while (true) {
      const int n = ::unzReadCurrentFile(zip_.get(), block_.data(), static_cast<unsigned>(block_.size()));
      if (n < 0) refuse(shown + "is damaged");
      if (n == 0) break;
      count(static_cast<std::uint64_t>(n));
      file.write({block_.data(), static_cast<std::size_t>(n)});
    }
    if (::unzCloseCurrentFile(zip_.get()) != UNZ_OK) refuse(shown + "fails its checksum");
    file.close();
    if (is_scene_name(path)) scenes_.push_back(path);
  }

  void count(std::uint64_t bytes) {
    unpacked_ += bytes;
    if (unpacked_ > limits_.unpacked_bytes)
      too_large("the unpacked size in bytes", "max-unpacked", unpacked_, limits_.unpacked_bytes);
    if (unpacked_ > ratio_free_bytes && unpacked_ / std::max<std::uint64_t>(packed_, 1) >= limits_.zip_ratio)
      too_large("the ratio of unpacked to packed size", "max-zip-ratio",
                unpacked_ / std::max<std::uint64_t>(packed_, 1), limits_.zip_ratio);
  }

  std::unique_ptr<void, decltype(&::unzClose)> zip_;
  std::filesystem::path folder_;
  const Limits& limits_;
  std::uint64_t packed_, unpacked_ = 0;
  std::vector<std::filesystem::path> scenes_;
  std::array<char, 1 << 16> block_{};
};

}  // namespace

std::filesystem::path unzip_scene(const std::filesystem::path& archive, const std::filesystem::path& folder,
                                  const Limits& limits) {
  return std::make_unique<Unzipper>(archive, folder, limits)->run();
}

}  // namespace sheaf::server

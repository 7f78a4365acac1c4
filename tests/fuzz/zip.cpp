// SPDX-License-Identifier: MIT
// A zipped scene. Whatever it says of itself, what comes out lies in its folder and keeps the limits.
#include "core/error.hpp"
#include "target.hpp"
#include "upload/unzip.hpp"
#include "util/problem.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sheaf;
  using namespace sheaf::server;
  static const fuzz::Scratch scratch;
  Limits limits;
  limits.unpacked_bytes = 4 << 20;
  limits.zip_entries = 64;
  const auto folder = scratch.path() / "out" / "scene";
  std::filesystem::create_directories(folder);
  try {
    const std::string scene = unzip_scene(scratch.file("upload.zip", fuzz::as_text(data, size)), folder, limits);
    fuzz::require(std::filesystem::is_regular_file(folder / scene), "the scene is there");
  } catch (const Problem&) {
    // Refused, with a reason.
  } catch (const Error&) {
    // A name that the file system does not take.
  }
  std::uint64_t files = 0, bytes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(scratch.path() / "out")) {
    fuzz::require(!entry.is_symlink(), "no links");
    if (entry.is_regular_file()) ++files, bytes += entry.file_size();
  }
  fuzz::require(files <= limits.zip_entries && bytes <= limits.unpacked_bytes, "the limits hold");
  std::filesystem::remove_all(scratch.path() / "out");
  for (const auto& entry : std::filesystem::directory_iterator(scratch.path()))
    fuzz::require(entry.path().filename() == "upload.zip", "nothing is written beside the folder");
  return 0;
}

// SPDX-License-Identifier: MIT
// Files that appear under their name only when they are whole: written as `.NAME.PID.part` in the same folder, synced,
// then renamed. Whatever stops the writer, a reader sees the old file or the new one, never a part. A symbolic link
// stays, and what it leads to is replaced; a FIFO, a device or an open descriptor is written once the file is whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "output/write_target.hpp"

namespace sheaf {

/// One file being written. Destroyed without commit(), it leaves nothing behind. Every failure is Error{io} with the
/// final path and the system's reason; it is remembered, so commit() fails even where a library swallowed the throw.
class AtomicFile {
 public:
  explicit AtomicFile(std::string path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::span<const std::byte> bytes);  // at the current place; buffered
  void seek(std::uint64_t position);             // from the start of the file
  [[nodiscard]] std::uint64_t tell() const { return position_ + buffer_.size(); }

  /// Where the file grows; empty where it goes to a stream, whose bytes are kept in memory.
  [[nodiscard]] const std::string& temporary_path() const { return temporary_path_; }

  /// Flush, fsync, rename; or write to the stream. The name's directory entry is not synced: after a power cut the old
  /// file may still be there.
  void commit();

 private:
  void create_part();
  void flush();
  void keep();
  void check_writable() const;
  [[noreturn]] void fail(const std::string& doing, int error_number);

  std::string path_, temporary_path_, failure_;
  WriteTarget target_;
  bool done_ = false;
  int descriptor_ = -1;         // holds an flock for as long as the file is being written
  std::uint64_t position_ = 0;  // of the descriptor: where buffer_ goes
  std::vector<std::byte> buffer_;
  std::vector<std::byte> kept_;  // all of a stream's file
};

void write_file_atomically(const std::string& path, std::span<const std::byte> bytes);
void write_file_atomically(const std::string& path, const std::string& text);

/// Removes the `.NAME.PID.part` files in `directory` whose writers are gone, and says how many. A writer holds a lock
/// on its part, so this is safe beside other processes, in other containers too; where the file system has no locks,
/// the process id in the name decides. Throws only if the directory itself cannot be read.
std::size_t remove_stale_parts(const std::string& directory);

}  // namespace sheaf

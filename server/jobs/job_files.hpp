// SPDX-License-Identifier: MIT
// A job's folder: DATA/jobs/ID/{scene/…, camera.json, settings.json, frames/…, stats.json, log.txt}. Uploads are
// received in DATA/incoming/ID and become a job's folder by one rename.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "jobs/job.hpp"
#include "util/fd.hpp"

namespace sheaf::server {

class JobFiles {
 public:
  /// Makes the folders, locks `data` against a second service, clears half-received uploads. Throws Error{io}.
  explicit JobFiles(std::filesystem::path data);

  [[nodiscard]] std::filesystem::path folder(const std::string& id) const { return data_ / "jobs" / id; }
  [[nodiscard]] std::filesystem::path scene(const std::string& id) const { return folder(id) / "scene"; }
  [[nodiscard]] std::filesystem::path camera(const std::string& id) const { return folder(id) / "camera.json"; }
  [[nodiscard]] std::filesystem::path frames(const std::string& id) const { return folder(id) / "frames"; }
  [[nodiscard]] std::filesystem::path stats(const std::string& id) const { return folder(id) / "stats.json"; }
  [[nodiscard]] std::filesystem::path log(const std::string& id) const { return folder(id) / "log.txt"; }

  [[nodiscard]] std::filesystem::path incoming(const std::string& id) const { return data_ / "incoming" / id; }

  /// A new empty folder for an upload, with a scene folder in it.
  [[nodiscard]] std::filesystem::path receive(const std::string& id) const;

  /// Makes a received upload a job's folder. Everything is on the disk when this returns.
  void accept(const std::string& id) const;

  /// Removes job folders without a job (`known` is false): submission or removal was interrupted by the service's end.
  void remove_orphan_folders(const std::function<bool(const std::string& id)>& known) const;

  /// Removes the job's folder and upload; what cannot be removed is logged.
  void remove(const std::string& id) const noexcept;

  [[nodiscard]] std::uint64_t free_bytes() const;

  /// Why a file of a few KiB cannot be written here now; nothing if it can.
  [[nodiscard]] std::optional<std::string> write_error() const;

  [[nodiscard]] const std::filesystem::path& data() const { return data_; }

 private:
  std::filesystem::path data_;
  Fd lock_;
};

/// Size and checksums of a regular file; nothing if there is none. Reads it once.
[[nodiscard]] std::optional<StoredFile> stored_file(const std::filesystem::path& path);

/// The whole file; throws Error{io}, and Error{limit} past `limit` bytes.
[[nodiscard]] std::string read_text(const std::filesystem::path& path, std::uint64_t limit);

}  // namespace sheaf::server

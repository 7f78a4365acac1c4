// SPDX-License-Identifier: MIT
#include "upload/submission.hpp"

#include <array>
#include <functional>
#include <optional>
#include <set>
#include <vector>

#include "core/file_kind.hpp"
#include "core/quote.hpp"
#include "core/sha256.hpp"
#include "jobs/settings.hpp"
#include "upload/content_digest.hpp"
#include "upload/multipart.hpp"
#include "upload/new_file.hpp"
#include "upload/safe_path.hpp"
#include "upload/unzip.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

[[noreturn]] void bad_scene(const std::string& why) { throw Problem(ProblemKind::bad_scene, why); }

/// A scene's file name, from what the client calls it or, failing that, from its media type.
std::string scene_name(const PartHeader& part) {
  std::string name = base_name(part.filename.value_or(""));
  if (extension_of(name).empty()) {
    const std::string stem = name.empty() ? "scene" : name;
    if (part.content_type == "model/gltf-binary") name = stem + ".glb";
    if (part.content_type == "model/gltf+json") name = stem + ".gltf";
    if (part.content_type == "application/zip") name = stem + ".zip";
  }
  const std::string extension = extension_of(name);
  if (extension != ".glb" && extension != ".gltf" && extension != ".zip")
    throw Problem(ProblemKind::unsupported_media_type,
                  "scene: '" + quote(name.empty() ? part.content_type : name) + "' is not .glb, .gltf or .zip");
  return safe_relative_path(name).string();
}

/// The folder in the client's name for the scene, where it has one that can be made here.
std::filesystem::path scene_folder(const PartHeader& part) {
  try {
    return safe_relative_path(part.filename.value_or("")).parent_path();
  } catch (const Problem&) {
    return {};  // a path of the client's machine: only its last part is used
  }
}

class Receiver {
 public:
  Receiver(std::filesystem::path folder, const Limits& limits) : folder_(std::move(folder)), limits_(limits) {}

  void begin(const PartHeader& part) {
    part_ = part;
    part_hash_ = Sha256();
    text_.clear();
    if (part.name == "scene") {
      if (!scene_name_.empty()) refuse_duplicate();
      scene_name_ = scene_name(part);
      scene_folder_ = scene_folder(part);
      const bool zip = extension_of(scene_name_) == ".zip";
      file_.emplace(zip ? folder_ : folder_ / "scene", zip ? "upload.zip" : scene_name_);
    } else if (part.name == "file") {
      if (!part.filename) throw Problem(ProblemKind::malformed_multipart, "part 'file' has no file name");
      const std::filesystem::path path = safe_relative_path(*part.filename);
      file_.emplace(folder_ / "scene", path);
      top_folders_.insert(path.has_parent_path() ? *path.begin() : std::filesystem::path());
    } else if (part.name == "camera") {
      if (camera_) refuse_duplicate();
      text_limit_ = limits_.camera_bytes;
    } else if (part.name == "settings") {
      if (settings_) refuse_duplicate();
      text_limit_ = limits_.settings_bytes;
    } else {
      throw Problem(ProblemKind::malformed_multipart,
                    "part '" + quote(part.name) + "' is not one of scene, file, camera, settings");
    }
  }

  void data(std::string_view bytes) {
    part_hash_.update(bytes);
    if (part_.name == "scene") {
      scene_size_ += bytes.size();
      if (head_.size() < file_kind_bytes) head_.append(bytes.substr(0, file_kind_bytes - head_.size()));
    }
    if (file_) return file_->write(bytes);
    if (text_.size() + bytes.size() > text_limit_)
      throw Problem(ProblemKind::too_large, part_.name + ": has more than " + std::to_string(text_limit_) + " bytes")
          .exceeded(part_.name == "camera" ? "camera" : "settings", text_limit_, text_.size() + bytes.size());
    text_.append(bytes);
  }

  void end() {
    fingerprint_.update(part_.name + '\0' + part_.filename.value_or("") + '\0' + part_hash_.finish() + '\n');
    if (file_) {
      file_->close();
      total_bytes_ += file_->bytes();
      file_.reset();
    } else if (part_.name == "camera") {
      camera_ = std::move(text_);
    } else {
      settings_ = std::move(text_);
    }
  }

  Submission finish(const std::string& id) {
    Submission submission;
    Job& job = submission.job;
    job.id = id;
    job.created = std::chrono::system_clock::now();
    job.scene_bytes = total_bytes_;
    job.has_camera = camera_.has_value();
    const Settings settings = parse_settings(json_of("settings", settings_.value_or("{}")), job.has_camera, limits_);
    job.settings = settings.resolved;
    job.arguments = settings.arguments;
    if (settings.frames) {
      job.frames_known = true;
      job.total = settings.frames->size();
      for (const std::int64_t number : *settings.frames) job.frames.push_back({number, {}, {}, 0});
    }
    save_camera();
    job.scene_file = unpack_scene();
    submission.fingerprint = fingerprint_.finish();
    return submission;
  }

 private:
  [[noreturn]] void refuse_duplicate() const {
    throw Problem(ProblemKind::malformed_multipart, "part '" + part_.name + "' is given twice");
  }

  static nlohmann::json json_of(const std::string& what, const std::string& text) {
    try {
      return nlohmann::json::parse(text);
    } catch (const nlohmann::json::exception& error) {
      throw Problem(ProblemKind::malformed_json, what + ": " + quote(error.what()));
    }
  }

  void save_camera() const {
    if (!camera_) return;
    if (!json_of("camera", *camera_).is_object())
      throw Problem(ProblemKind::bad_settings, "camera: must be a JSON object");
    NewFile file(folder_, "camera.json");
    file.write(*camera_);
    file.close();
  }

  /// The scene's path within the scene folder. Only the first bytes are checked; the worker reads the rest.
  std::string unpack_scene() {
    if (scene_name_.empty()) bad_scene("there is no scene part");
    const std::string extension = extension_of(scene_name_);
    if (extension != ".zip") {
      check_kind(extension);
      return place_beside_files();
    }
    if (!top_folders_.empty()) bad_scene("file: parts besides a .zip scene are not accepted");
    const auto archive = folder_ / "upload.zip";
    const std::string name = unzip_scene(archive, folder_ / "scene", limits_).string();
    std::filesystem::remove(archive);
    return name;
  }

  /// If a whole folder is sent, the scene's and the files' names begin with that folder ("model/a.gltf",
  /// "model/a.bin"): then the scene is moved into it. Other files' names are relative to the scene.
  std::string place_beside_files() const {
    if (top_folders_.size() != 1 || scene_folder_.empty() || *top_folders_.begin() != *scene_folder_.begin())
      return scene_name_;
    const std::filesystem::path scenes = folder_ / "scene", name = scene_folder_ / scene_name_;
    std::error_code error;
    std::filesystem::create_directories(scenes / scene_folder_, error);
    if (error || std::filesystem::exists(scenes / name))
      bad_scene("file name '" + quote(name.string()) + "': is given twice");
    std::filesystem::rename(scenes / scene_name_, scenes / name);
    return name.string();
  }

  void check_kind(const std::string& extension) const {
    const std::string name = "scene: '" + quote(scene_name_) + "' ";
    if (head_.empty()) bad_scene(name + "is empty");
    if (head_.starts_with("glTF")) return;
    if (const std::string kind = file_kind(head_, scene_size_); !kind.empty())
      bad_scene(name + "is not a glTF file but " + kind);
    if (extension == ".glb") bad_scene(name + "is not a binary glTF file");
  }

  std::filesystem::path folder_;
  const Limits& limits_;
  PartHeader part_;
  Sha256 part_hash_, fingerprint_;
  std::optional<NewFile> file_;
  std::string scene_name_, head_, text_;  // `head_`: the scene part's first bytes
  std::filesystem::path scene_folder_;
  std::set<std::filesystem::path> top_folders_;  // first folders of the files' names; empty: no folder
  std::uint64_t text_limit_ = 0, total_bytes_ = 0, scene_size_ = 0;
  std::optional<std::string> camera_, settings_;
};

void read_all(Request& request, const std::function<void(std::string_view)>& take) {
  std::vector<char> block(std::size_t{1} << 16);
  for (std::size_t n = 0; (n = request.read_body(block.data(), block.size())) > 0;) take({block.data(), n});
}

/// Of a body that arrived damaged nothing else is said: what is malformed waits until all of it has been read.
void read_checked(Request& request, const std::string& told, MultipartParser& parser) {
  Sha256 hash;
  std::optional<Problem> malformed;
  read_all(request, [&](std::string_view bytes) {
    hash.update(bytes);
    if (malformed) return;
    try {
      parser.feed(bytes);
    } catch (const Problem& problem) {
      if (problem.kind() != ProblemKind::malformed_multipart) throw;
      malformed = problem;
    }
  });
  const std::string found = hash.finish();
  if (found != told)
    throw Problem(ProblemKind::digest_mismatch,
                  "the body's SHA-256 is " + found + ", Content-Digest says " + told + ": it is not what was sent");
  if (malformed) throw Problem(*malformed);
}

}  // namespace

Submission receive_submission(const std::string& id, Request& request, const JobFiles& files, const Limits& limits) {
  const auto boundary = multipart_boundary(request.header("Content-Type").value_or(""));
  if (!boundary) throw Problem(ProblemKind::unsupported_media_type, "the body must be multipart/form-data");
  try {
    Receiver receiver(files.receive(id), limits);
    MultipartParser parser(*boundary, limits.parts,
                           {[&](const PartHeader& part) { receiver.begin(part); },
                            [&](std::string_view bytes) { receiver.data(bytes); }, [&] { receiver.end(); }});
    const std::optional<std::string> told = declared_sha256(request);
    if (told)
      read_checked(request, *told, parser);
    else
      read_all(request, [&](std::string_view bytes) { parser.feed(bytes); });
    parser.finish();
    return receiver.finish(id);
  } catch (...) {
    files.remove(id);
    throw;
  }
}

}  // namespace sheaf::server

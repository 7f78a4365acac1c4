// SPDX-License-Identifier: MIT
#include "jobs/frame_collection.hpp"

#include <algorithm>
#include <charconv>

#include "jobs/job_change.hpp"
#include "output/frame_names.hpp"
#include "util/log.hpp"

namespace sheaf::server {
namespace {

namespace fs = std::filesystem;

FrameNames names_of(const JobSummary& job) {
  const auto name = job.settings.find("name");
  return FrameNames(name != job.settings.end() ? name->get<std::string>() : default_name_pattern(job.scene_file));
}

bool has_previews(const JobSummary& job) {
  const auto preview = job.settings.find("preview");
  return preview != job.settings.end() && preview->get<bool>();
}

StoredFilePtr whole_file(const fs::path& path) {
  std::optional<StoredFile> file = stored_file(path);
  return file ? std::make_shared<const StoredFile>(*std::move(file)) : nullptr;
}

/// The number in `name` if it is one of the frames' names.
std::optional<std::int64_t> number_in(const FrameNames& names, const std::string& name) {
  const std::string& pattern = names.pattern();
  const auto first = pattern.find('#'), last = pattern.rfind('#');
  const std::size_t after = pattern.size() - last - 1;
  if (name.size() <= first + after) return std::nullopt;
  std::int64_t number = 0;
  const char* const end = name.data() + name.size() - after;
  const auto [rest, error] = std::from_chars(name.data() + first, end, number);
  if (error != std::errc{} || rest != end || names.frame(number) != name) return std::nullopt;
  return number;
}

/// Frames that may have files: the known ones, or whatever the folder has.
std::vector<std::int64_t> unrecorded(const Job& job, const FrameNames& names, const fs::path& folder) {
  std::vector<std::int64_t> numbers;
  if (job.frames_known) {
    for (const Frame& frame : job.frames)
      if (!frame.exr) numbers.push_back(frame.number);
    return numbers;
  }
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const auto number = number_in(names, at->path().filename().string());
    const Frame* const frame = number ? find_frame(job.frames, *number) : nullptr;
    if (number && !(frame && frame->exr)) numbers.push_back(*number);
  }
  return numbers;
}

bool same(const StoredFilePtr& recorded, const fs::path& folder) {
  const StoredFilePtr now = whole_file(folder / recorded->name);
  return now && now->sha256 == recorded->sha256;
}

}  // namespace

std::uint64_t adopt_frames(JobStore& store, const JobFiles& files, const std::string& id) {
  const std::optional<Job> job = store.find(id);
  if (!job) return 0;
  const fs::path folder = files.frames(id);
  const FrameNames names = names_of(*job);
  std::vector<Frame> found;
  for (const std::int64_t number : unrecorded(*job, names, folder)) {
    Frame frame{number, whole_file(folder / names.frame(number)), nullptr, 0};
    if (!frame.exr) continue;
    frame.png = whole_file(folder / names.preview(number));
    if (frame.png || !has_previews(*job)) {
      found.push_back(std::move(frame));
      continue;
    }
    // A worker that resumes would take the frame as done, and never write its preview.
    std::error_code ignored;
    fs::remove(folder / frame.exr->name, ignored);
  }
  if (found.empty()) return 0;
  store.update(id, [&](Job& stored, NewEvents& events) {
    for (const Frame& frame : found) put_frame(stored, frame, events);
    stored.fruitless_starts = 0;
  });
  write_log(LogLevel::info, "frames adopted", {{"job", id}, {"frames", found.size()}});
  return found.size();
}

void verify_frames(JobStore& store, const JobFiles& files, const std::string& id) {
  const std::optional<Job> job = store.find(id);
  if (!job) return;
  const fs::path folder = files.frames(id);
  std::vector<std::int64_t> lost;
  for (const Frame& frame : job->frames)
    if (frame.exr && (!same(frame.exr, folder) || (frame.png && !same(frame.png, folder)))) {
      std::error_code ignored;
      fs::remove(folder / frame.exr->name, ignored);
      lost.push_back(frame.number);
    }
  if (!lost.empty()) {
    store.update(id, [&](Job& stored, NewEvents&) {
      for (const std::int64_t number : lost) drop_frame(stored, number);
    });
    write_log(LogLevel::warning, "frames were damaged and are rendered again", {{"job", id}, {"frames", lost}});
  }
  adopt_frames(store, files, id);
}

}  // namespace sheaf::server

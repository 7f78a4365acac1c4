// SPDX-License-Identifier: MIT
// Worker processes, with /bin/sh in the worker's place: what they print, how they end, how they are made to.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <future>
#include <thread>

#include "core/error.hpp"
#include "jobs/job_service.hpp"
#include "jobs/worker_log.hpp"
#include "jobs/worker_process.hpp"
#include "store/sqlite_job_store.hpp"

namespace sheaf::server {
namespace {

struct Finished {
  WorkerEnding ending;
  std::vector<std::string> lines;
  std::string log;
};

Finished run_script(const std::string& script, const StopSwitch& stop,
                    const std::function<void(std::string_view)>& on_line = {},
                    std::chrono::milliseconds grace = std::chrono::hours(1)) {
  Finished run;
  const WorkerOutput output{[&](std::string_view line) {
                              run.lines.emplace_back(line);
                              if (on_line) on_line(line);
                            },
                            [&](std::string_view bytes) { run.log += bytes; }};
  run.ending = run_worker({"/bin/sh", "-c", script}, output, stop, {grace});
  return run;
}

class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "sheaf-test-XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

TEST(WorkerProcess, GivesLinesLogAndExitCode) {
  const Finished run = run_script("echo one; printf 'tw'; printf 'o\\n\\nlast'; echo oops >&2; exit 3", StopSwitch());
  EXPECT_EQ(run.lines, (std::vector<std::string>{"one", "two", "", "last"}));
  EXPECT_EQ(run.log, "oops\n");
  EXPECT_EQ(run.ending.exit_code, 3);
  EXPECT_FALSE(run.ending.signal);
}

TEST(WorkerProcess, GivesTheSignalItDiedBy) {
  const Finished run = run_script("kill -SEGV $$", StopSwitch());
  EXPECT_EQ(run.ending.signal, SIGSEGV);
  EXPECT_EQ(signal_name(SIGSEGV), "SIGSEGV");
}

TEST(WorkerProcess, CutsEndlessLinesIntoPieces) {
  const Finished run = run_script("head -c 300000 /dev/zero | tr '\\0' x", StopSwitch());
  std::size_t total = 0;
  for (const std::string& line : run.lines) {
    EXPECT_LT(line.size(), 200'000u);
    total += line.size();
  }
  EXPECT_EQ(total, 300'000u);
}

TEST(WorkerProcess, StartsCleanOfTheServicesSignalsAndInput) {
  ::signal(SIGPIPE, SIG_IGN);
  const Finished run = run_script("grep -E 'SigIgn|SigBlk' /proc/self/status; cat; echo end", StopSwitch());
  ASSERT_EQ(run.lines.size(), 3u);
  EXPECT_EQ(run.lines[2], "end");  // standard input is empty
  for (const std::size_t i : {0, 1}) {
    const auto signals = std::stoull(run.lines[i].substr(run.lines[i].find('\t')), nullptr, 16);
    EXPECT_EQ(signals & 0x7fffffff, 0u) << run.lines[i];  // 32 and 33 are the C library's own
  }
}

TEST(WorkerProcess, StopsWhenAsked) {
  StopSwitch stop;
  const Finished run = run_script("trap 'echo leaving; exit 143' TERM; echo up; while :; do read x < /dev/null; done",
                                  stop, [&](std::string_view line) {
                                    if (line == "up") stop.ask();
                                  });
  EXPECT_EQ(run.lines.back(), "leaving");
  EXPECT_EQ(run.ending.exit_code, 143);
}

TEST(WorkerProcess, IsKilledAfterTheGraceOrWhenForced) {
  const std::string stubborn = "trap '' TERM; echo up; while :; do :; done";
  StopSwitch stop;
  const Finished late = run_script(
      stubborn, stop, [&](std::string_view) { stop.ask(); }, std::chrono::milliseconds(20));
  EXPECT_EQ(late.ending.signal, SIGKILL);
  StopSwitch cancel;
  const Finished cancelled = run_script(stubborn, cancel, [&](std::string_view) { cancel.cancel(); });
  EXPECT_EQ(cancelled.ending.signal, SIGKILL);
  StopSwitch force;
  const Finished forced = run_script(stubborn, force, [&](std::string_view) {
    force.ask();
    force.force();
  });
  EXPECT_EQ(forced.ending.signal, SIGKILL);
  StopSwitch before;
  before.force();
  EXPECT_EQ(run_script(stubborn, before).ending.signal, SIGKILL);
}

TEST(WorkerProcess, LeavesNoChildrenThatHoldItsPipes) {
  const auto began = std::chrono::steady_clock::now();
  const Finished run = run_script("sh -c 'trap \"\" TERM; while :; do :; done' & echo $!; exit 0", StopSwitch());
  EXPECT_EQ(run.ending.exit_code, 0);
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(30));
  const pid_t child = std::stoi(run.lines.at(0));
  // Killed with its group: soon gone, or waiting to be reaped by whoever inherits it.
  for (std::string text = "?"; !text.empty() && text.find(") Z") == std::string::npos;) {
    std::ifstream stat("/proc/" + std::to_string(child) + "/stat");
    text.clear();
    std::getline(stat, text);
  }
}

TEST(WorkerProcess, SaysWhyItCannotStart) {
  const WorkerOutput output{[](std::string_view) {}, [](std::string_view) {}};
  try {
    (void)run_worker({"/nonexistent/sheaf"}, output, StopSwitch(), {std::chrono::seconds(1)});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::io);
    EXPECT_NE(std::string(error.what()).find("/nonexistent/sheaf"), std::string::npos);
  }
}

TEST(WorkerLog, IsBoundedAndHidesPaths) {
  const Folder folder;
  WorkerLog log(folder.path() / "log.txt", 100, "/data/jobs/x");
  log.append("reading /data/jobs/x/scene/a");
  log.append(".gltf\n/data/jobs/x: gone\n");
  for (int i = 0; i < 100; ++i) log.line("0123456789");
  log.append("unended");
  log.end();
  const std::string text = read_text(folder.path() / "log.txt", 1000);
  EXPECT_TRUE(text.starts_with("reading scene/a.gltf\n: gone\n0123456789\n")) << text;
  EXPECT_LT(text.size(), 150u);
  EXPECT_EQ(log.last_line(), "unended");
}

/// A service whose worker is a script that writes the frame it was asked for.
class JobServiceTest : public testing::Test {
 protected:
  JobServiceTest() {
    const auto script = folder_.path() / "worker";
    std::ofstream(script) << "#!/bin/sh\n"
                             "for a in \"$@\"; do last=$now; now=$a; [ \"$last\" = --out ] && out=$a; done\n"
                             "echo x > $out/f.exr; echo '{\"event\":\"start\",\"frames\":1}'\n"
                             "echo '{\"event\":\"frame\",\"frame\":0,\"file\":\"f.exr\"}'\n";
    ::chmod(script.c_str(), 0755);
    options_.runner.sheaf = script.string();
    options_.jobs_at_once = 3;
    options_.min_free_bytes = 0;
  }

  std::string submit(JobService& service, const std::string& id) {
    (void)files_.receive(id);
    Job job;
    job.id = id;
    job.scene_file = "s.gltf";
    job.created = std::chrono::system_clock::now();
    return service.submit(std::move(job), {}, "").id;
  }

  static Job wait(JobService& service, const std::string& id) {
    const auto events = service.events(id);
    for (std::uint64_t after = 0;;) {
      const auto batch = events->wait(after, 100, std::chrono::steady_clock::now() + std::chrono::minutes(1));
      if (batch.ended || batch.events.empty()) return service.get(id);
      after = batch.events.back().id;
    }
  }

  Folder folder_;
  JobFiles files_{folder_.path() / "data"};
  SqliteJobStore store_{(folder_.path() / "data" / "jobs.db").string()};
  ServiceOptions options_;
};

TEST_F(JobServiceTest, RunsWhatManyThreadsSubmitCancelAndRemove) {
  JobService service(options_, store_, files_);
  std::vector<std::thread> clients;
  std::atomic<std::size_t> kept{0};
  for (int c = 0; c < 4; ++c)
    clients.emplace_back([&, c] {
      for (int i = 0; i < 12; ++i) {
        const std::string id = submit(service, "job-" + std::to_string(c) + "-" + std::to_string(i));
        if (i % 3 == 1 && !service.cancel_or_remove(id)) continue;  // it had ended: that removed it
        const Job job = wait(service, id);
        EXPECT_TRUE(is_finished(job.state));
        if (job.state == JobState::done) {
          EXPECT_EQ(job.frames_done, 1u);
        }
        EXPECT_NE(job.state, JobState::failed) << (job.error ? job.error->message : "");
        if (i % 3 == 2) {
          EXPECT_FALSE(service.cancel_or_remove(id));
          continue;
        }
        ++kept;
      }
    });
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(store_.list({}).jobs.size(), kept);
  service.shut_down();
  std::size_t folders = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder_.path() / "data" / "jobs"))
    ++folders;
  EXPECT_EQ(folders, kept);
}

TEST_F(JobServiceTest, ShutsDownWithJobsInEveryState) {
  std::ofstream(options_.runner.sheaf) << "#!/bin/sh\nexec cat /dev/zero > /dev/null\n";
  JobService service(options_, store_, files_);
  for (int i = 0; i < 6; ++i) submit(service, "job" + std::to_string(i));
  for (const char* id : {"job0", "job1", "job2"})  // queued, then running
    (void)store_.events(id)->wait(1, 1, std::chrono::steady_clock::now() + std::chrono::minutes(1));
  service.shut_down();
  const auto counts = store_.count();
  EXPECT_EQ(counts.at(JobState::running), 0u);
  EXPECT_EQ(counts.at(JobState::queued), 6u);  // to be taken up when the service starts again
}

}  // namespace
}  // namespace sheaf::server

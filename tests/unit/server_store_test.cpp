// SPDX-License-Identifier: MIT
// Jobs in their database: what is kept, for whom, and for how long.
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <string>
#include <thread>

#include "jobs/job_change.hpp"
#include "store/sqlite_job_store.hpp"
#include "util/ids.hpp"
#include "util/log.hpp"

namespace sheaf::server {
namespace {

Job job_named(const std::string& id) {
  Job job;
  job.id = id;
  job.created = std::chrono::system_clock::now();
  return job;
}

/// A database in a folder of its own.
class Store : public ::testing::Test {
 protected:
  Store() : folder_(std::filesystem::temp_directory_path() / ("sheaf-store-" + random_id())) {
    std::filesystem::create_directory(folder_);
  }
  ~Store() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string path() const { return (folder_ / "jobs.db").string(); }

 private:
  std::filesystem::path folder_;
};

void end(Job& job, NewEvents& events, JobState state) {
  finish_job(job, events, state, std::nullopt, std::chrono::seconds(0));
}

TEST_F(Store, PagesNewestFirstWithoutGapsOrRepeats) {
  SqliteJobStore store(path());
  for (int i = 0; i < 10; ++i) store.insert(job_named("j" + std::to_string(i)), {});
  store.update("j4", [](Job& job, NewEvents& events) { end(job, events, JobState::done); });
  JobQuery query;
  query.limit = 3;
  std::string seen;
  for (bool more = true; more;) {
    const JobPage page = store.list(query);
    for (const JobSummary& job : page.jobs) seen += job.id[1];
    query.before = page.next;
    more = page.next.has_value();
    if (seen.size() == 3) store.remove("j6", "gone");  // between two pages
    if (seen.size() == 3) store.insert(job_named("jx"), {});
  }
  EXPECT_EQ(seen, "987543210");
  query = {};
  query.state = JobState::done;
  ASSERT_EQ(store.list(query).jobs.size(), 1u);
  EXPECT_EQ(store.list(query).jobs[0].id, "j4");
  EXPECT_EQ(store.count().at(JobState::queued), 9u);
}

TEST_F(Store, KeysNameOneJobAsLongAsItIsThere) {
  SqliteJobStore store(path());
  EXPECT_EQ(store.insert(job_named("a"), {"k", "1"}).kind, Submitted::Kind::created);
  const Submitted again = store.insert(job_named("b"), {"k", "1"});
  EXPECT_EQ(again.kind, Submitted::Kind::repeated);
  EXPECT_EQ(again.id, "a");
  EXPECT_EQ(store.presence("b"), Presence::unknown);
  EXPECT_EQ(store.insert(job_named("c"), {"k", "2"}).kind, Submitted::Kind::conflict);
  EXPECT_TRUE(store.remove("a", "was eaten"));
  EXPECT_FALSE(store.remove("a", "again"));
  EXPECT_EQ(store.removal_reason("a"), "was eaten");
  EXPECT_EQ(store.presence("a"), Presence::removed);
  EXPECT_EQ(store.insert(job_named("d"), {"k", "2"}).kind, Submitted::Kind::created);
}

TEST_F(Store, OneOfManyEqualKeysWins) {
  SqliteJobStore store(path());
  std::atomic<int> created{0};
  std::vector<std::thread> clients;
  for (int i = 0; i < 8; ++i)
    clients.emplace_back([&store, &created, i] {
      for (int k = 0; k < 200; ++k) {
        const std::string key = std::to_string(k);
        if (store.insert(job_named(key + "-" + std::to_string(i)), {key, "same"}).kind == Submitted::Kind::created)
          ++created;
      }
    });
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(created, 200);
}

TEST_F(Store, ExpiryAndRemovalKeepEventsReadable) {
  SqliteJobStore store(path());
  store.insert(job_named("a"), {});
  const auto now = std::chrono::system_clock::now();
  store.update("a", [&](Job& job, NewEvents& events) {
    end(job, events, JobState::done);
    job.expires = now;
  });
  EXPECT_TRUE(store.expired(now - std::chrono::seconds(1)).empty());
  EXPECT_EQ(store.expired(now), std::vector<std::string>{"a"});
  const auto events = store.events("a");
  store.remove("a", "gone");
  EXPECT_TRUE(events->read(0, 10).ended);
  EXPECT_EQ(store.events("a"), nullptr);
  EXPECT_FALSE(store.update("a", [](Job&, NewEvents&) { FAIL(); }));
}

/// Names may be any bytes; JSON shows those that are not UTF-8 as replaced.
std::string shown(const SqliteJobStore& store) {
  return dump_json(job_to_json(*store.find("a"))) + dump_json(job_to_json(*store.find("b")));
}

TEST_F(Store, EverythingIsThereWhenItIsOpenedAgain) {
  const auto file = [](const std::string& name) {
    return std::make_shared<const StoredFile>(StoredFile{name, 5'000'000'000, 0xffffffff, std::string(64, 'a')});
  };
  Job job = job_named("a");
  job.scene_file = "sc\xe9ne.glb";  // names are bytes
  job.settings = {{"size", "64x36"}, {"spp", 4}};
  job.arguments = {"--size=64x36"};
  job.frames_known = true;
  for (const int number : {-3, 0, 7}) job.frames.push_back({number, {}, {}, 0});
  job.total = 3;
  std::string before;
  {
    SqliteJobStore store(path());
    store.insert(job, {"key", "print"});
    store.insert(job_named("b"), {});
    store.update("a", [&](Job& stored, NewEvents& events) {
      stored.state = JobState::running;
      put_frame(stored, {0, file("\xff.0000.exr"), file("x.png"), 12.5}, events);
      put_frame(stored, {7, file("y.exr"), nullptr, 1}, events);
      stored.warnings = {"w"};
    });
    store.update("a", [](Job& stored, NewEvents&) { drop_frame(stored, 7); });
    store.update("b", [](Job& stored, NewEvents& events) {
      finish_job(stored, events, JobState::failed, Failure{"code", "title", "why", 3, {}}, std::chrono::hours(1));
    });
    before = shown(store);
  }
  SqliteJobStore store(path());
  EXPECT_EQ(shown(store), before);
  EXPECT_EQ(store.find("a")->scene_file, job.scene_file);
  EXPECT_EQ(store.find("a")->frames[1].exr->name, "\xff.0000.exr");
  EXPECT_EQ(store.find("a")->arguments, job.arguments);
  EXPECT_EQ(store.unfinished(), std::vector<std::string>{"a"});
  EXPECT_EQ(store.events("a")->size(), 3u);
  EXPECT_TRUE(store.events("b")->read(0, 10).ended);
  EXPECT_EQ(store.insert(job_named("c"), {"key", "other"}).kind, Submitted::Kind::conflict);
  EXPECT_EQ(store.count().at(JobState::failed), 1u);
}

TEST_F(Store, EndedJobsGoWhenThereIsTooMuch) {
  SqliteJobStore store(path());
  for (const std::string id : {"a", "b", "c"}) {
    Job job = job_named(id);
    job.scene_bytes = 100;
    store.insert(job, {});
    if (id != "a") store.update(id, [](Job& stored, NewEvents& events) { end(stored, events, JobState::done); });
  }
  EXPECT_TRUE(store.over_quota(300).empty());
  EXPECT_EQ(store.over_quota(299), std::vector<std::string>{"b"});
  EXPECT_EQ(store.over_quota(0), (std::vector<std::string>{"b", "c"}));  // never one that is not over
}

TEST_F(Store, WhoLooksSeesWholeChanges) {
  SqliteJobStore store(path());
  store.insert(job_named("a"), {});
  std::atomic<bool> over{false};
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= 300; ++i)
      store.update("a", [i](Job& job, NewEvents& events) {
        job.starts = job.fruitless_starts = i;
        events.append("n", {{"n", i}});
      });
    over = true;
  });
  while (!over) {
    const auto seen = store.events("a")->size();
    const Job job = *store.find("a");
    EXPECT_EQ(job.starts, job.fruitless_starts);
    EXPECT_GE(job.starts + 1, seen);  // a change is there before its event is
  }
  writer.join();
  EXPECT_EQ(store.events("a")->size(), 301u);
}

}  // namespace
}  // namespace sheaf::server

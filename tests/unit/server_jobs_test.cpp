// SPDX-License-Identifier: MIT
// Jobs: their events, their store, what workers' ends mean, the contract's names.
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <thread>

#include "http/problem.hpp"
#include "jobs/memory_job_store.hpp"
#include "jobs/outcome.hpp"
#include "jobs/settings.hpp"
#include "jobs/worker_events.hpp"
#include "routes/resources.hpp"
#include "service.hpp"

namespace sheaf::server {
namespace {

using Clock = std::chrono::steady_clock;

Job job_named(const std::string& id) {
  Job job;
  job.id = id;
  job.created = std::chrono::system_clock::now();
  return job;
}

TEST(EventLog, ReplaysFromAnyPlaceAndSaysWhenItIsOver) {
  EventLog log;
  for (int i = 0; i < 5; ++i) log.append("frame", {{"frame", i}});
  EXPECT_EQ(log.read(0, 100).events.size(), 5u);
  EXPECT_EQ(log.read(3, 100).events.front().id, 4u);
  EXPECT_EQ(log.read(0, 2).events.size(), 2u);
  EXPECT_TRUE(log.read(UINT64_MAX, 10).events.empty());
  EXPECT_FALSE(log.read(0, 100).ended);
  log.close();
  log.append("late", {});
  EXPECT_FALSE(log.read(0, 4).ended);  // there is one more
  EXPECT_TRUE(log.read(0, 5).ended);
  EXPECT_TRUE(log.wait(5, 10, Clock::now() + std::chrono::hours(1)).ended);
}

TEST(EventLog, ManyReadersMissNothing) {
  EventLog log;
  constexpr std::uint64_t count = 2000;
  std::vector<std::thread> readers;
  std::array<std::uint64_t, 4> sums{};
  for (std::uint64_t& sum : sums)
    readers.emplace_back([&log, &sum] {
      for (std::uint64_t after = 0;;) {
        const EventLog::Batch batch = log.wait(after, 7, Clock::now() + std::chrono::hours(1));
        for (const Event& event : batch.events) {
          EXPECT_EQ(event.id, after + 1);
          after = event.id;
          sum += event.data["n"].get<std::uint64_t>();
        }
        if (batch.ended) return;
      }
    });
  for (std::uint64_t i = 1; i <= count; ++i) log.append("n", {{"n", i}});
  log.close();
  for (std::thread& reader : readers) reader.join();
  for (const std::uint64_t sum : sums) EXPECT_EQ(sum, count * (count + 1) / 2);
}

TEST(EventLog, InterruptionLetsWaitersGo) {
  EventLog log;
  std::thread waiter([&] { EXPECT_TRUE(log.wait(0, 1, Clock::now() + std::chrono::hours(1)).events.empty()); });
  log.interrupt();
  waiter.join();
  EXPECT_TRUE(log.interrupted());
}

TEST(MemoryJobStore, PagesNewestFirstWithoutGapsOrRepeats) {
  MemoryJobStore store;
  for (int i = 0; i < 10; ++i) store.insert(job_named("j" + std::to_string(i)), {});
  store.update("j4", [](Job& job, EventLog&) { job.state = JobState::done; });
  JobQuery query;
  query.limit = 3;
  std::string seen;
  for (bool more = true; more;) {
    const JobPage page = store.list(query);
    for (const JobSummary& job : page.jobs) seen += job.id[1];
    query.before = page.next;
    more = page.next.has_value();
    if (seen.size() == 3) store.remove("j6");  // between two pages
    if (seen.size() == 3) store.insert(job_named("jx"), {});
  }
  EXPECT_EQ(seen, "987543210");
  query = {};
  query.state = JobState::done;
  ASSERT_EQ(store.list(query).jobs.size(), 1u);
  EXPECT_EQ(store.list(query).jobs[0].id, "j4");
  EXPECT_EQ(store.count().at(JobState::queued), 9u);
}

TEST(MemoryJobStore, KeysNameOneJobAsLongAsItIsThere) {
  MemoryJobStore store;
  EXPECT_EQ(store.insert(job_named("a"), {"k", "1"}).kind, Submitted::Kind::created);
  const Submitted again = store.insert(job_named("b"), {"k", "1"});
  EXPECT_EQ(again.kind, Submitted::Kind::repeated);
  EXPECT_EQ(again.id, "a");
  EXPECT_EQ(store.presence("b"), Presence::unknown);
  EXPECT_EQ(store.insert(job_named("c"), {"k", "2"}).kind, Submitted::Kind::conflict);
  EXPECT_TRUE(store.remove("a"));
  EXPECT_FALSE(store.remove("a"));
  EXPECT_EQ(store.presence("a"), Presence::removed);
  EXPECT_EQ(store.insert(job_named("d"), {"k", "2"}).kind, Submitted::Kind::created);
}

TEST(MemoryJobStore, OneOfManyEqualKeysWins) {
  MemoryJobStore store;
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

TEST(MemoryJobStore, ExpiryAndRemovalKeepEventsReadable) {
  MemoryJobStore store;
  store.insert(job_named("a"), {});
  const auto now = std::chrono::system_clock::now();
  store.update("a", [&](Job& job, EventLog&) { job.expires = now; });
  EXPECT_TRUE(store.expired(now - std::chrono::seconds(1)).empty());
  EXPECT_EQ(store.expired(now), std::vector<std::string>{"a"});
  const auto events = store.events("a");
  store.remove("a");
  EXPECT_TRUE(events->read(0, 10).ended);
  EXPECT_EQ(store.events("a"), nullptr);
  EXPECT_FALSE(store.update("a", [](Job&, EventLog&) { FAIL(); }));
}

TEST(Outcome, FollowsTheTable) {
  const auto ending = [](std::optional<int> code, std::optional<int> signal) {
    Ending end;
    end.worker = {code, signal};
    end.message = "why";
    return end;
  };
  EXPECT_EQ(outcome_of(ending(0, {})).state, JobState::done);
  const std::vector<std::pair<int, std::string>> table{
      {2, "worker-usage"}, {3, "bad-scene"},     {4, "device"},        {5, "limit-exceeded"},
      {6, "storage"},      {130, "interrupted"}, {143, "interrupted"}, {77, "worker-failed"}};
  for (const auto& [code, slug] : table) {
    const Outcome outcome = outcome_of(ending(code, {}));
    EXPECT_EQ(outcome.state, JobState::failed);
    EXPECT_EQ(outcome.failure->code, slug);
    EXPECT_EQ(outcome.failure->message, "why");
    EXPECT_EQ(outcome.failure->exit_code, code);
  }
  EXPECT_EQ(outcome_of(ending({}, SIGSEGV)).failure->message, "worker ended by signal 11 (SIGSEGV)");
  Ending cancelled = ending({}, SIGKILL);
  cancelled.cancel_requested = true;
  EXPECT_EQ(outcome_of(cancelled).state, JobState::cancelled);
  EXPECT_FALSE(outcome_of(cancelled).failure);
  Ending incomplete = ending(0, {});
  incomplete.missing = 2;
  EXPECT_EQ(outcome_of(incomplete).failure->code, "incomplete");
}

TEST(WorkerEvents, AreTakenOnlyWhereTheyAreWhole) {
  const auto frame =
      parse_worker_event(R"({"event":"frame","frame":-3,"wall_ms":2,"file":"/a/b/f.-0003.exr","new":1})");
  ASSERT_TRUE(frame && std::holds_alternative<FrameEvent>(*frame));
  EXPECT_EQ(std::get<FrameEvent>(*frame).file, "f.-0003.exr");
  EXPECT_EQ(std::get<FrameEvent>(*frame).frame, -3);
  EXPECT_TRUE(parse_worker_event(R"({"event":"start","frames":4})"));
  EXPECT_TRUE(parse_worker_event(R"({"event":"warning"})"));
  for (const char* line :
       {"", "x", "7", "null", "[]", "{}", R"({"event":1})", R"({"event":"other"})", R"({"event":"start"})",
        R"({"event":"start","frames":-1})", R"({"event":"start","frames":1.5})", R"({"event":"frame","frame":1})",
        R"({"event":"frame","frame":1,"file":"a/"})", R"({"event":"frame","frame":1,"file":".."})",
        R"({"event":"frame","frame":"1","file":"a"})", "{\"event\":\"frame\",\"frame\":1,\"file\":\"a\\u0000b\"}"})
    EXPECT_FALSE(parse_worker_event(line)) << line;
}

TEST(Contract, NamesEverySettingAndEveryRoute) {
  const auto contract = nlohmann::json::parse(openapi_json);
  std::set<std::string> described;
  for (const auto& [name, schema] : contract.at("components").at("schemas").at("Settings").at("properties").items())
    described.insert(name);
  const auto names = setting_names();
  EXPECT_EQ(described, std::set<std::string>(names.begin(), names.end()));

  ProgramOptions options;
  options.service.runner.sheaf = "/bin/true";
  const Service service(options);
  std::set<std::string> routes;
  for (const auto& [path, item] : contract.at("paths").items())
    for (const char* method : {"get", "post", "put", "patch", "delete"})
      if (item.contains(method))
        routes.insert((std::string(method) == "get"    ? "GET "
                       : std::string(method) == "post" ? "POST "
                                                       : "DELETE ") +
                      path);
  const auto real = service.routes();
  EXPECT_EQ(routes, std::set<std::string>(real.begin(), real.end()));
}

TEST(Settings, RatesMayBeRatios) {
  const Settings settings = parse_settings({{"fps", "24000/1001"}}, false, Limits{});
  EXPECT_EQ(settings.arguments.front(), "--fps=23.976023976023978");
  EXPECT_EQ(settings.resolved["fps"], "24000/1001");
}

}  // namespace
}  // namespace sheaf::server

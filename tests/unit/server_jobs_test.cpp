// SPDX-License-Identifier: MIT
// Jobs: their events, their store, what workers' ends mean, the contract's names.
#include <gtest/gtest.h>

#include <csignal>
#include <set>
#include <string>
#include <thread>

#include "jobs/outcome.hpp"
#include "jobs/settings.hpp"
#include "jobs/worker_events.hpp"
#include "program/service.hpp"
#include "routes/contract.hpp"
#include "settings/setting.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

using Clock = std::chrono::steady_clock;

void append(EventLog& log, const std::string& type, nlohmann::ordered_json data = {}) {
  NewEvents events(log.size());
  events.append(type, std::move(data));
  log.publish(events.list(), false);
}

TEST(EventLog, ReplaysFromAnyPlaceAndSaysWhenItIsOver) {
  EventLog log;
  for (int i = 0; i < 5; ++i) append(log, "frame", {{"frame", i}});
  EXPECT_EQ(log.read(0, 100).events.size(), 5u);
  EXPECT_EQ(log.read(3, 100).events.front().id, 4u);
  EXPECT_EQ(log.read(0, 2).events.size(), 2u);
  EXPECT_TRUE(log.read(UINT64_MAX, 10).events.empty());
  EXPECT_FALSE(log.read(0, 100).ended);
  log.close();
  append(log, "late");
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
  for (std::uint64_t i = 1; i <= count; ++i) append(log, "n", {{"n", i}});
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

TEST(Outcome, OnlyWhatIsNotTheScenesIsTriedAgain) {
  const auto passing = [](std::optional<int> code, std::optional<int> signal) {
    Ending end;
    end.worker = {code, signal};
    return is_transient(end);
  };
  for (const int code : {4, 6, 130, 143}) EXPECT_TRUE(passing(code, {})) << code;
  for (const int code : {0, 1, 2, 3, 5}) EXPECT_FALSE(passing(code, {})) << code;
  EXPECT_TRUE(passing({}, SIGKILL));
  for (const int number : {SIGSEGV, SIGABRT, SIGXCPU, SIGSYS}) EXPECT_FALSE(passing({}, number)) << number;
  Ending late;
  late.worker = {{}, SIGKILL, true};
  EXPECT_FALSE(is_transient(late));
  EXPECT_EQ(outcome_of(late).failure->code, "limit-exceeded");
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
  const auto frame = parse_worker_event(R"({"event":"frame","frame":-3,"wall_ms":2,"file":"/a/b/f.-003.exr","new":1})");
  ASSERT_TRUE(frame && std::holds_alternative<FrameEvent>(*frame));
  EXPECT_EQ(std::get<FrameEvent>(*frame).file, "f.-003.exr");
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
  const nlohmann::json contract = contract_of({});
  std::set<std::string> described, taken;
  for (const auto& [name, schema] : contract.at("components").at("schemas").at("Settings").at("properties").items())
    described.insert(name);
  for (const Setting& setting : settings_table())
    if (setting.http) taken.insert(setting.name);
  EXPECT_EQ(described, taken);

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
  EXPECT_EQ(settings.arguments.front(), "--fps=24000/1001");
  EXPECT_EQ(settings.resolved["fps"], "24000/1001");
}

}  // namespace
}  // namespace sheaf::server

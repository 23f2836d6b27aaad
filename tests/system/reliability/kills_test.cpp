// Kills a service repeatedly at random moments while clients post. Afterwards no accepted job may be lost, no
// question may have two answers, and the store must be sound.
//
// The environment may set FACETLESS_KILLS (default 5) and FACETLESS_SEED (default: a new one, which is
// printed):
//   FACETLESS_KILLS=200 build/bin/reliability_test
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <atomic>
#include <cstdlib>
#include <map>
#include <mutex>
#include <random>
#include <set>
#include <thread>

#include "server/service/store/store_check.h"
#include "tests/system/http/live_server.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

constexpr int kClients = 4;

std::uint64_t FromEnvironment(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

struct Sent {
  std::string text, options;  // the question
  std::string key;            // its Idempotency-Key
  std::string job;            // the id of the job, if the answer was 202
};

// Returns the answer as its first job gave it. A kept answer has the time of finding it in `timing_ms`, and
// the first job's times in `kept`.
std::string AsFirstGiven(Json answer) {
  if (const auto kept = answer.find("kept"); kept != answer.end()) {
    answer["timing_ms"] = kept->at("timing_ms");
    answer.erase("kept");
  }
  return answer.dump();
}

// Records what the service has promised to the clients.
class Ledger {
 public:
  void Accepted(Sent sent) {
    const std::lock_guard lock(mutex_);
    accepted_.push_back(std::move(sent));
  }
  void Answered(const Sent& sent, const std::string& body) {
    const std::lock_guard lock(mutex_);
    answers_[sent.text + sent.options].insert(AsFirstGiven(Json::parse(body)));
  }
  const std::vector<Sent>& accepted() const { return accepted_; }
  // Maps each question to its distinct answers.
  const std::map<std::string, std::set<std::string>>& answers() const { return answers_; }

 private:
  std::mutex mutex_;
  std::vector<Sent> accepted_;
  std::map<std::string, std::set<std::string>> answers_;
};

class Client {
 public:
  Client(LiveServer& server, Ledger& ledger, const std::atomic<bool>& stop, std::uint64_t seed, int number)
      : server_(server),
        ledger_(ledger),
        stop_(stop),
        random_(seed + static_cast<std::uint64_t>(number)),
        number_(number) {}

  void Run() {
    while (!stop_) Post();
  }

 private:
  int Draw(int below) { return std::uniform_int_distribution<int>(0, below - 1)(random_); }

  void Post() {
    // Half of the requests use a few questions, so that some are asked twice at once and some are repeated.
    // Some fail.
    constexpr const char* kTexts[] = {"ok", "slow 50", "slow 150", "slow 400", "unusable nothing-usable"};
    Sent sent;
    sent.text = std::string(kTexts[Draw(5)]) + " " + std::to_string(Draw(2) == 0 ? Draw(10) : Draw(1000000));
    if (sent.text.starts_with("unusable")) sent.text = kTexts[4];
    sent.options = Draw(2) == 0 ? R"({"size":"32x32"})" : R"({"size":"40x24","view":["top","iso"]})";
    sent.key = "client " + std::to_string(number_) + " request " + std::to_string(++requests_);
    const LiveServer::Headers headers = {{"Prefer", Draw(2) == 0 ? "wait=0" : "wait=1"},
                                         {"Idempotency-Key", sent.key}};
    // A client that gets no answer repeats the request with the same key.
    Reply reply;
    while (reply.status == 0 || reply.status == 503) {
      if (stop_) return;
      reply = server_.PostForm("/v1/renders",
                               {{"file", "square.step", sent.text}, {"options", "", sent.options}}, headers);
      if (reply.status == 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    const Json json = reply.Json();
    if (reply.status == 202 && json.is_object()) {
      sent.job = json.value("id", "");
      ledger_.Accepted(sent);
    } else if (reply.status == 200 && json.is_object()) {
      ledger_.Answered(sent, reply.body);
    } else if (!json.is_discarded()) {
      EXPECT_EQ(reply.status, sent.text == kTexts[4]         ? 422
                              : reply.Problem() == "gave-up" ? 500
                                                             : 200)
          << reply.body;
    }
  }

  LiveServer& server_;
  Ledger& ledger_;
  const std::atomic<bool>& stop_;
  std::mt19937_64 random_;
  const int number_;
  int requests_ = 0;
};

TEST(Reliability, NothingIsLostWhenTheServiceIsKilled) {
  const auto kills = FromEnvironment("FACETLESS_KILLS", 5);
  const auto seed = FromEnvironment("FACETLESS_SEED", std::random_device{}());
  std::printf("%d kills, %d clients, FACETLESS_SEED=%llu\n", static_cast<int>(kills), kClients,
              static_cast<unsigned long long>(seed));
  LiveServer server({"--queue", "1000"}, Program("facetless-fake-importer"));
  Ledger ledger;
  std::atomic<bool> stop{false};
  std::vector<std::thread> clients;
  for (int i = 0; i < kClients; ++i)
    clients.emplace_back([&, i] { Client(server, ledger, stop, seed, i).Run(); });
  std::mt19937_64 random(seed - 1);
  for (std::uint64_t i = 0; i < kills; ++i) {
    std::this_thread::sleep_for(
        std::chrono::milliseconds(std::uniform_int_distribution<int>(0, 1200)(random)));
    EXPECT_EQ(server.Stop(SIGKILL), 128 + SIGKILL) << "the server ended unexpectedly";
    server.Start();
  }
  stop = true;
  for (std::thread& client : clients) client.join();

  // Every accepted job must end, with the expected result.
  int done = 0, failed = 0, given_up = 0;
  std::map<std::string, std::set<std::string>> answers = ledger.answers();
  for (const Sent& sent : ledger.accepted()) {
    const Json job = server.JobAtItsEnd(sent.job);
    ASSERT_TRUE(job.is_object()) << sent.job << " is lost: " << sent.text;
    const std::string state = job.at("state");
    const std::string problem = job.value("problem", Json::object()).value("type", "");
    if (problem.ends_with("gave-up")) {
      ++given_up;
    } else if (sent.text.starts_with("unusable")) {
      EXPECT_TRUE(problem.ends_with("nothing-usable")) << job;
      ++failed;
    } else {
      EXPECT_EQ(state, "done") << job;
      answers[sent.text + sent.options].insert(AsFirstGiven(job.at("result")));
      ++done;
    }
  }
  for (const auto& [question, texts] : answers)
    EXPECT_EQ(texts.size(), 1u) << question << " has several answers: " << testing::PrintToString(texts);
  EXPECT_GT(done + static_cast<int>(answers.size()), 0) << "no request of the clients succeeded";

  // The data on the disk must be consistent.
  EXPECT_EQ(server.Stop(SIGTERM), 0);
  const auto checked = CheckStore(server.data());
  ASSERT_TRUE(checked.ok()) << checked.error().message;
  EXPECT_EQ(checked.value().at("faults"), Json::array());
  std::printf(
      "%zu jobs accepted and asked for: %d done, %d failed as they should, %d given up after three deaths; "
      "%zu questions with one answer each; jobs in the store: %s\n",
      ledger.accepted().size(), done, failed, given_up, answers.size(),
      checked.value().at("jobs").dump().c_str());
  server.Start();
}

}  // namespace
}  // namespace facetless

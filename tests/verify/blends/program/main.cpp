// facetless_blends [--first SEED] [--count N] [--size PIXELS] [--seconds S] makes OpenCASCADE's fillets,
// chamfers, sweeps, lofts and offsets, and renders, audits and judges each in a process of its own. The table
// goes to standard output, each finding to standard error.
//
// Exit status: 0 nothing was found, 2 a blend hung, crashed, leaked or was certified wrongly, 64 bad usage.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <OSD.hxx>
#include <chrono>
#include <cstdio>
#include <map>
#include <string>
#include <thread>

#include "tests/verify/blends/blends.h"

namespace facetless {
namespace {

struct Options {
  std::uint64_t first = 0;
  int count = 200, size = 128;
  double seconds = 30;
};

enum class Stage : std::uint8_t { kMaking, kConverting, kRendering, kDone, kNotMade, kRefused };
const char* Name(Stage stage) {
  constexpr const char* kNames[] = {"making", "converting", "rendering", "done", "not made", "refused"};
  return kNames[static_cast<int>(stage)];
}

// The message in which the child process reports its blend at each stage.
struct Message {
  Stage stage = Stage::kMaking;
  BlendReport report;
  char what[200] = {};
  char why[400] = {};  // for kRefused: the error
};

void Child(std::uint64_t seed, int size, int to) {
  OSD::SetSignal(false);
  Message message;
  const auto say = [&](Stage stage) {
    message.stage = stage;
    if (write(to, &message, sizeof message) != sizeof message) _exit(1);
  };
  say(Stage::kMaking);
  const std::optional<Blend> blend = MakeBlend(seed);
  if (!blend) return say(Stage::kNotMade);
  std::snprintf(message.what, sizeof message.what, "%s", blend->what.c_str());
  say(Stage::kConverting);
  const Result<Model> model = ModelOfBlend(*blend);
  const auto refuse = [&](const Error& error) {
    std::snprintf(message.why, sizeof message.why, " (%s)", error.message.c_str());
    say(Stage::kRefused);
  };
  if (!model.ok()) return refuse(model.error());
  say(Stage::kRendering);
  const Result<BlendReport> report = JudgeBlend(model.value(), seed, size);
  if (!report.ok()) return refuse(report.error());
  message.report = report.value();
  say(Stage::kDone);
}

struct Totals {
  std::map<std::string, int> by_outcome;
  BlendReport sum;
  int findings = 0, closed = 0;
  double slowest_s = 0;
};

void Judge(std::uint64_t seed, const Options& options, Totals* totals) {
  int ends[2];
  if (pipe(ends) != 0) return;
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    Child(seed, options.size, ends[1]);
    _exit(0);
  }
  close(ends[1]);
  int status = 0;
  bool ended = false;
  double seconds = 0;
  while (!ended && seconds < options.seconds) {
    ended = waitpid(child, &status, WNOHANG) == child;
    if (!ended) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  if (!ended) {
    kill(child, SIGKILL);
    waitpid(child, &status, 0);
  }
  Message message;
  while (read(ends[0], &message, sizeof message) == sizeof message) {
  }
  close(ends[0]);

  // OpenCASCADE may fail, crash or hang while it makes a blend. That is not a finding about Facetless.
  std::string outcome = Name(message.stage);
  bool found = false;
  if (!ended) outcome += ": no end";
  if (ended && WIFSIGNALED(status)) outcome += ": crash";
  if (message.stage == Stage::kDone) {
    const BlendReport& r = message.report;
    found = r.odd + r.mismatched + r.contradicted + r.wrong + r.limited > 0;
    totals->sum.faces += r.faces;
    totals->sum.highest_degree = std::max(totals->sum.highest_degree, r.highest_degree);
    totals->sum.rays += r.rays;
    totals->sum.odd += r.odd;
    totals->sum.mismatched += r.mismatched;
    totals->sum.certified += r.certified;
    totals->sum.contradicted += r.contradicted;
    totals->sum.limited += r.limited;
    totals->sum.judged += r.judged;
    totals->sum.wrong += r.wrong;
    totals->closed += r.closed;
    totals->slowest_s = std::max(totals->slowest_s, seconds);
  } else {
    found = message.stage != Stage::kNotMade && message.stage != Stage::kMaking;
  }
  ++totals->by_outcome[outcome];
  totals->findings += found;
  if (found)
    std::fprintf(stderr,
                 "seed %llu: %s: %s%s; odd %llu, mismatched %llu, contradicted %llu, wrong %llu, limited "
                 "%llu, %.1f s\n",
                 static_cast<unsigned long long>(seed), message.what, outcome.c_str(), message.why,
                 static_cast<unsigned long long>(message.report.odd),
                 static_cast<unsigned long long>(message.report.mismatched),
                 static_cast<unsigned long long>(message.report.contradicted),
                 static_cast<unsigned long long>(message.report.wrong),
                 static_cast<unsigned long long>(message.report.limited), seconds);
}

int Run(const Options& options) {
  Totals totals;
  for (int i = 0; i < options.count; ++i)
    Judge(options.first + static_cast<std::uint64_t>(i), options, &totals);
  for (const auto& [outcome, count] : totals.by_outcome) std::printf("%-24s %d\n", outcome.c_str(), count);
  const BlendReport& sum = totals.sum;
  std::printf(
      "faces %u, highest degree %d, closed %d; rays %llu: odd %llu, mismatched %llu; certified %llu: "
      "contradicted %llu; before the "
      "oracle %llu: wrong %llu; slowest %.1f s\n",
      sum.faces, sum.highest_degree, totals.closed, static_cast<unsigned long long>(sum.rays),
      static_cast<unsigned long long>(sum.odd), static_cast<unsigned long long>(sum.mismatched),
      static_cast<unsigned long long>(sum.certified), static_cast<unsigned long long>(sum.contradicted),
      static_cast<unsigned long long>(sum.judged), static_cast<unsigned long long>(sum.wrong),
      totals.slowest_s);
  return totals.findings > 0 ? 2 : 0;
}

}  // namespace
}  // namespace facetless

int main(int argc, char** argv) {
  facetless::Options options;
  CLI::App app("Renders, audits and judges blends as OpenCASCADE makes them");
  app.add_option("--first", options.first, "The first seed");
  app.add_option("--count", options.count, "Seeds to try")->check(CLI::PositiveNumber);
  app.add_option("--size", options.size, "Pixels along each side of a view")->check(CLI::Range(16, 4096));
  app.add_option("--seconds", options.seconds, "What one blend may take")->check(CLI::PositiveNumber);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 64;
  }
  return facetless::Run(options);
}

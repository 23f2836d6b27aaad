#include "tests/verify/extremes/table.h"

#include <cstdio>

#include "tests/verify/extremes/extreme.h"
#include "tests/verify/extremes/imports.h"
#include "tests/verify/extremes/tangency.h"

namespace facetless::extremes {
namespace {

std::string Share(const Outcome& outcome) {
  if (outcome.error) return "error";
  char text[40];
  std::snprintf(text, sizeof text, "%.2f", 100 * outcome.CertifiedShare());
  // A share below 100 % must not be shown as 100 %.
  if (std::string(text) == "100.00") return outcome.CertifiedShare() < 1 ? ">99.99" : "100";
  return text;
}

std::string Doubts(const Outcome& outcome) {
  std::string text;
  for (std::size_t bit = 0; bit < outcome.doubts.size(); ++bit) {
    if (outcome.doubts[bit] == 0) continue;
    text += (text.empty() ? "" : ", ") + std::to_string(outcome.doubts[bit]) + " " + kDoubtNames[bit];
  }
  return text;
}

// Returns the number of right samples among those judged, and the largest error of the depths.
std::string Got(const Measurement& measurement) {
  if (measurement.outcomes[1].error)
    return std::string(ErrorCodeName(measurement.outcomes[1].error->code)) + ": " +
           measurement.outcomes[1].error->message;
  std::uint64_t judged = 0, wrong = 0, certified = 0, certified_wrong = 0;
  for (const Outcome& outcome : measurement.outcomes) {
    certified += outcome.judged[0];
    certified_wrong += outcome.wrong[0];
    judged += outcome.judged[1] + outcome.judged[2];
    wrong += outcome.wrong[1] + outcome.wrong[2];
  }
  char text[200];
  std::snprintf(text, sizeof text, "%llu of %llu certified right",
                static_cast<unsigned long long>(certified - certified_wrong),
                static_cast<unsigned long long>(certified));
  std::string got = text;
  if (judged > 0) {
    std::snprintf(text, sizeof text, ", %llu of %llu others", static_cast<unsigned long long>(judged - wrong),
                  static_cast<unsigned long long>(judged));
    got += text;
  }
  const std::string doubts = Doubts(measurement.outcomes[2]);
  if (!doubts.empty()) got += "; " + doubts;
  return got;
}

void WriteRow(const Extreme& extreme, const Measurement& measurement) {
  const auto& [fast, standard, certified] = measurement.outcomes;
  std::string accuracy = "—";
  if (!certified.error && certified.bound_mm > 0) {
    char text[80];
    std::snprintf(text, sizeof text, "%.1e / %.1e", certified.off_mm, certified.bound_mm);
    accuracy = text;
  }
  std::printf("| %s | %s | %s | %s | %s / %s / %s | %s | %.0f / %.0f / %.0f |\n", extreme.group.c_str(),
              extreme.input.c_str(), extreme.expected.c_str(), Got(measurement).c_str(), Share(fast).c_str(),
              Share(standard).c_str(), Share(certified).c_str(), accuracy.c_str(), fast.milliseconds,
              standard.milliseconds, certified.milliseconds);
  std::fflush(stdout);
}

bool WriteImports() {
  bool holds = true;
  for (const StepExtreme& extreme : StepExtremes()) {
    const StepMeasurement measured = MeasureStep(extreme);
    if (measured.refusal.empty()) {
      Extreme row;
      row.group = "STEP file";
      row.input = extreme.input;
      row.expected = extreme.expected;
      WriteRow(row, measured.measurement);
    } else {
      std::printf("| STEP file | %s | %s | %s | — | — | — |\n", extreme.input.c_str(),
                  extreme.expected.c_str(), measured.refusal.c_str());
    }
    for (const std::string& failure : measured.failures) {
      std::fprintf(stderr, "STEP file, %s: %s\n", extreme.input.c_str(), failure.c_str());
      holds = false;
    }
  }
  return holds;
}

// Writes one line per surface and side, with one column per offset, for `certified`.
bool WriteTangency() {
  bool holds = true;
  std::printf("\n| rays beside a silhouette, by |");
  for (int digits = 1; digits <= 16; ++digits) std::printf(" 1e-%d |", digits);
  std::printf("\n|---|");
  for (int digits = 1; digits <= 16; ++digits) std::printf("---|");
  std::string line;
  for (const TangentRays& rays : MeasureTangency()) {
    const std::string next = rays.surface + (rays.inside ? ", inside" : ", outside");
    if (next != line) std::printf("\n| %s |", next.c_str());
    line = next;
    const TangentRays::Count& certified = rays.counts[2];
    std::printf(" %llu", static_cast<unsigned long long>(certified.certified));
    if (certified.doubtful_right > 0)
      std::printf(" + %llu", static_cast<unsigned long long>(certified.doubtful_right));
    std::printf(" |");
    for (const TangentRays::Count& count : rays.counts) {
      if (count.certified_wrong == 0) continue;
      std::fprintf(stderr, "%s by %g: certified and wrong\n", next.c_str(), rays.offset);
      holds = false;
    }
  }
  std::printf("\n");
  return holds;
}

}  // namespace

bool WriteTables(const TableOptions& options) {
  bool holds = true;
  std::printf(
      "| group | input | expected | got (three precisions; doubts of `certified`) | certified, %%: fast / "
      "standard / "
      "certified | depth off / stated, mm | ms: fast / standard / certified "
      "|\n|---|---|---|---|---|---|---|\n");
  for (const Extreme& extreme : Catalogue()) {
    if (extreme.by_hand && !options.by_hand) continue;
    if (extreme.group.find(options.only) == std::string::npos &&
        extreme.input.find(options.only) == std::string::npos)
      continue;
    if (options.list) {
      std::printf("%s\n", extreme.input.c_str());
      continue;
    }
    const Measurement measurement = Measure(extreme);
    WriteRow(extreme, measurement);
    for (const std::string& failure : measurement.failures) {
      std::fprintf(stderr, "%s, %s: %s\n", extreme.group.c_str(), extreme.input.c_str(), failure.c_str());
      holds = false;
    }
  }
  if (!options.list && (options.only.empty() || options.only == "STEP file")) holds = WriteImports() && holds;
  if (!options.list && (options.only.empty() || options.only == "tangency")) holds = WriteTangency() && holds;
  return holds;
}

}  // namespace facetless::extremes

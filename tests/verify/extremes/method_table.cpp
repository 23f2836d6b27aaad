#include <cstdio>

#include "tests/verify/extremes/methods.h"
#include "tests/verify/extremes/table.h"

namespace facetless::extremes {
namespace {

std::string Number(std::uint64_t number) {
  return std::to_string(number);
}

// What a method got wrong in a row; "–" if nothing.
std::string Cell(const MethodOutcome& outcome) {
  if (outcome.error) return ErrorCodeName(outcome.error->code);
  std::string text;
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count > 0) text += (text.empty() ? "" : " ") + Number(count) + what;
  };
  add(outcome.lost, "l");
  add(outcome.invented, "i");
  add(outcome.imprecise, "p");
  add(outcome.open, "o");
  return text.empty() ? "–" : text;
}

// The sums over all rows.
struct Sum {
  std::uint64_t rows = 0, errors = 0;
  MethodOutcome outcome;
};

void WriteSums(const std::vector<Sum>& sums) {
  std::printf(
      "\n| method | rows without a mistake | lost | invented | imprecise | open | rows refused | s "
      "|\n|---|---|---|---|---|---|---|---|\n");
  for (const Sum& sum : sums)
    std::printf("| %s | %s | %s | %s | %s | %s | %s | %.1f |\n", sum.outcome.method.c_str(),
                Number(sum.rows).c_str(), Number(sum.outcome.lost).c_str(),
                Number(sum.outcome.invented).c_str(), Number(sum.outcome.imprecise).c_str(),
                Number(sum.outcome.open).c_str(), Number(sum.errors).c_str(),
                1e-3 * sum.outcome.milliseconds);
}

void Add(const MethodOutcome& outcome, Sum* sum) {
  sum->outcome.method = outcome.method;
  sum->errors += outcome.error.has_value();
  sum->rows += !outcome.error && outcome.wrong() == 0;
  sum->outcome.lost += outcome.lost;
  sum->outcome.invented += outcome.invented;
  sum->outcome.imprecise += outcome.imprecise;
  sum->outcome.open += outcome.open;
  sum->outcome.milliseconds += outcome.milliseconds;
}

}  // namespace

bool WriteMethodTable(const TableOptions& options, int size) {
  const std::vector<std::string> names = MethodNames();
  std::string head = "| group | input | samples | in doubt |", rule = "|---|---|---|---|";
  for (const std::string& name : names) {
    head += " " + name + " |";
    rule += "---|";
  }
  std::printf("%s\n%s\n", head.c_str(), rule.c_str());
  bool holds = true;
  std::vector<Sum> sums(names.size());
  for (const Extreme& extreme : Catalogue()) {
    if (extreme.by_hand && !options.by_hand) continue;
    if (extreme.group.find(options.only) == std::string::npos &&
        extreme.input.find(options.only) == std::string::npos)
      continue;
    const MethodMeasurement measured = MeasureMethods(extreme, {.size = size});
    std::printf("| %s | %s |", extreme.group.c_str(), extreme.input.c_str());
    if (measured.error) {
      std::printf(" — | — |");
      for (std::size_t m = 0; m < names.size(); ++m)
        std::printf(" %s |", ErrorCodeName(measured.error->code));
      std::printf("\n");
      continue;
    }
    std::printf(" %s | %s |", Number(measured.samples).c_str(), Number(measured.doubts).c_str());
    for (std::size_t m = 0; m < names.size(); ++m) {
      const MethodOutcome& outcome = measured.outcomes[m];
      std::printf(" %s |", Cell(outcome).c_str());
      Add(outcome, &sums[m]);
      if (outcome.not_numbers > 0) {
        std::fprintf(stderr, "%s, %s: %s: %s samples are not numbers\n", extreme.group.c_str(),
                     extreme.input.c_str(), outcome.method.c_str(), Number(outcome.not_numbers).c_str());
        holds = false;
      }
    }
    std::printf("\n");
    std::fflush(stdout);
  }
  WriteSums(sums);
  return holds;
}

}  // namespace facetless::extremes

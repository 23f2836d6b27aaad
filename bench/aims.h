// The aims of the performance table, and the values that were measured for them.
//
//  1. A value compares the direct renderer with a competitor, on one file and view, with one number of
//     threads. Its `ratio` says how many times better the direct renderer is. Memory, the
//     next view and samples have aims that are upper bounds: there it is the direct renderer's value divided by
//     the competitor's. For growth it is the exponent.
//  2. A row is met if the geometric mean of its values meets the aim for the mean, and every value meets the
//     aim for single values.
//  3. A competitor that did not finish counts with the time limit, and the value says so.
//  4. A row may have no aim. It is then a comparison alone, which is neither met nor missed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/table.h"

namespace facetless {

enum class AimKind : std::uint8_t { kAtLeast, kAtMost };

struct Aim {
  const char* id;       // "first_image_default_mesh"
  const char* number;   // number of the row: "1", "4 fast"
  const char* what;     // "first exact image"
  const char* against;  // "default mesh (1e-3): meshing, tree, trace, shade"
  const char* text;     // "2× on average, never below 0.67×"
  AimKind kind;
  std::optional<double> mean, each;
  bool IsComparisonAlone() const { return !mean && !each; }
};

// Returns all rows, in the order of the table.
const std::vector<Aim>& Aims();
// Returns the aim with this id. Requires an id of Aims().
const Aim& FindAim(const std::string& id);

enum class ValueUnit : std::uint8_t { kMilliseconds, kRaysPerSecond, kBytes, kNone };

struct BenchValue {
  std::string aim;  // Aim::id
  std::string file, view;
  int threads = 1;
  double direct = 0, other = 0;  // medians
  double ratio = 0;
  ValueUnit unit = ValueUnit::kMilliseconds;
  int repetitions = 1;
  bool at_limit = false;  // the competitor was stopped at the time limit
  std::string skipped;    // if there are no numbers: the reason
};

struct AimSummary {
  const Aim* aim = nullptr;
  int threads = 1;
  int values = 0;
  double mean = 0, worst = 0;
  std::string worst_file;
  bool met = false;  // of a comparison alone: without meaning
};

// Returns one summary for each aim and number of threads that has values.
std::vector<AimSummary> Summarise(const std::vector<BenchValue>& values);

// AimTable lists the rows with their aims, ValueTable every value of every file.
Table AimTable(const std::vector<BenchValue>& values);
Table ValueTable(const std::vector<BenchValue>& values);

nlohmann::json ValueJson(const BenchValue& value);
nlohmann::json SummaryJson(const AimSummary& summary);

}  // namespace facetless

// The kinds of jobs, in one table. The addresses, the contents of requests, the functions that run, and the
// names in the store, in answers and in metrics come from this table. A new kind is one enumerator and one
// row of JobKinds().
//
//  1. There is one row for each kind except kUnknown, in the order of the enumeration.
//  2. A kind accepts the options of its commands (option_table.h). For any other option, the error names the
//     option and the addresses that accept it.
//  3. The store may contain jobs of a kind that this version does not know, because a newer version stored
//     them. Such a job is kUnknown, and fails with a sentence that says so.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "server/options/options.h"
#include "server/run/run_result.h"

namespace facetless {

class JobInputs;

enum class JobKind { kModel, kRender, kComparison, kTrade, kUnknown };

struct JobKindRow {
  JobKind kind = JobKind::kUnknown;
  std::string name;                    // "comparison": in the store, in answers and in metrics
  std::vector<std::string> addresses;  // addresses for POST; the documentation uses the first one
  Commands commands = 0;       // the kind accepts their options; 0: none, and the body may be the file
  bool compares_mesh = false;  // the kind needs a mesh: the part "mesh", or our own tessellation
  // Checks the options as far as that is possible without the model. Null: nothing to check. Error:
  // kBadUsage.
  Result<void> (*check)(const RunOptions& options) = nullptr;
  // Does the work and writes its files into `directory`, which it creates. The result names the files. Null:
  // the model itself is the answer.
  Result<RunResult> (*run)(JobInputs& inputs, const std::string& directory) = nullptr;
};

const std::vector<JobKindRow>& JobKinds();

// Returns the row of a kind. Requires that the kind is not kUnknown.
const JobKindRow& RowOf(JobKind kind);
// Returns "unknown" for kUnknown.
const std::string& JobKindName(JobKind kind);
// Returns kUnknown if no kind has the name.
JobKind JobKindOf(const std::string& name);

// Returns the last part of the kind's address, such as "comparisons".
std::string Collection(const JobKindRow& row);
// Returns the collections whose requests accept the option; none if the caller does not own the option.
std::vector<std::string> CollectionsOf(const OptionRow& option);

// Checks law 2. An unknown option, and an option that no request may give, are errors, too. Error: kBadUsage.
Result<void> CheckOptionNames(const JobKindRow& row, const nlohmann::json& options);

}  // namespace facetless

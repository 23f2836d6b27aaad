// The kinds of jobs: one table, of which addresses, what a request may say, what runs, and the names in the
// store, in answers and in metrics are made. A new kind is one enumerator and one row of JobKinds().
//
//  1. There is one row for each kind but kUnknown, in the order of the enumeration.
//  2. A kind takes the options of its commands (option_table.h) and no others; what it does not take is an
//     error that names the option and the addresses that take it.
//  3. The store may hold jobs of a kind that this version does not know, because a newer version put them
//     there. Such a job is kUnknown, and fails with a sentence that says so.
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
  std::vector<std::string> addresses;  // where it is posted; the first one is what the documentation says
  Commands commands = 0;       // their options are the kind's; 0: it takes none, and the body may be the file
  bool compares_mesh = false;  // it needs a mesh: the part "mesh", or a tessellation of our own
  // What can be known of options without the model. Null: nothing. Errors: kBadUsage.
  Result<void> (*check)(const RunOptions& options) = nullptr;
  // Does the work and writes its files into `directory`, which it creates; the result names them. Null: the
  // model itself is the answer.
  Result<RunResult> (*run)(JobInputs& inputs, const std::string& directory) = nullptr;
};

const std::vector<JobKindRow>& JobKinds();

// The row of a kind. Requires another kind than kUnknown.
const JobKindRow& RowOf(JobKind kind);
// "unknown" of kUnknown.
const std::string& JobKindName(JobKind kind);
// kUnknown where no kind has the name.
JobKind JobKindOf(const std::string& name);

// The address without what all have in common: "comparisons".
std::string Collection(const JobKindRow& row);
// The collections whose requests take the option; none where it has another owner than the caller.
std::vector<std::string> CollectionsOf(const OptionRow& option);

// Law 2. Besides, a name of no option, and an option that a request may not give, are errors. Error: kBadUsage.
Result<void> CheckOptionNames(const JobKindRow& row, const nlohmann::json& options);

}  // namespace facetless

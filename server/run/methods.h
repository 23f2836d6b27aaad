// `facetless methods`: the methods that intersect rays with exact surfaces, by name; and what each costs and gets wrong on
// a file.
//
//  1. The list has the names, the sources, what each method does and what it does not promise.
//  2. On a file, each view is traced by each method on one thread, and judged by the certified image of the same camera
//     (bench/method_bench.h).
//  3. With a directory, VIEW.NAME.png is the picture of each method in grey with its errors marked, VIEW.certified.png is
//     the certified picture, and methods.json has all figures.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "server/run/run.h"

namespace facetless {

// All methods, as a text for a terminal of 100 columns, and as {"methods": [...]}.
std::string MethodsText();
nlohmann::json MethodsJson();

struct MethodsResult {
  nlohmann::json json;
  std::string text;  // the tables
};

// Measures the methods of options.trade.methods; all of them if it is empty. `directory` may be empty. Errors: kBadUsage
// (cameras, nothing is shown), kLimitExceeded (the time limit), kCancelled, kWriteFailed.
Result<MethodsResult> RunMethods(const ImportedModel& imported, const RunOptions& options,
                                 const std::string& directory, const RunContext& context);

}  // namespace facetless

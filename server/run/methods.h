// `facetless methods`: lists the methods by name, and measures what each costs and gets wrong on a file.
//
//  1. The list has the name, the source, what the method does and what it does not promise. It has the methods that
//     intersect rays with exact surfaces, and also those with a number, which are other representations.
//  2. On a file, each view is traced by each method on one thread, and judged by the certified image of the same camera
//     (bench/method_bench.h).
//  3. With a directory, VIEW.certified.png is the certified picture, VIEW.NAME.png is the same picture in grey with the
//     errors of a method marked, and methods.json has all figures. NAME has the starts, too, where there are several:
//     newton-cramer-map.
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

// Measures the methods of options.trade.methods; if it is empty, all that intersect rays with exact surfaces. `directory`
// may be empty: then nothing is written. Errors: kBadUsage (cameras, nothing is shown), kLimitExceeded (the time limit),
// kCancelled, kWriteFailed.
Result<MethodsResult> RunMethods(const ImportedModel& imported, const RunOptions& options,
                                 const std::string& directory, const RunContext& context);

}  // namespace facetless

// Moves the files of a run into the store, and makes the answer that links to them.
#pragma once

#include <string>

#include "render/base/result.h"
#include "server/run/run_result.h"
#include "server/service/store/store.h"

namespace facetless {

// Moves the files of a run, which lie in `directory`, into the store, and puts the report with their addresses
// ("links") as the owner's answer `key`. Errors: kWriteFailed.
Result<void> PublishRun(Store& store, const std::string& owner, const std::string& key,
                        const std::string& model_id, RunResult result, const std::string& directory);

}  // namespace facetless

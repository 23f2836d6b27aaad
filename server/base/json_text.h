// JSON that people write: requests, manifests, cameras.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "render/base/result.h"

namespace facetless {

// The value that `text` is. `what` names the text in errors: "the part \"options\"". Errors: kBadUsage (no
// JSON: the message has line, column and what was expected there; a name that an object has twice).
Result<nlohmann::json> ParseJsonText(const std::string& text, const std::string& what,
                                     bool ignore_comments = false);

}  // namespace facetless

// Parsing JSON that users write: requests, manifests and cameras.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "render/base/result.h"

namespace facetless {

// Parses `text`. `what` names the text in error messages, as in "the part \"options\"". Errors: kBadUsage
// (the text is not valid JSON, and the message states line, column and reason; or an object has a name
// twice).
Result<nlohmann::json> ParseJsonText(const std::string& text, const std::string& what,
                                     bool ignore_comments = false);

}  // namespace facetless

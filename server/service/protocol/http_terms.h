// Sentences that were made for the command line, in the terms of HTTP.
#pragma once

#include <string>

namespace facetless {

// `sentence` with the names of options as a request gives them: "--mesh-unit" becomes "mesh_unit". An option
// that is the operator's keeps its name, and the sentence says whose it is.
std::string InHttpTerms(const std::string& sentence);

}  // namespace facetless

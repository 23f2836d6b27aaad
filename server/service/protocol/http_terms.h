// Sentences that were made for the command line, in the terms of HTTP.
#pragma once

#include <string>
#include <string_view>

namespace facetless {

// Whether a request over HTTP may give the option `name` ("mesh_unit"). What concerns the machine is the
// operator's: threads, memory, and how long something may take.
bool IsRequestOption(std::string_view name);

// `sentence` with the names of options as a request gives them: "--mesh-unit" becomes "mesh_unit". An option
// that is the operator's keeps its name, and the sentence says whose it is.
std::string InHttpTerms(const std::string& sentence);

}  // namespace facetless

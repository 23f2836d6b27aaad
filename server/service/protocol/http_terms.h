// Conversion of error sentences for the command line to the terms of HTTP requests.
#pragma once

#include <string>

namespace facetless {

// The sentence with the names of options as in requests: "--mesh-unit" becomes "mesh_unit". An option of the
// operator keeps its name, and the sentence states that the operator sets it.
std::string TranslateToHttpTerms(const std::string& sentence);

}  // namespace facetless

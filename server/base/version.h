// Which program this is: the "facetless" object of every report.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace facetless {

// "0.1.0"
std::string Version();

// {"version", "build", "isa", "threads"}: build names compiler and build type; isa is what the kernels run
// on; threads what is used when `threads` is 0.
nlohmann::json ProgramJson(int threads);

}  // namespace facetless

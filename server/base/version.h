// The version and the build of the program, for the object "facetless" of every report.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace facetless {

// The version, such as "0.1.0".
std::string Version();

// The object {"version", "build", "isa", "threads"}. "build" names the compiler and the build type, "isa" the
// instruction set of the kernels, and "threads" the number of threads in use (one per core if `threads` is
// 0).
nlohmann::json ProgramJson(int threads);

}  // namespace facetless

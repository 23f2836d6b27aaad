// Finds the files that tests read. ctest sets their folders in the environment (tests/CMakeLists.txt). An
// executable that is started by hand uses the folders beside its sources.
#pragma once

#include <filesystem>
#include <string>

namespace facetless {

std::filesystem::path SourceRoot();

// Returns the path of a file in the project's own samples/.
std::string Sample(const std::string& name);

// Returns the path of a file or folder among the real CAD files, such as "parts/fuse.igs". Returns "" if it
// is absent; the test then names what it skips.
std::string CadFile(const std::string& name);

}  // namespace facetless

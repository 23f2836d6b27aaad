// Where the files are that tests read. ctest says it in the environment (tests/CMakeLists.txt); an executable
// started by hand looks beside its sources.
#pragma once

#include <filesystem>
#include <string>

namespace facetless {

std::filesystem::path SourceRoot();

// A file of the project's own samples/.
std::string Sample(const std::string& name);

// A file or folder among the real CAD files: "parts/fuse.igs"; "" where they are absent, and a test says by
// name what it skips.
std::string CadFile(const std::string& name);

}  // namespace facetless

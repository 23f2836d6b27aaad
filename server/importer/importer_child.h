// The child process that reads a file for RunImporter and for ReadPlainly: its program, and what it may reach and
// use up (import_process.h, law 1).
#pragma once

#include <string>
#include <vector>

#include "server/importer/child_process.h"
#include "server/importer/import_process.h"

namespace facetless {

// Returns the path of the program with this name beside the running binary.
std::string ProgramBesideThis(const char* name);

// Returns the path of the importer.
std::string ImporterPath();

// Returns the environment of the importer. It names only the resources and the shared libraries of OpenCASCADE.
std::vector<std::string> ImporterEnvironment();

// Checks that there is a regular file that this process may read. Error: kFileUnreadable.
Result<void> CheckInput(const std::string& path);

// Sets what a child that reads the file of `request` may reach and use up. Its program and its arguments, the
// file first, are set already; its directory is `directory`. Error: kInternal (the system-call filter).
Result<void> Confine(const ImportRequest& request, const TempDir& directory, ChildRequest& child);

}  // namespace facetless

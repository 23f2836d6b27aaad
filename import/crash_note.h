// What the importer is at, in a file that outlives it: should it die, whoever started it can say which entity was the last.
#pragma once

#include <string>

namespace facetless {

// Makes the file `entity` in `folder`; without it NoteEntity does nothing.
void OpenCrashNote(const std::string& folder);

// "#12", "D7": costs a copy of a few bytes in memory.
void NoteEntity(const std::string& entity);

}  // namespace facetless

// A file in which the importer notes the entity that it is reading. If the importer dies, its caller can name
// the last entity.
#pragma once

#include <string>

namespace facetless {

// Makes the file `entity` in `folder`; without it NoteEntity does nothing.
void OpenCrashNote(const std::string& folder);

// Notes that the importer is at `entity` ("#12", "D7"). This costs a copy of a few bytes in memory.
void NoteEntity(const std::string& entity);

}  // namespace facetless

// A file in which the importer notes the entity that it is reading. If the importer dies, its caller can name
// the last entity.
#pragma once

#include <string>

namespace facetless {

// Creates the file `entity` in `folder`. Without this call, NoteEntity does nothing.
void OpenCrashNote(const std::string& folder);

// Records that the importer is reading `entity` ("#12", "D7"). A call copies only a few bytes in memory.
void NoteEntity(const std::string& entity);

}  // namespace facetless

#include "import/crash_note.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

namespace facetless {
namespace {

constexpr std::size_t kNoteBytes = 32;
char* note = nullptr;

}  // namespace

void OpenCrashNote(const std::string& folder) {
  const int descriptor = open((folder + "/entity").c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (descriptor < 0) return;
  if (ftruncate(descriptor, kNoteBytes) == 0) {
    void* mapped = mmap(nullptr, kNoteBytes, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
    if (mapped != MAP_FAILED) note = static_cast<char*>(mapped);
  }
  close(descriptor);
}

void NoteEntity(const std::string& entity) {
  if (note == nullptr) return;
  std::memset(note, 0, kNoteBytes);
  std::memcpy(note, entity.data(), std::min(entity.size(), kNoteBytes - 1));
}

}  // namespace facetless

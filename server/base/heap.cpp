#include "server/base/heap.h"

#include <cstdlib>  // says whether the C library is glibc

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace facetless {

void BoundHeap() {
#if defined(__GLIBC__)
  // Threads of the renderer allocate by the leaf, not by the ray: a few arenas serve them all.
  constexpr int kArenas = 4;
  mallopt(M_ARENA_MAX, kArenas);
  // From here on a buffer is a mapping of its own, which goes back when it is freed. Without this line the
  // allocator raises the bound to what was freed last, and pictures stay in the heap.
  constexpr int kOwnMapping = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, kOwnMapping);
#endif
}

void GiveBackHeap() {
#if defined(__GLIBC__)
  malloc_trim(0);
#endif
}

}  // namespace facetless

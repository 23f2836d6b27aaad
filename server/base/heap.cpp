#include "server/base/heap.h"

#include <cstdlib>  // defines __GLIBC__ if the C library is glibc

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace facetless {

void LimitHeapArenas() {
#if defined(__GLIBC__)
  // The threads of the renderer allocate per leaf, not per ray, so a few arenas are sufficient.
  constexpr int kArenas = 4;
  mallopt(M_ARENA_MAX, kArenas);
  // Larger buffers are separate mappings, which are returned to the system when they are freed. Without this
  // call, the allocator raises the threshold to the size of freed buffers, and pictures stay in the heap.
  constexpr int kOwnMapping = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, kOwnMapping);
#endif
}

void ReleaseFreeMemory() {
#if defined(__GLIBC__)
  malloc_trim(0);
#endif
}

}  // namespace facetless

// Control of the memory that the service's process holds between jobs.
//
// The C library's allocator keeps freed memory: up to one arena per thread, each with the size of its peak
// use. A service that runs for months must return that memory to the system.
#pragma once

namespace facetless {

// Bounds the number of arenas, so that threads reuse each other's freed memory. Call it before threads are
// started.
void LimitHeapArenas();

// Returns free memory to the system. This takes some milliseconds, so the service calls it between jobs.
void ReleaseFreeMemory();

}  // namespace facetless

// What the service's process holds of the machine's memory between jobs.
//
// The C library's allocator keeps what was freed: up to an arena for each thread, each as large as its
// fullest moment. A service that stands for months gives it back.
#pragma once

namespace facetless {

// Bounds the number of arenas, so that what one thread freed serves the next one. To be called before threads
// are started.
void BoundHeap();

// Returns what is free to the system. It takes milliseconds, so it is called between jobs.
void GiveBackHeap();

}  // namespace facetless

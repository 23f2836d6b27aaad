// Counts what a thread allocates with `new`, for the tests of this folder.
#pragma once

#include <cstddef>

namespace facetless::testing {

// The number of calls of `new` by this thread so far; 0 if a sanitizer is built in (tests/support/sanitized.h).
std::size_t CountAllocations();

}  // namespace facetless::testing

// Says whether a sanitizer is built in, which needs additional memory and time.
#pragma once

namespace facetless {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace facetless

// Whether a sanitizer is built in: it takes memory and time of its own.
#pragma once

namespace facetless {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace facetless

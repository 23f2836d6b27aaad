// W3C Trace Context, as far as a log needs it: https://www.w3.org/TR/trace-context/
#pragma once

#include <string>

namespace facetless {

// The trace id of a traceparent header, 32 hexadecimal digits; "" for one that is not well-formed, which the
// standard wants ignored.
std::string TraceIdOf(const std::string& traceparent);

}  // namespace facetless

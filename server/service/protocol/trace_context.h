// The part of W3C Trace Context that the log needs: https://www.w3.org/TR/trace-context/
#pragma once

#include <string>

namespace facetless {

// The trace id of a traceparent header, 32 hexadecimal digits; "" for a malformed header, which the standard
// requires to be ignored.
std::string ParseTraceId(const std::string& traceparent);

}  // namespace facetless

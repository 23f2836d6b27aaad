#include "server/service/protocol/trace_context.h"

#include <algorithm>

namespace facetless {
namespace {

// Returns whether the text consists of lower-case hexadecimal digits, which the standard requires.
bool IsHex(const std::string& text) {
  return std::all_of(text.begin(), text.end(),
                     [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

bool IsZero(const std::string& text) {
  return text.find_first_not_of('0') == std::string::npos;
}

}  // namespace

std::string ParseTraceId(const std::string& traceparent) {
  // The format is version "-" trace-id "-" parent-id "-" flags.
  constexpr std::size_t kVersion = 2, kTrace = 32, kParent = 16, kFlags = 2;
  constexpr std::size_t kLength = kVersion + 1 + kTrace + 1 + kParent + 1 + kFlags;
  if (traceparent.size() < kLength) return "";
  const std::string version = traceparent.substr(0, kVersion);
  const std::string trace = traceparent.substr(kVersion + 1, kTrace);
  const std::string parent = traceparent.substr(kVersion + kTrace + 2, kParent);
  const std::string flags = traceparent.substr(kLength - kFlags, kFlags);
  for (const std::size_t dash : {kVersion, kVersion + 1 + kTrace, kLength - kFlags - 1}) {
    if (traceparent[dash] != '-') return "";
  }
  for (const std::string& part : {version, trace, parent, flags}) {
    if (!IsHex(part)) return "";
  }
  if (version == "ff" || IsZero(trace) || IsZero(parent)) return "";
  // Later versions may have more fields after another dash.
  if (traceparent.size() > kLength && (version == "00" || traceparent[kLength] != '-')) return "";
  return trace;
}

}  // namespace facetless

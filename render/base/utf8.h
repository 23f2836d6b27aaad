// Texts from files and people: UTF-8, its characters, and what of it may be shown.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace facetless {

inline constexpr std::uint32_t kReplacementCharacter = 0xfffd, kLastCharacter = 0x10ffff;

// Halves of pairs of UTF-16, which are no characters.
inline bool IsSurrogate(std::uint32_t code) {
  return code >= 0xd800 && code < 0xe000;
}

// Characters that a terminal, a log or a page would obey instead of showing.
inline bool IsControlCharacter(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7f && code < 0xa0);
}

// Requires a character: at most kLastCharacter, no surrogate.
void AppendUtf8(std::uint32_t code, std::string& out);

// The characters of a UTF-8 text; none if it is no UTF-8 (overlong forms and surrogates are not).
std::optional<std::u32string> DecodeUtf8(std::string_view text);

// The text in UTF-8 without any control character: each becomes U+FFFD. Bytes that are no UTF-8 are taken as
// ISO 8859-1. Whatever comes from a file or a request passes through here on its way to a terminal.
std::string Printable(std::string_view text);

}  // namespace facetless

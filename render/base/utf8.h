// UTF-8 text from files and users: encoding, decoding, and removing characters that are unsafe to display.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace facetless {

inline constexpr std::uint32_t kReplacementCharacter = 0xfffd, kLastCharacter = 0x10ffff;

// Returns whether the code is a UTF-16 surrogate, which is not a character.
inline bool IsSurrogate(std::uint32_t code) {
  return code >= 0xd800 && code < 0xe000;
}

// Returns whether the character is a control character, which a terminal or a log may act on instead of
// displaying.
inline bool IsControlCharacter(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7f && code < 0xa0);
}

// Appends one character. Requires code ≤ kLastCharacter, and not a surrogate.
void AppendUtf8(std::uint32_t code, std::string& out);

// The characters of a UTF-8 text; nothing if the text is not valid UTF-8. Overlong forms and surrogates are
// invalid.
std::optional<std::u32string> DecodeUtf8(std::string_view text);

// The text in UTF-8, with every control character replaced by U+FFFD. Text that is not valid UTF-8 is read as
// ISO 8859-1. All text from files and requests must pass through this function before it reaches a terminal.
std::string Printable(std::string_view text);

}  // namespace facetless

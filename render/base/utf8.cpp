#include "render/base/utf8.h"

namespace facetless {

void AppendUtf8(std::uint32_t code, std::string& out) {
  if (code < 0x80) {
    out += static_cast<char>(code);
  } else if (code < 0x800) {
    out += static_cast<char>(0xc0 | code >> 6);
    out += static_cast<char>(0x80 | (code & 0x3f));
  } else if (code < 0x10000) {
    out += static_cast<char>(0xe0 | code >> 12);
    out += static_cast<char>(0x80 | (code >> 6 & 0x3f));
    out += static_cast<char>(0x80 | (code & 0x3f));
  } else {
    out += static_cast<char>(0xf0 | code >> 18);
    out += static_cast<char>(0x80 | (code >> 12 & 0x3f));
    out += static_cast<char>(0x80 | (code >> 6 & 0x3f));
    out += static_cast<char>(0x80 | (code & 0x3f));
  }
}

std::optional<std::u32string> DecodeUtf8(std::string_view text) {
  std::u32string codes;
  codes.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const auto lead = static_cast<unsigned char>(text[at++]);
    if (lead < 0x80) {
      codes += lead;
      continue;
    }
    const int rest = lead >= 0xf0 ? 3 : lead >= 0xe0 ? 2 : 1;
    if (lead < 0xc2 || lead > 0xf4 || at + static_cast<std::size_t>(rest) > text.size()) return std::nullopt;
    std::uint32_t code = lead & (0x3fu >> rest);
    for (int i = 0; i < rest; ++i) {
      const auto next = static_cast<unsigned char>(text[at++]);
      if ((next & 0xc0) != 0x80) return std::nullopt;
      code = code << 6 | (next & 0x3f);
    }
    constexpr std::uint32_t kLeast[] = {0, 0x80, 0x800, 0x10000};
    if (code < kLeast[rest] || code > kLastCharacter || IsSurrogate(code)) return std::nullopt;
    codes += code;
  }
  return codes;
}

std::string Printable(std::string_view text) {
  std::string out;
  if (const std::optional<std::u32string> codes = DecodeUtf8(text)) {
    for (const char32_t code : *codes)
      AppendUtf8(IsControlCharacter(code) ? kReplacementCharacter : code, out);
    return out;
  }
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    AppendUtf8(IsControlCharacter(code) ? kReplacementCharacter : code, out);
  }
  return out;
}

}  // namespace facetless

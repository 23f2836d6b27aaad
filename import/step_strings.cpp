#include "import/step_strings.h"

#include <Resource_Unicode.hxx>
#include <TCollection_ExtendedString.hxx>
#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdio>
#include <optional>

#include "render/base/utf8.h"

namespace facetless {
namespace {

std::u32string FromLatin1(std::string_view text) {
  std::u32string codes;
  for (const char c : text) codes += static_cast<unsigned char>(c);
  return codes;
}

std::u32string FromCodePage(Resource_FormatType page, std::string_view text) {
  TCollection_ExtendedString wide;
  Resource_Unicode::ConvertFormatToUnicode(page, std::string(text).c_str(), wide);
  std::u32string codes;
  for (int i = 1; i <= wide.Length(); ++i) codes += static_cast<std::uint32_t>(wide.Value(i));
  return codes;
}

// Guesses the code page from texts with double-byte characters.
class PageGuess {
 public:
  // Adds a text that is not UTF-8.
  void Add(std::string_view text) {
    ++texts_;
    std::size_t kana = 0, run = 0, longest = 0;
    bool shift_jis = true, gbk = true;
    for (std::size_t at = 0; at < text.size();) {
      const auto lead = static_cast<unsigned char>(text[at]);
      const auto trail = static_cast<unsigned char>(at + 1 < text.size() ? text[at + 1] : 0);
      if (lead < 0x80) {
        run = 0;
        ++at;
        continue;
      }
      const bool sjis_pair = ((lead >= 0x81 && lead < 0xa0) || (lead >= 0xe0 && lead < 0xf0)) &&
                             trail >= 0x40 && trail != 0x7f && trail < 0xfd;
      const bool half_width = lead >= 0xa1 && lead < 0xe0;
      const bool gb_pair = lead >= 0xa1 && lead < 0xf8 && trail >= 0xa1 && trail < 0xff;
      shift_jis = shift_jis && (sjis_pair || half_width);
      gbk = gbk && gb_pair;
      kana += sjis_pair && ((lead == 0x82 && trail >= 0x9f) || lead == 0x83);
      longest = std::max(longest, ++run);
      at += sjis_pair || gb_pair ? 2 : 1;
    }
    shift_jis_ += shift_jis;
    gbk_ += gbk;
    kana_ += kana;
    longest_ = std::max(longest_, longest);
  }

  std::size_t texts() const { return texts_; }
  bool IsShiftJis() const { return texts_ > 0 && shift_jis_ == texts_ && kana_ > 0; }
  // In ISO 8859-1, two non-ASCII letters may stand side by side, but hardly four.
  bool IsGbk() const { return texts_ > 0 && gbk_ == texts_ && longest_ >= 2; }

 private:
  std::size_t texts_ = 0, shift_jis_ = 0, gbk_ = 0, kana_ = 0, longest_ = 0;
};

// Parses `digits` hexadecimal digits at `at`; returns nothing if there are none.
std::optional<std::uint32_t> Hex(std::u32string_view text, std::size_t at, std::size_t digits) {
  if (at + digits > text.size()) return std::nullopt;
  std::uint32_t value = 0;
  for (std::size_t i = at; i < at + digits; ++i) {
    if (text[i] > 0x7f || !std::isxdigit(static_cast<int>(text[i]))) return std::nullopt;
    const auto c = static_cast<int>(text[i]);
    value = value * 16 + static_cast<std::uint32_t>(std::isdigit(c) ? c - '0' : std::toupper(c) - 'A' + 10);
  }
  return value;
}

// A text with its directives decoded, and the problems that were found in it.
struct Decoded {
  std::u32string codes;
  bool broken = false;
};

// Decodes the codes of \X2\ or \X4\, each `digits` wide, that begin at `at`. If \X0\ does not end them, it
// returns false and consumes nothing.
bool TakeCodes(std::u32string_view raw, std::size_t* at, std::size_t digits, std::u32string& out) {
  std::u32string taken;
  std::size_t next = *at;
  std::uint32_t high = 0;
  for (std::optional<std::uint32_t> code; (code = Hex(raw, next, digits)); next += digits) {
    if (digits == 4 && *code >= 0xd800 && *code < 0xdc00) {
      if (high != 0) taken += kReplacementCharacter;
      high = *code;
      continue;
    }
    if (digits == 4 && high != 0 && *code >= 0xdc00 && *code < 0xe000) {
      taken += 0x10000 + ((high - 0xd800) << 10) + (*code - 0xdc00);
    } else {
      if (high != 0) taken += kReplacementCharacter;
      taken += IsSurrogate(*code) || *code > kLastCharacter ? kReplacementCharacter : *code;
    }
    high = 0;
  }
  if (high != 0) taken += kReplacementCharacter;
  if (raw.substr(next, 4) != U"\\X0\\") return false;
  out += taken;
  *at = next + 4;
  return true;
}

Decoded DecodeDirectives(std::u32string_view raw) {
  Decoded decoded;
  std::u32string& out = decoded.codes;
  Resource_FormatType page = Resource_FormatType_iso8859_1;
  for (std::size_t at = 0; at < raw.size();) {
    if (raw[at] != '\\') {
      out += raw[at++];
      continue;
    }
    const std::u32string_view directive = raw.substr(at, 4);
    std::size_t next = at + 4;
    if (directive.starts_with(U"\\\\")) {
      out += '\\';
      at += 2;
    } else if ((directive == U"\\X2\\" && TakeCodes(raw, &next, 4, out)) ||
               (directive == U"\\X4\\" && TakeCodes(raw, &next, 8, out))) {
      at = next;
    } else if (const auto code = directive.starts_with(U"\\X\\") ? Hex(raw, at + 3, 2) : std::nullopt; code) {
      out += *code;
      at += 5;
    } else if (directive.starts_with(U"\\S\\") && directive.size() == 4 && directive[3] >= 0x20 &&
               directive[3] < 0x7f) {
      const char byte = static_cast<char>(directive[3] | 0x80u);
      out += page == Resource_FormatType_iso8859_1 ? FromLatin1({&byte, 1}) : FromCodePage(page, {&byte, 1});
      at += 4;
    } else if (directive.size() == 4 && directive[1] == 'P' && directive[2] >= 'A' && directive[2] <= 'I' &&
               directive[3] == '\\') {
      page = static_cast<Resource_FormatType>(Resource_FormatType_iso8859_1 +
                                              static_cast<int>(directive[2] - 'A'));
      at += 4;
    } else {
      decoded.broken = true;
      out += raw[at++];
    }
  }
  return decoded;
}

std::u32string WithoutLineEnds(std::u32string text) {
  std::erase_if(text, [](char32_t c) { return c == '\n' || c == '\r'; });
  return text;
}

// Encodes the inside of a text as ISO 10303-21 defines it.
std::string Encode(const std::u32string& codes) {
  std::string out;
  char digits[16];
  int width = 0;  // width of the codes in the open directive
  const auto close = [&] {
    if (width != 0) out += "\\X0\\";
    width = 0;
  };
  for (const char32_t code : codes) {
    if (code < 0x80) {
      close();
      out += static_cast<char>(code);
      if (code == '\\' || code == '\'') out += static_cast<char>(code);
      continue;
    }
    const int needed = code < 0x10000 ? 4 : 8;
    if (width != needed) {
      close();
      out += needed == 4 ? "\\X2\\" : "\\X4\\";
      width = needed;
    }
    std::snprintf(digits, sizeof digits, "%0*X", needed, static_cast<unsigned>(code));
    out += digits;
  }
  close();
  return out;
}

// Calls visit(begin, end) with the inside of each text outside comments. It stops at a text without an end.
template <typename Visit>
void ForEachText(std::string_view bytes, const Visit& visit) {
  std::size_t at = 0;
  while ((at = bytes.find_first_of("'/", at)) != std::string_view::npos) {
    if (bytes[at] == '/') {
      if (bytes.substr(at, 2) != "/*") {
        ++at;
        continue;
      }
      const std::size_t end = bytes.find("*/", at + 2);
      if (end == std::string_view::npos) return;
      at = end + 2;
      continue;
    }
    const std::size_t begin = at + 1;
    std::size_t end = bytes.find('\'', begin);
    while (end != std::string_view::npos && end + 1 < bytes.size() && bytes[end + 1] == '\'')
      end = bytes.find('\'', end + 2);
    if (end == std::string_view::npos) return;
    visit(begin, end);
    at = end + 1;
  }
}

std::string Unquoted(std::string_view raw) {
  std::string text;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    text += raw[i];
    if (raw[i] == '\'') ++i;  // the second apostrophe of two
  }
  return text;
}

bool IsPlain(std::string_view text) {
  return std::none_of(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte >= 0x7f || c == '\\';
  });
}

// Returns "#12" for the entity that contains a position of the file, or "the header".
std::string EntityAt(std::string_view bytes, std::size_t at) {
  std::size_t begin = bytes.rfind(';', at);
  begin = begin == std::string_view::npos ? 0 : begin + 1;
  while (begin < at && std::isspace(static_cast<unsigned char>(bytes[begin]))) ++begin;
  std::size_t end = begin + 1;
  while (end < at && std::isdigit(static_cast<unsigned char>(bytes[end]))) ++end;
  return bytes[begin] == '#' && end > begin + 1 ? std::string(bytes.substr(begin, end - begin))
                                                : "the header";
}

// A kind of finding: the number of texts, and where the first one is.
struct Finding {
  std::size_t count = 0;
  std::string first;
  void Add(std::string_view bytes, std::size_t at) {
    if (count++ == 0) first = EntityAt(bytes, at);
  }
  std::string Texts() const {
    return count == 1 ? "The text of " + first
                      : std::to_string(count) + " texts (the first in " + first + ")";
  }
};

}  // namespace

bool NormaliseStepTexts(std::string& bytes, std::vector<std::string>* warnings) {
  // Determine the code page of the texts that are not UTF-8.
  PageGuess guess;
  ForEachText(bytes, [&](std::size_t begin, std::size_t end) {
    const std::string_view raw(bytes.data() + begin, end - begin);
    if (!IsPlain(raw) && !DecodeUtf8(raw)) guess.Add(raw);
  });

  // Write the texts again.
  std::string out;
  std::size_t copied = 0;
  bool changed = false;
  Finding guessed, replaced, broken;
  ForEachText(bytes, [&](std::size_t begin, std::size_t end) {
    const std::string_view raw(bytes.data() + begin, end - begin);
    if (IsPlain(raw)) return;
    const std::string text = Unquoted(raw);
    std::optional<std::u32string> codes = DecodeUtf8(text);
    if (!codes) {
      guessed.Add(bytes, begin);
      codes = guess.IsShiftJis() ? FromCodePage(Resource_FormatType_SJIS, text)
              : guess.IsGbk()    ? FromCodePage(Resource_FormatType_GBK, text)
                                 : FromLatin1(text);
    }
    Decoded decoded = DecodeDirectives(WithoutLineEnds(std::move(*codes)));
    if (decoded.broken) broken.Add(bytes, begin);
    bool controls = false;
    for (char32_t& code : decoded.codes) {
      if (code == '\t') code = ' ';
      if (!IsControlCharacter(code)) continue;
      code = kReplacementCharacter;
      controls = true;
    }
    if (controls) replaced.Add(bytes, begin);
    const std::string written = Encode(decoded.codes);
    if (written == raw) return;
    out.append(bytes, copied, begin - copied);
    out += written;
    copied = end;
    changed = true;
  });
  if (guessed.count > 0) {
    const char* page = guess.IsShiftJis() ? "Shift-JIS" : guess.IsGbk() ? "GBK" : "ISO 8859-1";
    warnings->push_back(guessed.Texts() + " is not UTF-8, and was read as " + page + ".");
  }
  if (replaced.count > 0)
    warnings->push_back(replaced.Texts() + " has control characters, which were replaced by U+FFFD.");
  if (broken.count > 0)
    warnings->push_back(broken.Texts() +
                        " has a control directive (\\X2\\, \\X4\\, \\X\\ or \\S\\) that is broken; it stays "
                        "as it is written.");
  if (!changed) return false;
  out.append(bytes, copied, std::string::npos);
  bytes = std::move(out);
  return true;
}

std::string DecodeStepText(std::string_view raw) {
  std::optional<std::u32string> codes = DecodeUtf8(raw);
  const Decoded decoded = DecodeDirectives(WithoutLineEnds(codes ? std::move(*codes) : FromLatin1(raw)));
  std::string out;
  for (const char32_t code : decoded.codes)
    AppendUtf8(code == '\t' ? U' ' : IsControlCharacter(code) ? kReplacementCharacter : code, out);
  const std::size_t first = out.find_first_not_of(' ');
  if (first == std::string::npos) return {};
  out = out.substr(first, out.find_last_not_of(' ') - first + 1);
  return out == "NONE" || out == "$" ? std::string() : out;
}

}  // namespace facetless

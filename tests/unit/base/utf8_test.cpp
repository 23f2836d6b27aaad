// UTF-8, and which characters may be shown.
#include "render/base/utf8.h"

#include <gtest/gtest.h>

namespace facetless {
namespace {

TEST(Utf8, EveryCharacterComesBack) {
  for (std::uint32_t code = 1; code <= kLastCharacter; code += code < 0x900 ? 1 : 251) {
    if (IsSurrogate(code)) continue;
    std::string text;
    AppendUtf8(code, text);
    const auto decoded = DecodeUtf8(text);
    ASSERT_TRUE(decoded.has_value()) << code;
    ASSERT_EQ(decoded->size(), 1u) << code;
    EXPECT_EQ((*decoded)[0], code);
  }
}

TEST(Utf8, WhatIsNoneIsRefused) {
  for (const char* text :
       {"\xe4", "a\x80", "\xc0\x80", "\xe0\x80\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xf5", "\xe2\x82"})
    EXPECT_FALSE(DecodeUtf8(text).has_value()) << text;
}

TEST(Printable, NoControlCharacterIsLeft) {
  EXPECT_EQ(Printable("plain Gehäuse"), "plain Gehäuse");
  EXPECT_EQ(Printable("a\x1b[31mb\a"), "a\xef\xbf\xbd[31mb\xef\xbf\xbd");
  EXPECT_EQ(Printable("Geh\xe4use"), "Gehäuse");
  EXPECT_EQ(Printable("\xc2\x9b"), "\xef\xbf\xbd");  // CSI as one character
  EXPECT_EQ(Printable("\x9b\xff"), "\xef\xbf\xbdÿ");
}

}  // namespace
}  // namespace facetless

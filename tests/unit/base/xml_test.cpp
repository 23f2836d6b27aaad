#include "render/base/xml.h"

#include <gtest/gtest.h>

namespace facetless {
namespace {

TEST(EscapedXml, LeavesNothingThatEndsAnElementOrAnAttribute) {
  EXPECT_EQ(EscapedXml("a <b> & \"c\" 'd'"), "a &lt;b> &amp; &quot;c&quot; 'd'");
  EXPECT_EQ(EscapedXml("&lt;"), "&amp;lt;");
  EXPECT_EQ(EscapedXml("größer"), "größer");
  EXPECT_EQ(EscapedXml(""), "");
}

}  // namespace
}  // namespace facetless

// Texts in XML: SVG pictures and 3MF files.
#pragma once

#include <string>

namespace facetless {

// Escapes a text for the content of an element or for an attribute in double quotes.
std::string EscapedXml(const std::string& text);

}  // namespace facetless

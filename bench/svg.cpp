#include "bench/svg.h"

#include <cstdio>

#include "render/base/xml.h"

namespace facetless {

std::string SvgNumber(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

std::string SvgText(double x, double y, const char* anchor, int size, const std::string& text,
                    const char* extra) {
  return "<text x=\"" + SvgNumber(x) + "\" y=\"" + SvgNumber(y) + "\" text-anchor=\"" + anchor +
         "\" font-size=\"" + std::to_string(size) + "\"" + extra + ">" + EscapedXml(text) + "</text>\n";
}

std::string SvgBox(double x, double y, double width, double height, const char* color) {
  return "<rect x=\"" + SvgNumber(x) + "\" y=\"" + SvgNumber(y) + "\" width=\"" + SvgNumber(width) +
         "\" height=\"" + SvgNumber(height) + "\" fill=\"" + color + "\"/>\n";
}

std::string SvgPicture(double width, double height, const std::string& title, const std::string& content) {
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + SvgNumber(width) + "\" height=\"" +
         SvgNumber(height) + "\" viewBox=\"0 0 " + SvgNumber(width) + " " + SvgNumber(height) +
         "\" font-family=\"sans-serif\" fill=\"#1f2428\">\n" + SvgBox(0, 0, width, height, "#ffffff") +
         SvgText(24, 34, "start", 18, title, " font-weight=\"bold\"") + content + "</svg>\n";
}

}  // namespace facetless

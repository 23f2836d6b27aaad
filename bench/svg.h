// The elements of which the bench's plots are made.
#pragma once

#include <string>

namespace facetless {

// Returns a coordinate with one digit behind the point.
std::string SvgNumber(double value);

// Returns a text at (x, y). `anchor` is "start", "middle" or "end"; `extra` has further attributes and begins with
// a blank.
std::string SvgText(double x, double y, const char* anchor, int size, const std::string& text,
                    const char* extra = "");

// Returns a filled rectangle.
std::string SvgBox(double x, double y, double width, double height, const char* color);

// Returns a white picture of this size with the title and `content`, whose origin is the upper left corner.
std::string SvgPicture(double width, double height, const std::string& title, const std::string& content);

}  // namespace facetless

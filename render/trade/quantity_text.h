// Numbers for sentences and axes: two significant digits, with the unit that fits.
#pragma once

#include <string>

namespace facetless {

// "0", "0.031", "340", "4e-5"; "infinitely many" for what is no number.
std::string NumberText(double number);

std::string MillimetresText(double mm);  // "0.031 mm"
std::string TimeText(double ms);         // "340 ms", "1.8 s"
std::string MemoryText(double bytes);    // "56 MB", "1.2 GB"

}  // namespace facetless

// Numbers in sentences and on axes, with two significant digits and a suitable unit.
#pragma once

#include <string>

namespace facetless {

// A number such as "0", "0.031", "340" or "4e-5"; "infinitely many" if it is not finite.
std::string NumberText(double number);

std::string MillimetresText(double mm);  // "0.031 mm"
std::string TimeText(double ms);         // "340 ms", "1.8 s"
std::string MemoryText(double bytes);    // "56 MB", "1.2 GB"

}  // namespace facetless

// The natural order of file names: slice_2.png comes before slice_10.png.
#pragma once

#include <span>
#include <string>

namespace facetless {

// Compares texts, in which each run of digits is one number.
bool NaturallyBefore(const std::string& a, const std::string& b);

// The first name that is missing among names in natural order which differ in nothing but one number, such as slice_3.png
// between slice_2.png and slice_4.png. "" if none is missing, or if the names differ in more.
std::string MissingName(std::span<const std::string> names);

}  // namespace facetless

// The files of server/web, which are embedded in the program when it is built.
#pragma once

#include <string_view>

namespace facetless {

// The content of server/web/<name>; empty if there is no such file.
std::string_view WebAsset(std::string_view name);

}  // namespace facetless

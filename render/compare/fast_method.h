// The method "fast": exact surfaces, traced in single precision. Beside the reference it shows what the lower
// precision loses.
#pragma once

#include "render/compare/method.h"

namespace facetless {

Method FastMethod();

}  // namespace facetless

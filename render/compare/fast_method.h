// The method "fast": exact surfaces, traced in single precision. A comparison with the reference shows the
// effect of the lower precision.
#pragma once

#include "render/compare/method.h"

namespace facetless {

Method FastMethod();

}  // namespace facetless

// The methods of the project's own tracer (render/trace/direct.h): "certified", which proves its samples, and "fast",
// which traces in single precision. A comparison with the reference shows the effect of the lower precision.
#pragma once

#include "render/compare/method.h"

namespace facetless {

// With the accuracy of MethodInput::direct.
Method ExactMethod();
Method FastMethod();

}  // namespace facetless

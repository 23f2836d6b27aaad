// The check that all image comparisons make first. Private to render/image.
#pragma once

#include "render/base/result.h"
#include "render/image/film.h"

namespace facetless {

// Errors: kSizeMismatch (the sizes differ), kBadUsage (a picture is empty, or its bytes do not match its
// size).
Result<void> CheckSameSize(const Image8& a, const Image8& b);

}  // namespace facetless

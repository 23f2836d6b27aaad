// What every comparison checks first. Private to image/.
#pragma once

#include "render/base/result.h"
#include "render/image/film.h"

namespace facetless {

// kSizeMismatch if the sizes differ; kBadUsage if a picture is empty or its bytes don't match its size.
Result<void> CheckSameSize(const Image8& a, const Image8& b);

}  // namespace facetless

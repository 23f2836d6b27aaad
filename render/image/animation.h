// Animated pictures: WebP through libwebp and libwebpmux, one file.
//
//  1. An animation begins again for ever. Each frame is a picture of its own (no frame leans on another), so
//     nothing of what was smears.
//  2. Compressed with losses that one does not see; alpha is kept as it is. One thread: the same frames give
//     the same bytes.
//  3. Frames are compressed as they come: what is held is their compressed bytes, and one frame.
#pragma once

#include <memory>
#include <string>

#include "render/base/result.h"
#include "render/image/film.h"

namespace facetless {

// WebP's own limit, pixels.
inline constexpr int kMostAnimationSide = 16383;

class Animation {
 public:
  // Errors: kLimitExceeded (more than kMostAnimationSide pixels on a side; memory).
  static Result<Animation> Begin(int width, int height);
  ~Animation();
  Animation(Animation&&) noexcept;
  Animation& operator=(Animation&&) noexcept;

  // A frame that begins at `at_ms`, in order. Errors: kSizeMismatch, kLimitExceeded (memory), kInternal.
  Result<void> Add(const Image8& frame, int at_ms);
  // The last frame ends at `end_ms`. Errors: as Add, and kWriteFailed.
  Result<void> Write(const std::string& path, int end_ms);

 private:
  struct Encoder;
  explicit Animation(std::unique_ptr<Encoder> encoder);
  std::unique_ptr<Encoder> encoder_;
};

}  // namespace facetless

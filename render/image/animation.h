// Animated pictures: one WebP file, written with libwebp and libwebpmux.
//
//     Result<Animation> animation = Animation::Begin(width, height);
//     if (!animation) return animation.error();
//     for (int i = 0; i < count; ++i) (void)animation.value().Add(frames[i], 100 * i);
//     return animation.value().Write("turntable.webp", 100 * count);
//
//  1. An animation repeats endlessly. Each frame is complete in itself and does not depend on other frames,
//     so earlier frames leave no traces.
//  2. Compression is lossy, but without visible loss; alpha is lossless. A single thread compresses, so the
//     same frames give the same bytes.
//  3. Each frame is compressed when it is added. The memory holds the compressed frames and one uncompressed
//     frame.
#pragma once

#include <memory>
#include <string>

#include "render/base/result.h"
#include "render/image/film.h"

namespace facetless {

// The limit of the WebP format, pixels.
inline constexpr int kMostAnimationSide = 16383;

class Animation {
 public:
  // Starts an animation. Errors: kLimitExceeded (more than kMostAnimationSide pixels on a side; memory).
  static Result<Animation> Begin(int width, int height);
  ~Animation();
  Animation(Animation&&) noexcept;
  Animation& operator=(Animation&&) noexcept;

  // Adds a frame that begins at `at_ms`. Requires ascending times. Errors: kSizeMismatch, kLimitExceeded
  // (memory), kInternal.
  Result<void> Add(const Image8& frame, int at_ms);
  // Writes the file. The last frame ends at `end_ms`. Errors: the errors of Add, and kWriteFailed.
  Result<void> Write(const std::string& path, int end_ms);

 private:
  struct Encoder;
  explicit Animation(std::unique_ptr<Encoder> encoder);
  std::unique_ptr<Encoder> encoder_;
};

}  // namespace facetless

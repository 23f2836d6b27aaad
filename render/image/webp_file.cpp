// Writes animated WebP with libwebp and libwebpmux.
#include <webp/encode.h>
#include <webp/mux.h>

#include <algorithm>
#include <utility>

#include "render/image/animation.h"
#include "render/image/atomic_file.h"

namespace facetless {
namespace {

// At a lower quality, smooth shades show bands; at a higher one, files grow faster than the quality improves.
// Method 4 is the default of the library.
constexpr float kQuality = 90;
constexpr int kMethod = 4;

Error Failed(const std::string& reason) {
  return {ErrorCode::kInternal, "the animation cannot be encoded: " + reason};
}

}  // namespace

struct Animation::Encoder {
  Encoder() = default;
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;
  ~Encoder() { WebPAnimEncoderDelete(encoder); }

  int width = 0, height = 0;
  WebPConfig config;
  WebPAnimEncoder* encoder = nullptr;
};

Animation::Animation(std::unique_ptr<Encoder> encoder) : encoder_(std::move(encoder)) {}
Animation::~Animation() = default;
Animation::Animation(Animation&&) noexcept = default;
Animation& Animation::operator=(Animation&&) noexcept = default;

Result<Animation> Animation::Begin(int width, int height) {
  if (width < 1 || height < 1 || std::max(width, height) > kMostAnimationSide)
    return Error{ErrorCode::kLimitExceeded, "an animation of " + std::to_string(width) + "×" +
                                                std::to_string(height) +
                                                " pixels; 1 to 16383 on a side can be written"};
  auto encoder = std::make_unique<Encoder>();
  encoder->width = width;
  encoder->height = height;
  if (WebPConfigPreset(&encoder->config, WEBP_PRESET_PICTURE, kQuality) == 0)
    return Failed("the libwebp library has another version than its headers");
  encoder->config.method = kMethod;
  encoder->config.thread_level = 0;
  // Preserve the colour of thin lines.
  encoder->config.use_sharp_yuv = 1;
  WebPAnimEncoderOptions options;
  if (WebPAnimEncoderOptionsInit(&options) == 0)
    return Failed("the libwebp library has another version than its headers");
  options.anim_params.loop_count = 0;  // endless
  options.kmin = 0;
  options.kmax = 1;  // law 1
  encoder->encoder = WebPAnimEncoderNew(width, height, &options);
  if (encoder->encoder == nullptr)
    return Error{ErrorCode::kLimitExceeded, "the animation does not fit into memory"};
  return Animation(std::move(encoder));
}

Result<void> Animation::Add(const Image8& frame, int at_ms) {
  if (frame.width != encoder_->width || frame.height != encoder_->height ||
      (frame.channels != 3 && frame.channels != 4) ||
      frame.bytes.size() != static_cast<std::size_t>(frame.width) * frame.height * frame.channels)
    return Error{ErrorCode::kSizeMismatch, "a frame's size is not the animation's"};
  WebPPicture picture;
  if (WebPPictureInit(&picture) == 0)
    return Failed("the libwebp library has another version than its headers");
  picture.use_argb = 1;
  picture.width = frame.width;
  picture.height = frame.height;
  const int stride = frame.width * frame.channels;
  const int imported = frame.channels == 4 ? WebPPictureImportRGBA(&picture, frame.bytes.data(), stride)
                                           : WebPPictureImportRGB(&picture, frame.bytes.data(), stride);
  const bool added =
      imported != 0 && WebPAnimEncoderAdd(encoder_->encoder, &picture, at_ms, &encoder_->config) != 0;
  const WebPEncodingError code = picture.error_code;
  WebPPictureFree(&picture);
  if (added) return {};
  if (imported == 0 || code == VP8_ENC_ERROR_OUT_OF_MEMORY || code == VP8_ENC_ERROR_BITSTREAM_OUT_OF_MEMORY)
    return Error{ErrorCode::kLimitExceeded, "the animation does not fit into memory"};
  return Failed(WebPAnimEncoderGetError(encoder_->encoder));
}

Result<void> Animation::Write(const std::string& path, int end_ms) {
  WebPData data;
  WebPDataInit(&data);
  if (WebPAnimEncoderAdd(encoder_->encoder, nullptr, end_ms, nullptr) == 0 ||
      WebPAnimEncoderAssemble(encoder_->encoder, &data) == 0)
    return Failed(WebPAnimEncoderGetError(encoder_->encoder));
  Result<void> written = WriteAtomically(path, {data.bytes, data.size});
  WebPDataClear(&data);
  return written;
}

}  // namespace facetless

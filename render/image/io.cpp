#include "render/image/io.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <new>
#include <string_view>

#include "render/image/atomic_file.h"

namespace facetless {
namespace {

constexpr int kMaxPixels = 65536;

// Encodes an image in memory and writes it; `format` is an OpenImageIO plugin, `type` that of the bytes at
// `pixels`.
Result<void> WriteImage(const std::string& path, const char* format, OIIO::ImageSpec spec,
                        OIIO::TypeDesc type, const void* pixels) {
  // OpenImageIO would write today's date; this is Exif's way to say that it is unknown.
  if (std::string_view(format) != "png") spec.attribute("DateTime", "    :  :     :  :  ");
  std::vector<unsigned char> bytes;
  try {
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(format);
    if (!output) return Error{ErrorCode::kInternal, path + ": OpenImageIO lacks the format " + format};
    output->set_ioproxy(&memory);
    const bool written = output->open(path, spec) && output->write_image(type, pixels);
    if (!output->close() || !written) return Error{ErrorCode::kWriteFailed, path + ": " + output->geterror()};
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kLimitExceeded, path + ": the image does not fit into memory"};
  }
  return WriteAtomically(path, bytes);
}

Result<void> CheckSize(const std::string& path, int width, int height, std::size_t found,
                       std::size_t channels) {
  if (width < 1 || height < 1 || width > kMaxPixels || height > kMaxPixels)
    return Error{ErrorCode::kLimitExceeded, path + ": " + std::to_string(width) + "×" +
                                                std::to_string(height) +
                                                " pixels; 1 to 65536 on a side can be written"};
  if (found != static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * channels)
    return Error{ErrorCode::kSizeMismatch, path + ": the picture's size and its number of pixels disagree"};
  return {};
}

// Opens with one plugin only, so that the name's extension or a strange content can't choose another.
Result<std::unique_ptr<OIIO::ImageInput>> OpenImage(const std::string& path, const char* format) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed))
    return Error{ErrorCode::kFileUnreadable,
                 path + ": " + (failed ? failed.message() : std::string("not a file"))};
  std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::create(format);
  if (!input) return Error{ErrorCode::kInternal, path + ": OpenImageIO lacks the format " + format};
  OIIO::ImageSpec config, spec;
  config.attribute("oiio:UnassociatedAlpha", 1);
  if (!input->valid_file(path))
    return Error{ErrorCode::kFormatUnknown, path + ": is no " + std::string(format) + " image"};
  if (!input->open(path, spec, config))
    return Error{ErrorCode::kFormatBroken, path + ": " + input->geterror()};
  if (spec.width < 1 || spec.height < 1 || spec.width > kMaxPixels || spec.height > kMaxPixels ||
      spec.depth != 1)
    return Error{ErrorCode::kLimitExceeded, path + ": more than 65536 pixels on a side"};
  return input;
}

void AppendBytes(std::vector<unsigned char>& row, const void* value, std::size_t size) {
  const auto* bytes = static_cast<const unsigned char*>(value);
  row.insert(row.end(), bytes, bytes + size);
}

}  // namespace

Result<void> WritePng(const std::string& path, const Image8& image) {
  if (image.channels != 3 && image.channels != 4)
    return Error{ErrorCode::kBadUsage, path + ": a picture has 3 or 4 channels"};
  if (Result<void> size = CheckSize(path, image.width, image.height, image.bytes.size(), image.channels);
      !size.ok())
    return size;
  OIIO::ImageSpec spec(image.width, image.height, image.channels, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  spec.attribute("oiio:UnassociatedAlpha", 1);
  return WriteImage(path, "png", spec, OIIO::TypeDesc::UINT8, image.bytes.data());
}

Result<Image8> ReadPng(const std::string& path) {
  Result<std::unique_ptr<OIIO::ImageInput>> opened = OpenImage(path, "png");
  if (!opened.ok()) return opened.error();
  OIIO::ImageInput& input = *opened.value();
  const int width = input.spec().width, height = input.spec().height, channels = input.spec().nchannels;
  if (channels < 1 || channels > 4) return Error{ErrorCode::kFormatBroken, path + ": not 1 to 4 channels"};
  const std::size_t pixels = static_cast<std::size_t>(width) * height;
  std::vector<std::uint8_t> raw(pixels * channels);
  if (!input.read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, raw.data()))
    return Error{ErrorCode::kFormatBroken, path + ": " + input.geterror()};

  // Grey becomes RGB; alpha stays behind it.
  Image8 image;
  image.width = width;
  image.height = height;
  image.channels = channels % 2 == 0 ? 4 : 3;
  if (channels >= 3) {
    image.bytes = std::move(raw);
    return image;
  }
  image.bytes.reserve(pixels * image.channels);
  for (std::size_t i = 0; i < pixels; ++i) {
    image.bytes.insert(image.bytes.end(), 3, raw[i * channels]);
    if (channels == 2) image.bytes.push_back(raw[i * channels + 1]);
  }
  return image;
}

Result<void> WriteDepth(const std::string& path, int width, int height, std::span<const double> depth) {
  if (Result<void> size = CheckSize(path, width, height, depth.size(), 1); !size.ok()) return size;
  OIIO::ImageSpec spec(width, height, 1, OIIO::TypeDesc::DOUBLE);
  spec.channelnames = {"Z"};
  spec.z_channel = 0;
  spec.attribute("compression", "zip");
  return WriteImage(path, "tiff", spec, OIIO::TypeDesc::DOUBLE, depth.data());
}

Result<DepthImage> ReadDepth(const std::string& path) {
  Result<std::unique_ptr<OIIO::ImageInput>> opened = OpenImage(path, "tiff");
  if (!opened.ok()) return opened.error();
  OIIO::ImageInput& input = *opened.value();
  const OIIO::TypeDesc type = input.spec().format;
  if (input.spec().nchannels != 1 || (type != OIIO::TypeDesc::DOUBLE && type != OIIO::TypeDesc::FLOAT))
    return Error{ErrorCode::kFormatBroken, path + ": a depth image has one channel of float32 or float64"};
  DepthImage image;
  image.width = input.spec().width;
  image.height = input.spec().height;
  image.depth.resize(static_cast<std::size_t>(image.width) * image.height);
  if (!input.read_image(0, 0, 0, 1, OIIO::TypeDesc::DOUBLE, image.depth.data()))
    return Error{ErrorCode::kFormatBroken, path + ": " + input.geterror()};
  return image;
}

Result<void> WriteAovs(const std::string& path, const SampleBuffer& samples, const AovSelection& aovs) {
  const std::size_t count = samples.size();
  if (Result<void> size = CheckSize(path, samples.width, samples.height, count, 1); !size.ok()) return size;
  if (aovs.uv && samples.uv.size() != count)
    return Error{ErrorCode::kBadUsage, path + ": the samples hold no uv; trace with uv"};
  if (aovs.certificate && (samples.certificate.size() != count || samples.doubt.size() != count ||
                           samples.depth_error.size() != count))
    return Error{ErrorCode::kBadUsage, path + ": the samples hold no certificates"};
  if (aovs.curvature != nullptr && aovs.curvature->size() != count)
    return Error{ErrorCode::kSizeMismatch, path + ": curvature has another size than the samples"};

  // Name the channels in the order of their bytes.
  OIIO::ImageSpec spec(samples.width, samples.height, 0, OIIO::TypeDesc::FLOAT);
  const auto add = [&](const char* name, OIIO::TypeDesc type) {
    spec.channelnames.emplace_back(name);
    spec.channelformats.push_back(type);
    ++spec.nchannels;
  };
  if (aovs.depth) add("depth.Z", OIIO::TypeDesc::FLOAT);
  if (aovs.normal)
    for (const char* name : {"normal.X", "normal.Y", "normal.Z"}) add(name, OIIO::TypeDesc::FLOAT);
  if (aovs.face) add("face.id", OIIO::TypeDesc::UINT32);
  if (aovs.uv)
    for (const char* name : {"uv.U", "uv.V"}) add(name, OIIO::TypeDesc::FLOAT);
  if (aovs.certificate) {
    add("certificate.C", OIIO::TypeDesc::UINT32);
    add("certificate.doubt", OIIO::TypeDesc::UINT32);
    add("certificate.error", OIIO::TypeDesc::FLOAT);
  }
  if (aovs.curvature != nullptr) add("curvature.H", OIIO::TypeDesc::FLOAT);
  if (spec.nchannels == 0) return Error{ErrorCode::kBadUsage, path + ": no AOV is asked for"};
  spec.attribute("compression", "zip");

  // Pack pixel by pixel; every channel has four bytes.
  std::vector<unsigned char> packed;
  packed.reserve(count * spec.nchannels * 4);
  const auto append = [&](float value) { AppendBytes(packed, &value, sizeof value); };
  const auto append_id = [&](std::uint32_t value) { AppendBytes(packed, &value, sizeof value); };
  for (std::size_t i = 0; i < count; ++i) {
    if (aovs.depth) append(static_cast<float>(samples.depth[i]));
    if (aovs.normal)
      for (float coordinate : samples.normal[i]) append(coordinate);
    if (aovs.face) append_id(samples.face[i]);
    if (aovs.uv)
      for (double parameter : samples.uv[i]) append(static_cast<float>(parameter));
    if (aovs.certificate) {
      append_id(static_cast<std::uint32_t>(samples.certificate[i]));
      append_id(samples.doubt[i]);
      append(samples.depth_error[i]);
    }
    if (aovs.curvature != nullptr) append((*aovs.curvature)[i]);
  }
  return WriteImage(path, "openexr", spec, OIIO::TypeDesc::UNKNOWN, packed.data());
}

}  // namespace facetless

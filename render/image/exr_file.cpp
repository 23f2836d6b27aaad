// Writes AOVs as EXR files, and reads radiance maps from EXR files, with OpenEXR.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <list>
#include <new>
#include <stdexcept>

#include "render/image/atomic_file.h"
#include "render/image/codec.h"
#include "render/image/io.h"
#include "render/image/radiance_map.h"

namespace facetless {
namespace {

class MemoryStream : public Imf::OStream {
 public:
  explicit MemoryStream(const std::string& name) : Imf::OStream(name.c_str()) {}
  void write(const char data[], int size) override {
    const std::size_t end = position_ + static_cast<std::size_t>(size);
    if (end > bytes_.size()) bytes_.resize(end);
    std::memcpy(bytes_.data() + position_, data, static_cast<std::size_t>(size));
    position_ = end;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }
  const std::vector<unsigned char>& bytes() const { return bytes_; }

 private:
  std::vector<unsigned char> bytes_;
  std::size_t position_ = 0;
};

// A stream that reads from memory. It throws an exception if the file ends too early, as OpenEXR requires of streams.
class MemorySource : public Imf::IStream {
 public:
  MemorySource(const std::string& name, const std::vector<unsigned char>& bytes)
      : Imf::IStream(name.c_str()), bytes_(bytes) {}
  bool read(char data[], int size) override {
    const auto count = static_cast<std::size_t>(size);
    if (count > bytes_.size() - std::min(bytes_.size(), position_))
      throw std::runtime_error("the file ends too early");
    std::memcpy(data, bytes_.data() + position_, count);
    position_ += count;
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override { position_ = position; }

 private:
  const std::vector<unsigned char>& bytes_;
  std::size_t position_ = 0;
};

// The channels of one file. Values that already have the type of the file are not copied.
class Channels {
 public:
  Channels(int width, int height) : header_(width, height), width_(static_cast<std::size_t>(width)) {
    header_.compression() = Imf::ZIP_COMPRESSION;
  }

  void Float(const char* name, const float* first, std::size_t stride) {
    Add(name, Imf::FLOAT, first, stride);
  }
  void Id(const char* name, const std::uint32_t* first) { Add(name, Imf::UINT, first, sizeof *first); }
  // Adds a channel of values that must be converted; `value(i)` returns them.
  template <typename Value>
  void AddConvertedFloats(const char* name, std::size_t count, Value value) {
    std::vector<float>& floats = floats_.emplace_back(count);
    for (std::size_t i = 0; i < count; ++i) floats[i] = static_cast<float>(value(i));
    Float(name, floats.data(), sizeof(float));
  }
  template <typename Value>
  void AddConvertedIds(const char* name, std::size_t count, Value value) {
    std::vector<std::uint32_t>& ids = ids_.emplace_back(count);
    for (std::size_t i = 0; i < count; ++i) ids[i] = static_cast<std::uint32_t>(value(i));
    Id(name, ids.data());
  }

  bool empty() const { return header_.channels().begin() == header_.channels().end(); }
  void Write(MemoryStream& stream, int height) {
    Imf::OutputFile file(stream, header_);
    file.setFrameBuffer(frame_);
    file.writePixels(height);
  }

 private:
  void Add(const char* name, Imf::PixelType type, const void* first, std::size_t stride) {
    header_.channels().insert(name, Imf::Channel(type));
    // OpenEXR only reads the values, although it takes a pointer to non-const data.
    frame_.insert(
        name, Imf::Slice(type, const_cast<char*>(static_cast<const char*>(first)), stride, stride * width_));
  }

  Imf::Header header_;
  Imf::FrameBuffer frame_;
  std::size_t width_;
  std::list<std::vector<float>> floats_;
  std::list<std::vector<std::uint32_t>> ids_;
};

}  // namespace

Result<void> WriteAovs(const std::string& path, const SampleBuffer& samples, const AovSelection& aovs) {
  const std::size_t count = samples.size();
  if (Result<void> size = CheckImageSize(path, samples.width, samples.height, count, 1); !size.ok())
    return size;
  if (aovs.uv && samples.uv.size() != count)
    return Error{ErrorCode::kBadUsage, path + ": the samples hold no uv parameters"};
  if (aovs.certificate && (samples.certificate.size() != count || samples.doubt.size() != count ||
                           samples.depth_error.size() != count))
    return Error{ErrorCode::kBadUsage, path + ": the samples hold no certificates"};
  if (aovs.curvature != nullptr && aovs.curvature->size() != count)
    return Error{ErrorCode::kSizeMismatch, path + ": the curvature and the samples have different sizes"};
  try {
    Channels channels(samples.width, samples.height);
    if (aovs.depth)
      channels.AddConvertedFloats("depth.Z", count, [&](std::size_t i) { return samples.depth[i]; });
    if (aovs.normal)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const char* const names[] = {"normal.X", "normal.Y", "normal.Z"};
        channels.Float(names[axis], &samples.normal[0][axis], sizeof samples.normal[0]);
      }
    if (aovs.face) channels.Id("face.id", samples.face.data());
    if (aovs.uv) {
      channels.AddConvertedFloats("uv.U", count, [&](std::size_t i) { return samples.uv[i][0]; });
      channels.AddConvertedFloats("uv.V", count, [&](std::size_t i) { return samples.uv[i][1]; });
    }
    if (aovs.certificate) {
      channels.AddConvertedIds("certificate.C", count, [&](std::size_t i) { return samples.certificate[i]; });
      channels.AddConvertedIds("certificate.doubt", count, [&](std::size_t i) { return samples.doubt[i]; });
      channels.Float("certificate.error", samples.depth_error.data(), sizeof(float));
    }
    if (aovs.curvature != nullptr) channels.Float("curvature.H", aovs.curvature->data(), sizeof(float));
    if (channels.empty()) return Error{ErrorCode::kBadUsage, path + ": no AOV is requested"};
    MemoryStream stream(path);
    channels.Write(stream, samples.height);
    return WriteAtomically(path, stream.bytes());
  } catch (const std::bad_alloc&) {
    return ImageTooLarge(path);
  } catch (const std::exception& failure) {
    return Error{ErrorCode::kWriteFailed, path + ": " + failure.what()};
  }
}

Result<RadianceMap> DecodeExr(const std::string& path, const std::vector<unsigned char>& bytes) {
  try {
    MemorySource source(path, bytes);
    Imf::InputFile file(source);
    const Imath::Box2i window = file.header().dataWindow();
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1,
                       height = std::int64_t{window.max.y} - window.min.y + 1;
    if (width < 1 || height < 1) return Error{ErrorCode::kFormatBroken, path + ": the picture has no pixels"};
    if (width * height > kMostRadiancePixels)
      return Error{ErrorCode::kLimitExceeded, path + ": " + std::to_string(width) + "×" +
                                                  std::to_string(height) +
                                                  " pixels are too many for an environment"};
    for (const char* name : {"R", "G", "B"})
      if (file.header().channels().findChannel(name) == nullptr)
        return Error{ErrorCode::kFormatBroken, path + ": the picture lacks the channel " + name};
    RadianceMap map{static_cast<int>(width), static_cast<int>(height), {}};
    map.pixels.resize(static_cast<std::size_t>(width * height));
    // OpenEXR computes the addresses of pixels from the origin of the picture, not from that of the data window.
    constexpr std::size_t kPixel = sizeof map.pixels[0];
    char* const origin = reinterpret_cast<char*>(map.pixels.data()) -
                         (window.min.x + window.min.y * width) * static_cast<std::int64_t>(kPixel);
    Imf::FrameBuffer frame;
    for (int channel = 0; channel < 3; ++channel)
      frame.insert(std::string(1, "RGB"[channel]),
                   Imf::Slice(Imf::FLOAT, origin + static_cast<std::size_t>(channel) * sizeof(float), kPixel,
                              kPixel * static_cast<std::size_t>(width)));
    file.setFrameBuffer(frame);
    file.readPixels(window.min.y, window.max.y);
    return map;
  } catch (const std::bad_alloc&) {
    return ImageTooLarge(path);
  } catch (const std::exception& failure) {
    return Error{ErrorCode::kFormatBroken, path + ": " + failure.what()};
  }
}

}  // namespace facetless

#include "render/voxel_files/byte_source.h"

#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <fstream>

namespace facetless {
namespace {

constexpr std::size_t kChunk = 1 << 16;

class FileSource final : public ByteSource {
 public:
  FileSource(const std::string& path, std::uint64_t begin) : stream_(path, std::ios::binary) {
    stream_.seekg(static_cast<std::streamoff>(begin));
  }
  std::size_t Read(std::span<unsigned char> to) override {
    if (!stream_) return 0;
    stream_.read(reinterpret_cast<char*>(to.data()), static_cast<std::streamsize>(to.size()));
    return static_cast<std::size_t>(stream_.gcount());
  }

 private:
  std::ifstream stream_;
};

class InflatedSource final : public ByteSource {
 public:
  explicit InflatedSource(std::unique_ptr<ByteSource> compressed)
      : compressed_(std::move(compressed)), input_(kChunk) {
    // 32: the format is recognised by its first bytes.
    sound_ = inflateInit2(&stream_, MAX_WBITS + 32) == Z_OK;
    made_ = sound_;
  }
  ~InflatedSource() override {
    if (made_) inflateEnd(&stream_);
  }
  std::size_t Read(std::span<unsigned char> to) override {
    std::size_t done = 0;
    while (sound_ && done < to.size()) {
      if (stream_.avail_in == 0) {
        stream_.next_in = input_.data();
        stream_.avail_in = static_cast<uInt>(compressed_->Read(input_));
        if (stream_.avail_in == 0) sound_ = false;
      }
      const std::size_t room = std::min<std::size_t>(to.size() - done, 1u << 30);
      stream_.next_out = to.data() + done;
      stream_.avail_out = static_cast<uInt>(room);
      const int status = inflate(&stream_, Z_NO_FLUSH);
      done += room - stream_.avail_out;
      if (status == Z_STREAM_END) {
        if (inflateReset(&stream_) != Z_OK) sound_ = false;
      } else if (status != Z_OK && status != Z_BUF_ERROR) {
        sound_ = false;
      }
    }
    return done;
  }

 private:
  std::unique_ptr<ByteSource> compressed_;
  std::vector<unsigned char> input_;
  z_stream stream_ = {};
  bool sound_ = false, made_ = false;
};

class Base64Source final : public ByteSource {
 public:
  explicit Base64Source(std::unique_ptr<ByteSource> text) : text_(std::move(text)), input_(kChunk) {}

  std::size_t Read(std::span<unsigned char> to) override {
    std::size_t done = 0;
    while (done < to.size()) {
      if (left_ == 0 && !DecodeGroup()) break;
      to[done++] = group_[group_size_ - left_--];
    }
    return done;
  }

 private:
  // Decodes the next four characters. Returns false at the end.
  bool DecodeGroup() {
    unsigned bits = 0, padding = 0;
    for (int i = 0; i < 4;) {
      const int c = NextCharacter();
      if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
      const int value = c >= 'A' && c <= 'Z'   ? c - 'A'
                        : c >= 'a' && c <= 'z' ? c - 'a' + 26
                        : c >= '0' && c <= '9' ? c - '0' + 52
                        : c == '+'             ? 62
                        : c == '/'             ? 63
                                               : -1;
      if (value < 0 && c != '=') return false;
      padding += c == '=' ? 1 : 0;
      bits = bits << 6 | static_cast<unsigned>(std::max(value, 0));
      ++i;
    }
    if (padding > 2) return false;
    group_size_ = left_ = 3 - padding;
    for (unsigned i = 0; i < 3; ++i) group_[i] = static_cast<unsigned char>(bits >> (16 - 8 * i));
    return true;
  }
  int NextCharacter() {
    if (at_ == end_) {
      at_ = 0;
      end_ = text_->Read(input_);
      if (end_ == 0) return -1;
    }
    return input_[at_++];
  }

  std::unique_ptr<ByteSource> text_;
  std::vector<unsigned char> input_;
  std::size_t at_ = 0, end_ = 0;
  unsigned char group_[3] = {};
  unsigned group_size_ = 0, left_ = 0;
};

template <typename T>
void Load(const unsigned char* from, bool swap, std::span<double> to) {
  for (double& number : to) {
    unsigned char bytes[sizeof(T)];
    std::memcpy(bytes, from, sizeof(T));
    if (swap) std::reverse(bytes, bytes + sizeof(T));
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    number = static_cast<double>(value);
    from += sizeof(T);
  }
}

void LoadAs(NumberType type, const unsigned char* from, bool swap, std::span<double> to) {
  switch (type) {
    case NumberType::kUint8:
      return Load<std::uint8_t>(from, swap, to);
    case NumberType::kInt8:
      return Load<std::int8_t>(from, swap, to);
    case NumberType::kUint16:
      return Load<std::uint16_t>(from, swap, to);
    case NumberType::kInt16:
      return Load<std::int16_t>(from, swap, to);
    case NumberType::kUint32:
      return Load<std::uint32_t>(from, swap, to);
    case NumberType::kInt32:
      return Load<std::int32_t>(from, swap, to);
    case NumberType::kUint64:
      return Load<std::uint64_t>(from, swap, to);
    case NumberType::kInt64:
      return Load<std::int64_t>(from, swap, to);
    case NumberType::kFloat:
      return Load<float>(from, swap, to);
    case NumberType::kDouble:
      return Load<double>(from, swap, to);
  }
}

bool IsSpace(unsigned char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

}  // namespace

std::unique_ptr<ByteSource> FileRange(const std::string& path, std::uint64_t begin) {
  return std::make_unique<FileSource>(path, begin);
}

std::unique_ptr<ByteSource> Inflated(std::unique_ptr<ByteSource> compressed) {
  return std::make_unique<InflatedSource>(std::move(compressed));
}

std::unique_ptr<ByteSource> FromBase64(std::unique_ptr<ByteSource> text) {
  return std::make_unique<Base64Source>(std::move(text));
}

std::size_t BytesOf(NumberType type) {
  constexpr std::size_t kBytes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kBytes[static_cast<std::size_t>(type)];
}

NumberSource::NumberSource(std::unique_ptr<ByteSource> bytes, NumberType type, std::endian order)
    : bytes_(std::move(bytes)), type_(type), swap_(order != std::endian::native) {}

NumberSource NumberSource::FromText(std::unique_ptr<ByteSource> text) {
  NumberSource numbers(std::move(text), NumberType::kDouble, std::endian::native);
  numbers.text_ = true;
  return numbers;
}

bool NumberSource::Read(std::span<double> to) {
  if (text_) return ReadText(to);
  const std::size_t width = BytesOf(type_);
  buffer_.resize(kChunk);
  while (!to.empty()) {
    const std::span<double> part = to.subspan(0, std::min(to.size(), kChunk / width));
    if (bytes_->Read({buffer_.data(), part.size() * width}) < part.size() * width) return false;
    LoadAs(type_, buffer_.data(), swap_, part);
    to = to.subspan(part.size());
  }
  return true;
}

bool NumberSource::ReadText(std::span<double> to) {
  constexpr std::size_t kLongest = 64;  // characters of a number
  const auto more = [&] {
    at_ = 0;
    buffer_.resize(kChunk);
    end_ = bytes_->Read(buffer_);
    return end_ > 0;
  };
  for (double& number : to) {
    char text[kLongest];
    std::size_t length = 0;
    for (;;) {
      if (at_ == end_ && !more()) break;
      const unsigned char c = buffer_[at_];
      if (c == '<') break;
      ++at_;
      if (IsSpace(c)) {
        if (length > 0) break;
        continue;
      }
      if (length == kLongest) return false;
      text[length++] = static_cast<char>(c);
    }
    const char* begin = text + (length > 0 && text[0] == '+' ? 1 : 0);
    const auto [end, status] = std::from_chars(begin, text + length, number);
    if (length == 0 || status != std::errc() || end != text + length) return false;
  }
  return true;
}

std::optional<std::uint64_t> NumberSource::ReadLength() {
  unsigned char bytes[8] = {};
  const std::size_t width = BytesOf(type_);
  if (bytes_->Read({bytes, width}) < width) return std::nullopt;
  if (swap_) std::reverse(bytes, bytes + width);
  std::uint64_t length = 0;
  std::memcpy(&length, bytes, width);
  return length;
}

}  // namespace facetless

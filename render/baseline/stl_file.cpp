// Reads STL files, binary and ASCII.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>
#include <vector>

#include "render/baseline/mesh_reader.h"
#include "render/baseline/smooth_normals.h"

namespace facetless {
namespace {

constexpr std::size_t kBinaryHeader = 84, kBinaryRecord = 50;
constexpr std::size_t kCornersInRecord = 12;  // after the normal, which is not used (mesh_file.h, law 4)

// The length of a binary file with the stated number of triangles; 0 if `bytes` is shorter.
std::size_t BinaryLength(Bytes bytes) {
  if (bytes.size() < kBinaryHeader) return 0;
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, bytes.data() + 80, 4);
  const std::size_t length = kBinaryHeader + kBinaryRecord * static_cast<std::size_t>(triangles);
  return length <= bytes.size() ? length : 0;
}

// Returns whether the file starts with "solid" and continues soon with "facet" or "endsolid". The second word
// is needed because the headers of many binary files start with "solid", too.
bool LooksLikeAscii(Bytes bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()),
                              std::min<std::size_t>(bytes.size(), 2048));
  const std::size_t start = text.find_first_not_of(" \t\r\n");
  if (start == std::string_view::npos || text.substr(start, 5) != "solid") return false;
  return text.find('\0') == std::string_view::npos &&
         (text.find("facet") != std::string_view::npos || text.find("endsolid") != std::string_view::npos);
}

// Collects triangles. Each has three vertices of its own; MakeSmoothNormals merges those that coincide.
class Triangles {
 public:
  Triangles(std::string name, std::uint64_t max_bytes) : name_(std::move(name)), max_bytes_(max_bytes) {
    part_.name = name_;
  }

  Result<void> Add(const std::array<std::array<float, 3>, 3>& corners) {
    const std::size_t base = part_.positions.size();
    if (base + 3 >= kNoIndex || (base + 3) * kVertexBytes + (base / 3 + 1) * kTriangleBytes > max_bytes_)
      return Error{ErrorCode::kLimitExceeded,
                   name_ + ": the triangles take more memory than " + std::to_string(max_bytes_) + " bytes"};
    for (const auto& corner : corners)
      for (float coordinate : corner)
        if (!std::isfinite(coordinate))
          return Error{ErrorCode::kNotFinite,
                       name_ + ": a vertex of triangle " + std::to_string(base / 3 + 1) + " is not a number"};
    part_.positions.insert(part_.positions.end(), corners.begin(), corners.end());
    const auto index = static_cast<std::uint32_t>(base);
    part_.triangles.push_back({index, index + 1, index + 2});
    return {};
  }

  Result<MeshPart> Take() && {
    if (part_.triangles.empty())
      return Error{ErrorCode::kNothingUsable, name_ + ": the mesh has no triangle"};
    part_.face_of_triangle.assign(part_.triangles.size(), 0);
    return std::move(part_);
  }

 private:
  const std::string name_;
  const std::uint64_t max_bytes_;
  MeshPart part_;
};

// Reads a binary file. Bytes after the last record are ignored, because some programs write remarks there.
Result<MeshPart> ReadBinary(Bytes bytes, Triangles triangles) {
  const std::size_t end = BinaryLength(bytes);
  for (std::size_t record = kBinaryHeader; record < end; record += kBinaryRecord) {
    std::array<std::array<float, 3>, 3> corners;
    std::memcpy(&corners, bytes.data() + record + kCornersInRecord, sizeof corners);
    if (Result<void> added = triangles.Add(corners); !added.ok()) return added.error();
  }
  return std::move(triangles).Take();
}

// Reads an ASCII file word by word, with any white space in between. Keywords may be in any case.
class AsciiReader {
 public:
  AsciiReader(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  Result<MeshPart> Read(Triangles triangles) {
    for (Word(); !word_.empty(); Word()) {
      if (!Is("solid")) return Expected("'solid'");
      SkipLine();  // the solid's name
      for (Word(); !Is("endsolid"); Word()) {
        std::array<std::array<float, 3>, 3> corners;
        if (Result<void> facet = Facet(corners); !facet.ok()) return facet.error();
        if (Result<void> added = triangles.Add(corners); !added.ok()) return added.error();
      }
      SkipLine();
    }
    return std::move(triangles).Take();
  }

 private:
  // Reads a facet, whose first word has already been read.
  Result<void> Facet(std::array<std::array<float, 3>, 3>& corners) {
    if (!Is("facet")) return Expected("'facet' or 'endsolid'");
    if (!Next("normal")) return Expected("'normal'");
    for (int k = 0; k < 3; ++k) Word();  // the normal is not parsed, because some programs write 1.#QNAN
    if (!Next("outer") || !Next("loop")) return Expected("'outer loop'");
    for (auto& corner : corners) {
      if (!Next("vertex")) return Expected("'vertex', three in each facet,");
      if (Result<void> numbers = Numbers(corner); !numbers.ok()) return numbers;
    }
    if (!Next("endloop")) return Expected("'endloop'");
    if (!Next("endfacet")) return Expected("'endfacet'");
    return {};
  }

  Result<void> Numbers(std::array<float, 3>& numbers) {
    for (float& number : numbers) {
      Word();
      std::string_view digits = word_;
      if (digits.starts_with('+')) digits.remove_prefix(1);
      double value = 0;
      const auto [end, failed] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
      if (failed == std::errc::result_out_of_range)
        value = std::abs(value) < 1 ? 0 : INFINITY;
      else if (failed != std::errc() || end != digits.data() + digits.size())
        return Expected("a number");
      number = static_cast<float>(value);
    }
    return {};
  }

  // Reads the next word into word_; "" at the end.
  void Word() {
    while (place_ < text_.size() && IsSpace(text_[place_])) Pass();
    const std::size_t begin = place_;
    while (place_ < text_.size() && !IsSpace(text_[place_])) ++place_;
    word_ = text_.substr(begin, place_ - begin);
  }
  void SkipLine() {
    while (place_ < text_.size() && text_[place_] != '\n') ++place_;
  }
  void Pass() { line_ += text_[place_++] == '\n' ? 1 : 0; }
  static bool IsSpace(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

  bool Is(std::string_view keyword) const {
    return std::ranges::equal(word_, keyword,
                              [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a + 32 : a) == b; });
  }
  bool Next(std::string_view keyword) {
    Word();
    return Is(keyword);
  }
  Error Expected(const std::string& what) const {
    const std::string place = name_ + ": line " + std::to_string(line_) + ": ";
    if (word_.empty())
      return {ErrorCode::kFormatBroken,
              place + "the file ends where " + what + " is expected: it is cut off; export it again"};
    return {ErrorCode::kFormatBroken,
            place + what + " is expected, not '" + std::string(word_.substr(0, 40)) + "'"};
  }

  std::string_view text_, word_;
  const std::string& name_;
  std::size_t place_ = 0, line_ = 1;
};

}  // namespace

bool LooksLikeStl(Bytes bytes) {
  return LooksLikeAscii(bytes) || BinaryLength(bytes) > 0;
}

Result<Mesh> ReadStl(Bytes bytes, const std::string& name, FileAxes axes, const MeshLoadOptions& options) {
  Triangles triangles(name, options.max_memory_bytes);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  Result<MeshPart> part = LooksLikeAscii(bytes) ? AsciiReader(text, name).Read(std::move(triangles))
                                                : ReadBinary(bytes, std::move(triangles));
  if (!part.ok()) return part.error();
  MakeSmoothNormals(part.value(), options.crease_deg);
  Mesh mesh;
  mesh.parts.push_back(std::move(part).value());
  mesh.nodes.push_back({0, FileToModel(axes), 0});
  return mesh;
}

}  // namespace facetless

#include "server/run/report_html.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "render/base/parallel.h"
#include "render/compare/pixel_data.h"
#include "render/image/io.h"
#include "server/base/files.h"
#include "server/base/web_assets.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

// The size limit of an embedded picture. One of 65,536 × 65,536 pixels exceeds it, and no browser would show
// it.
constexpr std::size_t kMaxPictureBytes = std::size_t{1} << 30;

// Returns JSON that is safe inside <script>: without "<" there is neither "</script" nor "<!--". In JSON, "<"
// occurs only in strings.
std::string ScriptSafe(const Json& json) {
  std::string safe;
  for (const char c : JsonText(json, -1)) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string EscapedHtml(const std::string& text) {
  std::string html;
  for (const char c : text) {
    switch (c) {
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '&':
        html += "&amp;";
        break;
      case '"':
        html += "&quot;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

// Replaces each {{KEY}} once, in one pass: the replacements are not searched for further keys.
std::string Filled(std::string_view text,
                   const std::vector<std::pair<std::string_view, std::string>>& values) {
  std::string filled;
  while (!text.empty()) {
    const std::size_t open = text.find("{{");
    filled += text.substr(0, open);
    if (open == std::string_view::npos) break;
    text.remove_prefix(open + 2);
    const std::size_t close = text.find("}}");
    const std::string_view key = text.substr(0, close);
    for (const auto& [name, value] : values) {
      if (name == key) filled += value;
    }
    text.remove_prefix(close == std::string_view::npos ? text.size() : close + 2);
  }
  return filled;
}

// Reports are sent by mail, so their size is limited. All views together begin with at most
// kMostEmbeddedPixels pixels of data; the stride is increased while the report would exceed kMostBytes.
// Beyond kMostStride the data would say too little, so a report that is still too large stays so.
constexpr double kMostEmbeddedPixels = 1.1e6;
constexpr std::size_t kMostBytes = 2'700'000;
constexpr int kMostStride = 6;

std::size_t Base64Size(std::size_t bytes) {
  return (bytes + 2) / 3 * 4;
}

// Returns the plane of a role such as "pixel-deviation" or, for a further candidate, "fast-pixel-deviation".
std::optional<PixelPlane> PlaneOf(const std::string& role) {
  for (std::size_t i = 0; i < kPixelPlanes; ++i) {
    const std::string name = PixelPlaneName(PixelPlane(i));
    if (role == name || role.ends_with("-" + name)) return PixelPlane(i);
  }
  return std::nullopt;
}

// Returns the stride, in pixels along either direction, with which the pixel data are embedded at first.
int StrideOf(const Json& views) {
  double pixels = 0;
  for (const Json& view : views) {
    if (!view.contains("camera")) continue;
    pixels += view["camera"].value("width", 0.0) * view["camera"].value("height_px", 0.0);
  }
  return std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / kMostEmbeddedPixels))));
}

// Collects pictures as data URIs by the names of their files.
class Pictures {
 public:
  explicit Pictures(const std::string& directory) : directory_(directory) {}

  // Adds a PNG file; other files are ignored.
  Result<void> Add(const std::string& name) {
    if (!name.ends_with(".png")) return {};
    auto bytes = ReadFile(Path(name), kMaxPictureBytes);
    if (!bytes) return bytes.error();
    Put(name, bytes.value());
    return {};
  }
  // Adds pixel planes, reduced until they fit into `room` bytes.
  Result<void> AddPlanes(const std::vector<std::pair<PixelPlane, std::string>>& planes, int stride,
                         std::size_t room) {
    for (; stride <= kMostStride; ++stride) {
      std::vector<Result<std::string>> encoded(planes.size(), std::string());
      ParallelFor(std::size_t{0}, planes.size(), [&](std::size_t i) {
        const std::string path = Path(planes[i].second);
        if (stride == 1) {
          encoded[i] = ReadFile(path, kMaxPictureBytes);
          return;
        }
        const auto full = ReadPng(path);
        encoded[i] = full ? EncodeDataPng(ReducedPlane(planes[i].first, full.value(), stride))
                          : Result<std::string>(full.error());
      });
      std::size_t bytes = 0;
      for (const Result<std::string>& plane : encoded) {
        if (!plane) return plane.error();
        bytes += Base64Size(plane.value().size());
      }
      if (bytes > room && stride < kMostStride) continue;
      for (std::size_t i = 0; i < planes.size(); ++i) Put(planes[i].second, encoded[i].value());
      return {};
    }
    return {};
  }
  std::size_t bytes() const { return bytes_; }
  const Json& json() const { return json_; }

 private:
  std::string Path(const std::string& name) const {
    return directory_.empty() ? name : directory_ + "/" + name;
  }
  void Put(const std::string& name, const std::string& bytes) {
    json_[name] = "data:image/png;base64," + Base64(bytes);
    bytes_ += Base64Size(bytes.size());
  }

  const std::string directory_;
  Json json_ = Json::object();
  std::size_t bytes_ = 0;
};

std::string Page(const std::string& title, const Json& report, const Json& pictures) {
  return Filled(WebAsset("report.html"), {{"title", EscapedHtml(title)},
                                          {"style", std::string(WebAsset("style.css"))},
                                          {"script", std::string(WebAsset("report.js"))},
                                          {"report", ScriptSafe(report)},
                                          {"pictures", ScriptSafe(pictures)}});
}

}  // namespace

std::string Base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    // Three bytes, with zeros for missing ones, make four digits of six bits.
    std::uint32_t bits = 0;
    for (std::size_t j = 0; j < 3; ++j)
      bits = bits << 8 | (i + j < bytes.size() ? static_cast<std::uint8_t>(bytes[i + j]) : 0u);
    for (std::size_t j = 0; j < 4; ++j)
      text += i + j <= bytes.size() ? kDigits[bits >> (18 - 6 * j) & 63] : '=';
  }
  return text;
}

Result<std::string> ReportHtml(const Json& report, const std::string& directory) {
  Pictures pictures(directory);
  std::vector<std::pair<PixelPlane, std::string>> planes;
  for (const Json& view : report.at("views")) {
    const Json& files = view.at("files");
    const bool heat_map = files.contains(PixelPlaneName(PixelPlane::kDeviation));
    for (const auto& [role, file] : files.items()) {
      if (const auto plane = PlaneOf(role)) {
        planes.emplace_back(*plane, file);
        continue;
      }
      // The page draws the heat maps from the pixel data.
      if ((role == "difference" || role.ends_with("-difference")) && heat_map) continue;
      if (auto embedded = pictures.Add(file); !embedded) return embedded.error();
    }
  }
  const std::size_t room = kMostBytes - std::min(kMostBytes, JsonText(report, -1).size() + pictures.bytes());
  if (auto embedded = pictures.AddPlanes(planes, StrideOf(report.at("views")), room); !embedded)
    return embedded.error();
  return Page(report.at("model").value("file", "report"), report, pictures.json());
}

Result<std::string> RegressHtml(const Json& verdict) {
  Pictures pictures("");
  for (const Json& file : verdict.at("files")) {
    const Json views = file.value("views", Json::array());
    for (const Json& view : views) {
      const Json files = view.value("files", Json::object());
      for (const auto& [role, path] : files.items()) {
        if (role == "side-by-side" || role == "difference") continue;
        if (auto embedded = pictures.Add(path); !embedded) return embedded.error();
      }
    }
  }
  return Page(verdict.value("manifest", "regress"), verdict, pictures.json());
}

}  // namespace facetless

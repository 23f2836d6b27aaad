#include "server/report_html.h"

#include <cstdint>

#include "server/files.h"
#include "server/service/web_assets.h"

namespace facetless {
namespace {

// A picture of 65,536 × 65,536 pixels does not fit, and no browser would show it.
constexpr std::size_t kMaxPictureBytes = std::size_t{1} << 30;

// JSON that is safe inside <script>: without "<" there is neither "</script" nor "<!--". In JSON it occurs in
// strings only.
std::string ScriptSafe(const nlohmann::json& json) {
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

// Replaces {{KEY}}, once each, in one pass: what was put in is not looked at again.
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

}  // namespace

std::string Base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    // Three bytes, the missing ones zero, make four digits of six bits.
    std::uint32_t bits = 0;
    for (std::size_t j = 0; j < 3; ++j)
      bits = bits << 8 | (i + j < bytes.size() ? static_cast<std::uint8_t>(bytes[i + j]) : 0u);
    for (std::size_t j = 0; j < 4; ++j)
      text += i + j <= bytes.size() ? kDigits[bits >> (18 - 6 * j) & 63] : '=';
  }
  return text;
}

Result<std::string> ReportHtml(const nlohmann::json& report, const std::string& directory) {
  nlohmann::json pictures = nlohmann::json::object();
  const auto embed = [&](const std::string& name) -> Result<void> {
    const char* type = name.ends_with(".png")   ? "image/png"
                       : name.ends_with(".svg") ? "image/svg+xml"
                                                : nullptr;
    if (type == nullptr) return {};
    auto bytes = ReadFile(directory + "/" + name, kMaxPictureBytes);
    if (!bytes) return bytes.error();
    pictures[name] = std::string("data:") + type + ";base64," + Base64(bytes.value());
    return {};
  };
  for (const auto& view : report.at("views")) {
    for (const auto& file : view.at("files")) {
      if (auto embedded = embed(file.get<std::string>()); !embedded) return embedded.error();
    }
    // Of a plot, the drawing that stays sharp.
    for (const auto& plot : view.value("plots", nlohmann::json::object())) {
      if (auto embedded = embed(plot.at("svg").get<std::string>()); !embedded) return embedded.error();
    }
  }
  return Filled(WebAsset("report.html"), {{"title", EscapedHtml(report.at("model").value("file", "report"))},
                                          {"style", std::string(WebAsset("style.css"))},
                                          {"viewer", std::string(WebAsset("viewer.js"))},
                                          {"report", ScriptSafe(report)},
                                          {"pictures", ScriptSafe(pictures)}});
}

}  // namespace facetless

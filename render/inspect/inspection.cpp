#include "render/inspect/inspection.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <utility>

namespace facetless {
namespace {

constexpr int kMostStripes = 1000;
// The square of a direction that is shorter than this, or longer than its inverse, loses precision to
// underflow or overflow.
constexpr double kShortestDirection = 1e-100;

const std::vector<std::string> kCurvatures = {"gaussian", "mean", "max", "min"};

// The names of directions; the last three are in viewer axes.
constexpr std::pair<const char*, InspectionDirection> kDirections[] = {
    {"x", {{1, 0, 0}, false}},    {"y", {{0, 1, 0}, false}},   {"z", {{0, 0, 1}, false}},
    {"-x", {{-1, 0, 0}, false}},  {"-y", {{0, -1, 0}, false}}, {"-z", {{0, 0, -1}, false}},
    {"right", {{1, 0, 0}, true}}, {"up", {{0, 1, 0}, true}},   {"toward", {{0, 0, 1}, true}},
};

Error BadUsage(std::string message) {
  return {ErrorCode::kBadUsage, std::move(message)};
}

std::string Joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::optional<double> Number(const std::string& text) {
  double value = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  if (parsed.ec != std::errc{} || parsed.ptr != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

std::vector<std::string> Split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

using Setting = std::pair<std::string, std::string>;

// Splits settings such as "a=1,b=0,0,1". A part without = belongs to the previous value.
Result<std::vector<Setting>> Settings(const std::string& text) {
  std::vector<Setting> settings;
  for (const std::string& part : Split(text, ',')) {
    const std::size_t equals = part.find('=');
    if (equals != std::string::npos) {
      settings.emplace_back(part.substr(0, equals), part.substr(equals + 1));
    } else if (!settings.empty()) {
      settings.back().second += "," + part;
    } else {
      return BadUsage("shade: \"" + part + "\" must be KEY=VALUE");
    }
  }
  return settings;
}

Result<void> ReadDirection(const Setting& setting, InspectionDirection& direction) {
  for (const auto& [word, named] : kDirections) {
    if (setting.second != word) continue;
    direction = named;
    return {};
  }
  const std::vector<std::string> parts = Split(setting.second, ',');
  double xyz[3] = {};
  bool sound = parts.size() == 3;
  for (std::size_t i = 0; sound && i < 3; ++i) {
    const std::optional<double> number = Number(parts[i]);
    sound = number.has_value();
    if (sound) xyz[i] = *number;
  }
  const double length = Length(Vec3{xyz[0], xyz[1], xyz[2]});
  if (!sound || !(length > kShortestDirection && length < 1 / kShortestDirection))
    return BadUsage("shade: " + setting.first + " is \"" + setting.second +
                    "\", but must be a direction: X,Y,Z, or one of x, y, z, -x, -y, -z, right, up, toward");
  direction = {{xyz[0], xyz[1], xyz[2]}, false};
  return {};
}

Result<void> ReadCount(const Setting& setting, int least, int most, int& count) {
  const std::optional<double> number = Number(setting.second);
  if (!number || !(*number >= least && *number <= most) || *number != std::floor(*number))
    return BadUsage("shade: " + setting.first + " is \"" + setting.second +
                    "\", but must be a whole number from " + std::to_string(least) + " to " +
                    std::to_string(most));
  count = static_cast<int>(*number);
  return {};
}

Result<void> ReadRange(const Setting& setting, std::optional<ValueRange>& range) {
  const std::size_t dots = setting.second.find("..");
  if (dots != std::string::npos) {
    const std::optional<double> low = Number(setting.second.substr(0, dots)),
                                high = Number(setting.second.substr(dots + 2));
    if (low && high && *low < *high) {
      range = ValueRange{*low, *high};
      return {};
    }
  }
  return BadUsage("shade: range is \"" + setting.second + "\", but must be LOW..HIGH, as in -0.1..0.1");
}

Result<void> ReadSetting(const Setting& setting, Inspection& inspection) {
  const std::string& key = setting.first;
  switch (inspection.kind) {
    case InspectionKind::kZebra:
      if (key == "stripes") return ReadCount(setting, 2, kMostStripes, inspection.count);
      if (key == "axis") return ReadDirection(setting, inspection.direction);
      return BadUsage("shade: zebra has no \"" + key + "\"; it has stripes and axis");
    case InspectionKind::kIsophotes:
      if (key == "bands") return ReadCount(setting, 2, kMostStripes, inspection.count);
      if (key == "light") return ReadDirection(setting, inspection.direction);
      return BadUsage("shade: isophotes has no \"" + key + "\"; it has bands and light");
    case InspectionKind::kReflection:
      if (key == "lines") return ReadCount(setting, 1, kMostStripes, inspection.count);
      if (key == "direction") return ReadDirection(setting, inspection.direction);
      return BadUsage("shade: reflection has no \"" + key + "\"; it has lines and direction");
    case InspectionKind::kCurvature: {
      if (key == "range") return ReadRange(setting, inspection.range);
      if (key != "kind") return BadUsage("shade: curvature has no \"" + key + "\"; it has kind and range");
      const auto found = std::find(kCurvatures.begin(), kCurvatures.end(), setting.second);
      if (found == kCurvatures.end())
        return BadUsage("shade: there is no curvature \"" + setting.second + "\"; there are " +
                        Joined(kCurvatures));
      inspection.curvature = static_cast<CurvatureKind>(found - kCurvatures.begin());
      return {};
    }
    case InspectionKind::kDraft: {
      if (key == "direction") return ReadDirection(setting, inspection.direction);
      if (key != "limit") return BadUsage("shade: draft has no \"" + key + "\"; it has direction and limit");
      const std::optional<double> degrees = Number(setting.second);
      if (!degrees || !(*degrees > 0 && *degrees < 90))
        return BadUsage("shade: limit is \"" + setting.second + "\", but must be degrees between 0 and 90");
      inspection.limit_deg = *degrees;
      return {};
    }
    case InspectionKind::kThickness:
      if (key == "range") return ReadRange(setting, inspection.range);
      return BadUsage("shade: thickness has no \"" + key + "\"; it has range");
    case InspectionKind::kUnseen:
      if (key == "pixels") return ReadCount(setting, 1, 1'000'000, inspection.few_pixels);
      return BadUsage("shade: unseen has no \"" + key + "\"; it has pixels");
    default:
      return BadUsage("shade: " + InspectionNames()[static_cast<std::size_t>(inspection.kind)] +
                      " has no settings");
  }
}

std::string Text(double number) {
  char text[32];
  const auto written = std::to_chars(text, text + sizeof text, number);
  return {text, written.ptr};
}

std::string Text(const InspectionDirection& direction) {
  const Vec3 v = direction.vector;
  for (const auto& [word, named] : kDirections)
    if (named.of_view == direction.of_view && named.vector.x == v.x && named.vector.y == v.y &&
        named.vector.z == v.z)
      return word;
  return Text(v.x) + "," + Text(v.y) + "," + Text(v.z);
}

}  // namespace

const std::vector<std::string>& InspectionNames() {
  static const std::vector<std::string> names = {"studio",    "zebra", "isophotes", "reflection",
                                                 "curvature", "draft", "thickness", "faces",
                                                 "unseen",    "back"};
  return names;
}

Result<Inspection> ParseInspection(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string name = text.substr(0, colon);
  const auto found = std::find(InspectionNames().begin(), InspectionNames().end(), name);
  if (found == InspectionNames().end())
    return BadUsage("shade: there is no \"" + name + "\"; there are " + Joined(InspectionNames()));
  Inspection inspection;
  inspection.kind = static_cast<InspectionKind>(found - InspectionNames().begin());
  if (inspection.kind == InspectionKind::kIsophotes) inspection.count = 16;
  if (inspection.kind == InspectionKind::kReflection) {
    inspection.count = 36;
    inspection.direction = {{1, 0, 0}, false};
  }
  if (colon == std::string::npos) return inspection;
  const Result<std::vector<Setting>> settings = Settings(text.substr(colon + 1));
  if (!settings) return settings.error();
  for (const Setting& setting : settings.value())
    if (Result<void> read = ReadSetting(setting, inspection); !read) return read.error();
  return inspection;
}

std::string FormatInspection(const Inspection& inspection) {
  const std::string name = InspectionNames()[static_cast<std::size_t>(inspection.kind)];
  const std::string count = std::to_string(inspection.count), direction = Text(inspection.direction);
  const std::string range =
      inspection.range ? "range=" + Text(inspection.range->low) + ".." + Text(inspection.range->high) : "";
  switch (inspection.kind) {
    case InspectionKind::kZebra:
      return name + ":stripes=" + count + ",axis=" + direction;
    case InspectionKind::kIsophotes:
      return name + ":bands=" + count + ",light=" + direction;
    case InspectionKind::kReflection:
      return name + ":lines=" + count + ",direction=" + direction;
    case InspectionKind::kCurvature:
      return name + ":kind=" + kCurvatures[static_cast<std::size_t>(inspection.curvature)] +
             (range.empty() ? "" : "," + range);
    case InspectionKind::kDraft:
      return name + ":direction=" + direction + ",limit=" + Text(inspection.limit_deg);
    case InspectionKind::kThickness:
      return name + (range.empty() ? "" : ":" + range);
    case InspectionKind::kUnseen:
      return name + ":pixels=" + std::to_string(inspection.few_pixels);
    default:
      return name;
  }
}

bool NeedsExactSurface(InspectionKind kind) {
  return kind == InspectionKind::kCurvature || kind == InspectionKind::kThickness;
}

Result<void> CheckMeshCanShow(const Inspection& inspection, bool names_faces) {
  if (inspection.kind == InspectionKind::kCurvature)
    return BadUsage(
        "shade: a mesh has no curvature to compare with, only flat triangles; render shows that of the "
        "surfaces");
  if (inspection.kind == InspectionKind::kThickness)
    return BadUsage("shade: thickness is measured on the exact solid only; render shows it");
  const bool wants_faces =
      inspection.kind == InspectionKind::kFaces || inspection.kind == InspectionKind::kUnseen;
  if (wants_faces && !names_faces)
    return BadUsage("shade: the mesh of another program names no faces; render shows the model's");
  return {};
}

Vec3 Resolved(const InspectionDirection& direction, const CameraFrame& frame) {
  const Vec3 v = direction.vector;
  return Normalized(direction.of_view ? v.x * frame.right - v.y * frame.down - v.z * frame.forward : v);
}

}  // namespace facetless

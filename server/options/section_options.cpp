#include "server/options/section_options.h"

#include <charconv>
#include <cmath>
#include <optional>

#include "server/options/option_values.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

Error NoPlane(const Json& json) {
  return {ErrorCode::kBadUsage, "section is " + Quoted(json) +
                                    ", but must be x,y,z,nx,ny,nz (a point and a normal) or a plane across "
                                    "an axis such as x=12.5, z=50% or "
                                    "-z=50%"};
}

// The finite number that the whole text represents; nothing if it does not represent one.
std::optional<double> ParseFiniteNumber(std::string_view text) {
  double number = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
  if (parsed.ec != std::errc{} || parsed.ptr != text.data() + text.size() || !std::isfinite(number))
    return {};
  return number;
}

Result<SectionRequest> FromNumbers(const Json& json, const std::vector<double>& numbers) {
  if (numbers.size() != 6) return NoPlane(json);
  SectionRequest request;
  request.plane.point = {numbers[0], numbers[1], numbers[2]};
  // Scale the normal first, because the square of a very short normal would underflow.
  Vec3 normal{numbers[3], numbers[4], numbers[5]};
  const double largest = std::fmax(std::fabs(normal.x), std::fmax(std::fabs(normal.y), std::fabs(normal.z)));
  if (!(largest > 0))
    return Error{ErrorCode::kBadUsage, "section is " + Quoted(json) + ", whose normal is zero"};
  request.plane.normal = Normalized({normal.x / largest, normal.y / largest, normal.z / largest});
  return request;
}

// Parses a plane across an axis, such as "z=12.5" or "-z=50%".
Result<SectionRequest> AcrossAxis(const Json& json, std::string_view text) {
  double sign = 1;
  if (text.starts_with('-') || text.starts_with('+')) {
    if (text[0] == '-') sign = -1;
    text.remove_prefix(1);
  }
  if (text.size() < 3 || text[0] < 'x' || text[0] > 'z' || text[1] != '=') return NoPlane(json);
  const int axis = text[0] - 'x';
  const bool share = text.back() == '%';
  const std::optional<double> number = ParseFiniteNumber(text.substr(2, text.size() - 2 - share));
  if (!number) return NoPlane(json);
  SectionRequest request;
  double* const normal[] = {&request.plane.normal.x, &request.plane.normal.y, &request.plane.normal.z};
  *normal[axis] = sign;
  double* const point[] = {&request.plane.point.x, &request.plane.point.y, &request.plane.point.z};
  if (share) {
    if (!(*number >= 0 && *number <= 100))
      return Error{ErrorCode::kBadUsage, "section is " + Quoted(json) + ", but a share lies from 0% to 100%"};
    request.axis = axis;
    request.share = *number / 100;
  } else {
    *point[axis] = *number;
  }
  return request;
}

Result<std::vector<double>> Numbers(const Json& json, const Json& list) {
  std::vector<double> numbers;
  for (const Json& entry : list) {
    if (!entry.is_number() || !std::isfinite(entry.get<double>())) return NoPlane(json);
    numbers.push_back(entry.get<double>());
  }
  return numbers;
}

Result<SectionRequest> ParseOne(const Json& json) {
  if (json.is_string()) {
    const std::string text = json.get<std::string>();
    if (text.find('=') != std::string::npos) return AcrossAxis(json, text);
    std::vector<double> numbers;
    for (std::size_t begin = 0; begin <= text.size();) {
      const std::size_t end = std::min(text.find(',', begin), text.size());
      std::string_view word = std::string_view(text).substr(begin, end - begin);
      while (word.starts_with(' ')) word.remove_prefix(1);
      const std::optional<double> number = ParseFiniteNumber(word);
      if (!number) return NoPlane(json);
      numbers.push_back(*number);
      begin = end + 1;
    }
    return FromNumbers(json, numbers);
  }
  if (json.is_object()) {
    if (json.size() != 2 || !json.contains("point") || !json.contains("normal") ||
        !json["point"].is_array() || !json["normal"].is_array() || json["point"].size() != 3)
      return NoPlane(json);
    auto numbers = Numbers(json, json["point"]), normal = Numbers(json, json["normal"]);
    if (!numbers) return numbers.error();
    if (!normal) return normal.error();
    numbers.value().insert(numbers.value().end(), normal.value().begin(), normal.value().end());
    return FromNumbers(json, numbers.value());
  }
  if (!json.is_array()) return NoPlane(json);
  auto numbers = Numbers(json, json);
  if (!numbers) return numbers.error();
  return FromNumbers(json, numbers.value());
}

}  // namespace

Result<std::vector<SectionRequest>> ParseSections(const Json& json) {
  // A list of numbers is one plane; any other list is a list of planes.
  Json planes = json;
  if (!json.is_array() || (!json.empty() && json[0].is_number())) planes = Json::array({json});
  if (planes.size() > kMostSectionPlanes)
    return Error{ErrorCode::kBadUsage, "section lists " + std::to_string(planes.size()) + " planes; " +
                                           std::to_string(kMostSectionPlanes) + " are allowed"};
  std::vector<SectionRequest> requests;
  for (const Json& plane : planes) {
    auto request = ParseOne(plane);
    if (!request) return request.error();
    requests.push_back(request.value());
  }
  return requests;
}

Result<std::vector<SectionPlane>> ResolveSections(const std::vector<SectionRequest>& requests,
                                                  const Box3& bounds) {
  std::vector<SectionPlane> planes;
  for (const SectionRequest& request : requests) {
    planes.push_back(request.plane);
    if (request.axis < 0) continue;
    if (bounds.empty())
      return Error{ErrorCode::kBadUsage, "a section at a percentage needs a model with an extent"};
    const double low[] = {bounds.low.x, bounds.low.y, bounds.low.z};
    const double high[] = {bounds.high.x, bounds.high.y, bounds.high.z};
    double* const point[] = {&planes.back().point.x, &planes.back().point.y, &planes.back().point.z};
    *point[request.axis] = low[request.axis] + request.share * (high[request.axis] - low[request.axis]);
  }
  return planes;
}

}  // namespace facetless

#include "render/voxel_files/natural_names.h"

#include <algorithm>
#include <cstdint>

namespace facetless {
namespace {

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}

// The end of the run of digits that begins at `at`.
std::size_t DigitsEnd(const std::string& text, std::size_t at) {
  while (at < text.size() && IsDigit(text[at])) ++at;
  return at;
}

// A name around its last number.
struct Numbered {
  std::string before, after;
  std::uint64_t number = 0;
  std::size_t digits = 0;  // 0: the name has no number

  explicit Numbered(const std::string& name) {
    std::size_t end = name.size();
    while (end > 0 && !IsDigit(name[end - 1])) --end;
    std::size_t begin = end;
    while (begin > 0 && IsDigit(name[begin - 1])) --begin;
    constexpr std::size_t kMostDigits = 18;
    if (begin == end || end - begin > kMostDigits) return;
    digits = end - begin;
    before = name.substr(0, begin);
    after = name.substr(end);
    number = std::stoull(name.substr(begin, digits));
  }
};

}  // namespace

bool NaturallyBefore(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!IsDigit(a[i]) || !IsDigit(b[j])) {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i, ++j;
      continue;
    }
    const std::size_t a_end = DigitsEnd(a, i), b_end = DigitsEnd(b, j);
    while (i + 1 < a_end && a[i] == '0') ++i;
    while (j + 1 < b_end && b[j] == '0') ++j;
    if (a_end - i != b_end - j) return a_end - i < b_end - j;
    if (const int order = a.compare(i, a_end - i, b, j, b_end - j); order != 0) return order < 0;
    i = a_end;
    j = b_end;
  }
  if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
  return a < b;  // equal but for leading zeros
}

std::string MissingName(std::span<const std::string> names) {
  std::uint64_t expected = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Numbered name(names[i]), first(names[0]);
    if (name.digits == 0 || name.before != first.before || name.after != first.after) return "";
    expected = i == 0 ? name.number : expected + 1;
    if (name.number == expected) continue;
    // The names behind a gap must be alike, too.
    for (const std::string& other : names.subspan(i)) {
      const Numbered later(other);
      if (later.digits == 0 || later.before != first.before || later.after != first.after) return "";
    }
    const std::string number = std::to_string(expected);
    return first.before + std::string(first.digits - std::min(first.digits, number.size()), '0') + number +
           first.after;
  }
  return "";
}

}  // namespace facetless

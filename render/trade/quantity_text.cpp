#include "render/trade/quantity_text.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace facetless {
namespace {

std::string Printed(const char* format, double number) {
  char text[48];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

// Returns `number` rounded to two significant digits.
double Rounded(double number) {
  return std::strtod(Printed("%.1e", number).c_str(), nullptr);
}

}  // namespace

std::string NumberText(double number) {
  if (!std::isfinite(number)) return "infinitely many";
  const double rounded = Rounded(number), size = std::fabs(rounded);
  if (rounded == 0) return "0";
  if (size >= 1e-3 && size < 1e5) return Printed("%.6g", rounded);
  std::string text = Printed("%.1e", rounded);
  // Shorten "4.0e-05" to "4e-5".
  if (const std::size_t fraction = text.find(".0e"); fraction != std::string::npos) text.erase(fraction, 2);
  const std::size_t sign = text.find('e') + 1;
  if (text[sign] == '+') text.erase(sign, 1);
  const std::size_t digits = text[sign] == '-' ? sign + 1 : sign;
  if (text[digits] == '0' && digits + 1 < text.size()) text.erase(digits, 1);
  return text;
}

std::string MillimetresText(double mm) {
  return NumberText(mm) + " mm";
}

std::string TimeText(double ms) {
  return Rounded(ms) < 1000 ? NumberText(ms) + " ms" : NumberText(ms / 1000) + " s";
}

std::string MemoryText(double bytes) {
  constexpr double kMegabyte = 1e6, kGigabyte = 1e9;
  return Rounded(bytes) < kGigabyte ? NumberText(bytes / kMegabyte) + " MB"
                                    : NumberText(bytes / kGigabyte) + " GB";
}

}  // namespace facetless

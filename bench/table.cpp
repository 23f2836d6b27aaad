#include "bench/table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace facetless {
namespace {

// Returns the number of columns on a screen. It counts code points, not bytes.
std::size_t Width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

std::string Padded(const std::string& text, std::size_t width, bool left) {
  const std::string blanks(width - std::min(width, Width(text)), ' ');
  return left ? text + blanks : blanks + text;
}

std::string Line(const std::vector<std::string>& cells, const std::vector<std::size_t>& widths,
                 bool markdown) {
  std::string line = markdown ? "|" : "";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string cell = markdown ? cells[i] : Padded(cells[i], widths[i], i == 0);
    if (markdown)
      line += " " + cell + " |";
    else
      line += (i == 0 ? "" : "  ") + cell;
  }
  return line + "\n";
}

}  // namespace

std::string Wrapped(const std::string& text) {
  constexpr std::size_t kColumns = 120;
  std::string wrapped;
  std::size_t used = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    const std::size_t width = Width(word);
    if (used > 0 && used + 1 + width > kColumns) {
      wrapped += "\n";
      used = 0;
    } else if (used > 0) {
      wrapped += " ";
      ++used;
    }
    wrapped += word;
    used += width;
    begin = end + 1;
  }
  return wrapped;
}

std::string TableText(const Table& table, TableStyle style) {
  const bool markdown = style == TableStyle::kMarkdown;
  std::vector<std::size_t> widths;
  for (const std::string& column : table.columns) widths.push_back(Width(column));
  for (const auto& row : table.rows)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], Width(row[i]));

  std::string text = (markdown ? "### " : "") + table.title + "\n\n" + Line(table.columns, widths, markdown);
  if (markdown) {
    text += "|";
    for (std::size_t i = 0; i < table.columns.size(); ++i) text += i == 0 ? "---|" : "--:|";
    text += "\n";
  }
  for (const auto& row : table.rows) text += Line(row, widths, markdown);
  if (!table.notes.empty()) text += "\n";
  for (const std::string& note : table.notes) text += (markdown ? Wrapped(note) : note) + "\n";
  return text + "\n";
}

std::string ThreeDigits(double value) {
  if (!std::isfinite(value)) return "-";
  if (value == 0) return "0";
  const int digits = std::max(0, 2 - static_cast<int>(std::floor(std::log10(std::fabs(value)))));
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", std::min(digits, 9), value);
  return text;
}

std::string TimesText(double ratio) {
  return ThreeDigits(ratio) + "×";
}

std::string BytesText(double bytes) {
  if (bytes < 1e6) return ThreeDigits(bytes / 1e3) + " kB";
  return bytes < 1e9 ? ThreeDigits(bytes / 1e6) + " MB" : ThreeDigits(bytes / 1e9) + " GB";
}

std::string MillisecondsText(double ms) {
  return ms < 1000 ? ThreeDigits(ms) + " ms" : ThreeDigits(ms / 1000) + " s";
}

std::string RateText(double per_second) {
  return per_second < 1e6 ? ThreeDigits(per_second / 1e3) + " k/s" : ThreeDigits(per_second / 1e6) + " M/s";
}

}  // namespace facetless

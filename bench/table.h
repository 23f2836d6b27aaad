// A table for readers: as text for a terminal, and as Markdown for docs/performance-files.md.
#pragma once

#include <string>
#include <vector>

namespace facetless {

struct Table {
  std::string title;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  // as long as columns
  std::vector<std::string> notes;              // sentences below
};

enum class TableStyle { kText, kMarkdown };

// `text` with line breaks for spaces, so that no line has more than 120 columns but for longer words.
std::string Wrapped(const std::string& text);

// With a blank line at its end. The first column is aligned to the left, the others to the right.
std::string TableText(const Table& table, TableStyle style);

// Three significant digits without an exponent: "0.0123", "12.3", "1234".
std::string ThreeDigits(double value);
// "12.3×", "1.5 MB", "3.2 ms", "1.2 s", "4.5 M/s".
std::string TimesText(double ratio);
std::string BytesText(double bytes);
std::string MillisecondsText(double ms);
std::string RateText(double per_second);

}  // namespace facetless

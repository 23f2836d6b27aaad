// A table for readers: as text for a terminal, and as Markdown for docs/performance-files.md.
#pragma once

#include <string>
#include <vector>

namespace facetless {

struct Table {
  std::string title;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  // each as long as `columns`
  std::vector<std::string> notes;              // sentences below the table
};

enum class TableStyle { kText, kMarkdown };

// Replaces spaces of `text` by line breaks, so that a line has more than 120 columns only if it is one long
// word.
std::string Wrapped(const std::string& text);

// Ends in a blank line. The first column is aligned to the left, the others to the right.
std::string TableText(const Table& table, TableStyle style);

// Returns three significant digits without an exponent: "0.0123", "12.3", "1234".
std::string ThreeDigits(double value);
// Return texts such as "12.3×", "1.5 MB", "3.2 ms", "1.2 s", "4.5 M/s".
std::string TimesText(double ratio);
std::string BytesText(double bytes);
std::string MillisecondsText(double ms);
std::string RateText(double per_second);

}  // namespace facetless

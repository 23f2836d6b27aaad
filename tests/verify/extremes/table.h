// The tables of docs/accuracy-results.md, computed from the catalogue.
#pragma once

#include <string>

namespace facetless::extremes {

struct TableOptions {
  std::string only;  // only rows whose group or input contains this text; empty: all
  bool by_hand = false;
  bool list = false;  // only name the rows
};

// Writes to standard output, and failures to standard error as they occur. Returns false if a row fails.
bool WriteTables(const TableOptions& options);

}  // namespace facetless::extremes

// The tables of docs/accuracy-results.md, computed from the catalogue.
#pragma once

#include <string>

namespace facetless::extremes {

struct TableOptions {
  std::string only;  // only rows whose group or input contains this text; empty: all
  bool by_hand = false;
  bool list = false;  // only name the rows
};

// The table of docs/method-extremes.md: what each method gets wrong. Writes to standard output. Returns false if a method
// gives samples that are not numbers; standard error names the rows. `size`: the most pixels of a picture in each direction.
bool WriteMethodTable(const TableOptions& options, int size);

// Writes to standard output, and failures to standard error as they occur. Returns false if a row fails.
bool WriteTables(const TableOptions& options);

}  // namespace facetless::extremes

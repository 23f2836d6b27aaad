// The tables of docs/accuracy-results.md, from a run of the catalogue.
#pragma once

#include <string>

namespace facetless::extremes {

struct TableOptions {
  std::string only;  // of rows whose group or input holds this; empty: all
  bool by_hand = false;
  bool list = false;  // only name the rows
};

// To standard output; failures to standard error, where they happen. False if a row fails.
bool WriteTables(const TableOptions& options);

}  // namespace facetless::extremes

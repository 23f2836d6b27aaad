// facetless_extremes renders the extremes and writes the tables of docs/accuracy-results.md, in Markdown, to
// standard output.
//
// Exit status: 0 every row passes, 2 some fail (standard error names them), 64 bad usage.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "tests/verify/extremes/table.h"

int main(int argc, char** argv) {
  facetless::extremes::TableOptions options;
  CLI::App app("Renders models and views at the border of what numbers can do, and tables what comes out");
  app.add_option("--only", options.only, "Rows whose group or input holds this text");
  app.add_flag("--by-hand", options.by_hand, "The rows that are too long for ctest, too");
  app.add_flag("--list", options.list, "Name the rows and render nothing");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 64;
  }
  return facetless::extremes::WriteTables(options) ? 0 : 2;
}

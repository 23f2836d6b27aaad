// facetless_extremes renders the extremes and writes the tables of docs/accuracy-results.md, in Markdown, to
// standard output. With --methods, it renders them with every method and writes the table of docs/method-extremes.md.
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
  bool methods = false;
  int size = 33;
  app.add_flag("--methods", methods, "Render with every method, and table what each gets wrong");
  app.add_option("--size", size, "With --methods: the most pixels of a picture in each direction")
      ->check(CLI::Range(1, 1024));
  app.add_flag("--list", options.list, "Name the rows and render nothing");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 64;
  }
  const bool holds = methods ? facetless::extremes::WriteMethodTable(options, size)
                             : facetless::extremes::WriteTables(options);
  return holds ? 0 : 2;
}

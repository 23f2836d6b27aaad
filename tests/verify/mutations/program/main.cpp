// facetless_mutations FILE… --seed N --count N sends mutants of each file to the importer or to a running
// service. It prints a JSON report, and its exit status is 1 if a mutant got no proper answer. A mutant is
// repeated with its file, seed and index: --first INDEX --count 1 --offenders DIR.
#include <CLI/CLI.hpp>
#include <iostream>

#include "tests/verify/mutations/judge.h"
#include "tests/verify/mutations/mutate.h"

int main(int argc, char** argv) {
  facetless::MutationRun run;
  run.count = 100;
  std::string url;
  CLI::App app{"Mutants of CAD and mesh files, and what becomes of them"};
  app.add_option("files", run.files)->required()->check(CLI::ExistingFile);
  app.add_option("--seed", run.seed);
  app.add_option("--first", run.first, "index of the first mutant");
  app.add_option("--count", run.count, "mutants of each file");
  app.add_option("--url", url, "post to the service at http://ADDRESS:PORT instead of starting importers");
  app.add_option("--options", run.options, "with --url: have each compared with these options, JSON");
  app.add_option("--server-pid", run.server_pid, "measure this process's memory");
  app.add_option("--offenders", run.offenders,
                 "keep mutants here that offend, crash the importer or meet a limit");
  app.add_option("--timeout", run.limits.timeout_s, "seconds for each");
  app.add_option("--memory", run.limits.memory_mb, "megabytes for each");
  CLI11_PARSE(app, argc, argv);
  if (!url.empty()) {
    const std::string prefix = "http://";
    const std::size_t colon = url.rfind(':');
    if (!url.starts_with(prefix) || colon <= prefix.size()) {
      std::cerr << "--url must be http://ADDRESS:PORT\n";
      return 64;
    }
    run.host = url.substr(prefix.size(), colon - prefix.size());
    run.port = std::atoi(url.c_str() + colon + 1);
  }
  const nlohmann::json report = facetless::RunMutations(run);
  std::cout << report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
  return report["offences"].empty() ? 0 : 1;
}

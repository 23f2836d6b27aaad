// Replaces libFuzzer for compilers without it: FILE… --seconds S --seed N. It runs each file as it is, and
// then mutants of all files in turn until the time is over. Before each run it writes the file, seed and
// index, with which a failure can be repeated.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <iterator>
#include <vector>

#include "tests/verify/fuzz/target.h"
#include "tests/verify/mutations/mutate.h"

int main(int argc, char** argv) {
  std::vector<std::string> files;
  double seconds = 5;
  std::uint64_t seed = 1, first = 0, count = 1'000'000'000;
  CLI::App app{"One fuzz target over seeds and their mutants"};
  app.add_option("files", files)->required()->check(CLI::ExistingFile);
  app.add_option("--seconds", seconds);
  app.add_option("--seed", seed);
  app.add_option("--first", first);
  app.add_option("--count", count);
  CLI11_PARSE(app, argc, argv);

  std::vector<std::string> seeds;
  for (const std::string& file : files) {
    std::ifstream in(file, std::ios::binary);
    seeds.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  const auto run = [](const std::string& bytes) {
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  };
  for (const std::string& bytes : seeds) run(bytes);
  // If the program crashes, this file contains the last run.
  std::FILE* last = std::fopen((files.front() + ".last").c_str(), "w");
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  std::uint64_t index = first;
  for (; index < first + count && std::chrono::steady_clock::now() < end; ++index) {
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      if (last != nullptr) {
        std::rewind(last);
        std::fprintf(last, "%s --seed %llu --first %llu --count 1\n", files[i].c_str(),
                     static_cast<unsigned long long>(seed), static_cast<unsigned long long>(index));
        std::fflush(last);
      }
      run(facetless::MakeMutant(seeds[i], seed, index).bytes);
    }
  }
  if (last != nullptr) std::fclose(last);
  std::printf("%llu mutants of each of %zu files, seed %llu\n",
              static_cast<unsigned long long>(index - first), seeds.size(),
              static_cast<unsigned long long>(seed));
  return 0;
}

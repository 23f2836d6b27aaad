// Mutants: files that differ from a sound file in the way of files that were damaged, cut, badly exported, or
// made to do harm.
//
//  1. A mutant depends only on the file's bytes, the seed and its index, on every machine.
//  2. STEP, IGES and glTF are changed by their own syntax about three times in four: numbers, references,
//     keywords, records, entities, texts, lists. Otherwise, and in all other files, bytes are changed.
//  3. Each mutant has one to four changes, so that most of the file keeps its meaning.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace facetless {

// Random numbers from a seed. They are the same on every machine, unlike those of the standard library's
// distributions.
class Dice {
 public:
  Dice(std::uint64_t seed, std::uint64_t index);
  std::uint64_t Next();
  // Returns 0 … below − 1; 0 if `below` is 0.
  std::size_t Below(std::size_t below);
  bool OneIn(std::size_t sides) { return Below(sides) == 0; }
  template <typename T, std::size_t N>
  const T& Pick(const T (&all)[N]) {
    return all[Below(N)];
  }

 private:
  std::uint64_t state_;
};

struct Mutant {
  std::string bytes;
  std::string what;  // its changes, each in a few words
};

Mutant MakeMutant(std::string_view original, std::uint64_t seed, std::uint64_t index);

// Each makes one change in place, and returns its description. The first three change nothing if the bytes do
// not contain the syntax.
std::string MutateStep(std::string& bytes, Dice& dice);
std::string MutateIges(std::string& bytes, Dice& dice);
std::string MutateGltf(std::string& bytes, Dice& dice);
std::string MutateBytes(std::string& bytes, Dice& dice);

}  // namespace facetless

// Mutants: files that differ from a sound one as files differ that were damaged, cut, badly exported, or made
// to do harm.
//
//  1. A mutant is a function of the file's bytes, the seed and its index alone, on every machine.
//  2. STEP, IGES and glTF are changed by their own syntax about three times in four: numbers, references,
//     keywords, records, entities, texts, lists. Otherwise, and in all other files, bytes are.
//  3. One to four changes each, so that most of the file still means what it did.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace facetless {

// Numbers from a seed: the same on every machine, unlike the standard library's distributions.
class Dice {
 public:
  Dice(std::uint64_t seed, std::uint64_t index);
  std::uint64_t Next();
  // 0 … below − 1; 0 for 0.
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
  std::string what;  // its changes, in a few words each
};

Mutant MakeMutant(std::string_view original, std::uint64_t seed, std::uint64_t index);

// One change each, in place, and what it was; the first three change nothing if the bytes have no such
// syntax.
std::string MutateStep(std::string& bytes, Dice& dice);
std::string MutateIges(std::string& bytes, Dice& dice);
std::string MutateGltf(std::string& bytes, Dice& dice);
std::string MutateBytes(std::string& bytes, Dice& dice);

}  // namespace facetless

#include "tests/verify/mutations/mutate.h"

#include <algorithm>
#include <cstring>

namespace facetless {
namespace {

// Larger mutants would not find more.
constexpr std::size_t kMaxBytes = std::size_t{64} << 20;

std::string UsualGarbage(Dice& dice, std::size_t length) {
  std::string garbage;
  for (std::size_t i = 0; i < length; ++i) garbage += static_cast<char>(dice.Next());
  return garbage;
}

std::string Truncate(std::string& bytes, Dice& dice) {
  bytes.resize(dice.Below(bytes.size()));
  return "cut at byte " + std::to_string(bytes.size());
}

std::string FlipBits(std::string& bytes, Dice& dice) {
  const std::size_t count = 1 + dice.Below(8);
  for (std::size_t i = 0; i < count; ++i)
    bytes[dice.Below(bytes.size())] ^= static_cast<char>(1 << dice.Below(8));
  return std::to_string(count) + " bits flipped";
}

std::string Overwrite(std::string& bytes, Dice& dice) {
  const std::size_t at = dice.Below(bytes.size());
  const std::size_t length = std::min(bytes.size() - at, 1 + dice.Below(16));
  constexpr const char* kFill[] = {"zeros", "ones", "garbage"};
  const std::string kind = dice.Pick(kFill);
  const std::string fill = kind == "zeros"  ? std::string(length, '\0')
                           : kind == "ones" ? std::string(length, '\xff')
                                            : UsualGarbage(dice, length);
  bytes.replace(at, length, fill);
  return kind + " at byte " + std::to_string(at);
}

std::string MoveBlock(std::string& bytes, Dice& dice) {
  const std::size_t from = dice.Below(bytes.size());
  const std::string block = bytes.substr(from, 1 + dice.Below(4096));
  const bool keep = dice.OneIn(2);
  if (!keep) bytes.erase(from, block.size());
  bytes.insert(dice.Below(bytes.size() + 1), block);
  return std::to_string(block.size()) + (keep ? " bytes twice" : " bytes elsewhere");
}

std::string Reencode(std::string& bytes, Dice& dice) {
  switch (dice.Below(4)) {
    case 0: {
      std::string wide = "\xff\xfe";
      for (const char c : bytes) wide.append({c, '\0'});
      bytes = std::move(wide);
      return "UTF-16";
    }
    case 1:
      bytes.insert(0, "\xef\xbb\xbf");
      return "a byte-order mark";
    case 2:
      std::replace(bytes.begin(), bytes.end(), '\n', '\r');
      return "line ends of CR alone";
    default: {
      const std::size_t at = dice.Below(bytes.size());
      bytes.insert(at, UsualGarbage(dice, 1 + dice.Below(64)));
      return "garbage put in at byte " + std::to_string(at);
    }
  }
}

}  // namespace

Dice::Dice(std::uint64_t seed, std::uint64_t index) : state_(seed * 0x9e3779b97f4a7c15 + index) {
  Next();
}

// SplitMix64 (Steele, Lea and Flood, 2014).
std::uint64_t Dice::Next() {
  std::uint64_t z = state_ += 0x9e3779b97f4a7c15;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
  z = (z ^ z >> 27) * 0x94d049bb133111eb;
  return z ^ z >> 31;
}

std::size_t Dice::Below(std::size_t below) {
  return below == 0 ? 0 : static_cast<std::size_t>(Next() % below);
}

std::string MutateBytes(std::string& bytes, Dice& dice) {
  if (bytes.empty()) {
    bytes = UsualGarbage(dice, 64);
    return "garbage";
  }
  switch (dice.Below(8)) {
    case 0:
      return Truncate(bytes, dice);
    case 1:
      return Reencode(bytes, dice);
    case 2:
    case 3:
      return MoveBlock(bytes, dice);
    case 4:
      return Overwrite(bytes, dice);
    default:
      return FlipBits(bytes, dice);
  }
}

Mutant MakeMutant(std::string_view original, std::uint64_t seed, std::uint64_t index) {
  Dice dice(seed, index);
  Mutant mutant{std::string(original), ""};
  const bool step = original.substr(0, 4096).find("ISO-10303-21") != std::string_view::npos;
  const bool iges = original.size() > 73 && original[72] == 'S';
  const bool gltf = original.starts_with("glTF");
  const std::size_t changes = 1 + (dice.OneIn(2) ? dice.Below(4) : 0);
  for (std::size_t i = 0; i < changes && mutant.bytes.size() <= kMaxBytes; ++i) {
    std::string what;
    if (!dice.OneIn(4)) {
      what = step   ? MutateStep(mutant.bytes, dice)
             : iges ? MutateIges(mutant.bytes, dice)
             : gltf ? MutateGltf(mutant.bytes, dice)
                    : "";
    }
    if (what.empty()) what = MutateBytes(mutant.bytes, dice);
    mutant.what += (i > 0 ? "; " : "") + what;
  }
  return mutant;
}

}  // namespace facetless

#include "import/step_text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <unordered_map>

#include "import/step_repair.h"

namespace facetless {
namespace {

bool IsWord(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
}

// Returns whether the word is one of those that printf and similar functions write for NaN and infinity.
bool IsNotFinite(std::string_view word) {
  std::string upper;
  for (char c : word) upper += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  constexpr std::array<std::string_view, 6> kNames{"NAN", "INF", "INFINITY", "IND", "QNAN", "SNAN"};
  return std::find(kNames.begin(), kNames.end(), upper) != kNames.end();
}

// The largest power of ten that a number may have. The square of a larger number overflows, and OpenCASCADE
// may run forever on it.
constexpr int kGreatestExponent = 150;

// The deepest nesting of lists. No entity of the standard needs ten levels, and OpenCASCADE's parser recurses
// for each.
constexpr int kDeepestList = 200;
// The largest number of oriented edges that refer to each other in a chain.
constexpr int kMostOrientations = 16;

// Scans the text once, outside strings and comments.
class Scanner {
 public:
  Scanner(const std::string& name, std::string_view text) : name_(name), text_(text) {}

  Result<StepFacts> Run() {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '\'') {
        const std::string string = TakeString();
        if (expects_schema_ && facts_.schema.empty())
          facts_.schema = string.substr(0, string.find_first_of(" {"));
      } else if (c == '/' && at_ + 1 < text_.size() && text_[at_ + 1] == '*') {
        const std::size_t end = text_.find("*/", at_ + 2);
        at_ = end == std::string_view::npos ? text_.size() : end + 2;
      } else if (c == '#') {
        TakeReference();
      } else if (c == '.' && at_ > 0 && !IsNumeral(text_[at_ - 1]) && at_ + 1 < text_.size() &&
                 std::isalpha(static_cast<unsigned char>(text_[at_ + 1]))) {
        // Skip an enumerator: .NAME.
        ++at_;
        TakeWord();
        if (at_ < text_.size() && text_[at_] == '.') ++at_;
      } else if ((c == 'E' || c == 'e') && at_ > 0 && IsNumeral(text_[at_ - 1])) {
        if (const int exponent = TakeExponent(); in_data_ && exponent > kGreatestExponent) {
          return Error{ErrorCode::kNotFinite,
                       name_ + ": entity #" + std::to_string(id_) + " holds a number of 1e" +
                           std::to_string(exponent) +
                           ", which is too large to compute with; export the model again."};
        }
      } else if (std::isalpha(static_cast<unsigned char>(c))) {
        const std::string_view word = TakeWord();
        if (in_data_ && IsNotFinite(word)) {
          return Error{ErrorCode::kNotFinite, name_ + ": entity #" + std::to_string(id_) + " holds \"" +
                                                  std::string(word) +
                                                  "\" where a number is needed; export the model again."};
        }
        TakeKeyword(word);
      } else {
        ++at_;
        if (c == '(' && ++depth_ > kDeepestList) {
          return Error{ErrorCode::kFormatBroken, name_ + ": entity #" + std::to_string(id_) +
                                                     " holds lists that are nested more than " +
                                                     std::to_string(kDeepestList) +
                                                     " deep; export the model again."};
        }
        if (c == ')') --depth_;
        if (c == ';') {
          depth_ = 0;
          expects_schema_ = in_oriented_edge_ = false;
          facts_.complete_bytes = at_;
          facts_.last_entity = id_;
        }
      }
    }
    if (const std::uint64_t id = EdgeOfItself(); id != 0)
      return Error{ErrorCode::kFormatBroken, name_ + ": oriented edge #" + std::to_string(id) +
                                                 " refers to itself; export the model again."};
    if (!in_data_)
      return Error{ErrorCode::kFormatBroken,
                   name_ + " is a STEP file without a DATA section; it may have been cut off."};
    facts_.cut_off = !ended_;
    return facts_;
  }

 private:
  // Returns whether a new entity begins after the semicolon at `at`. No text continues like that.
  bool EntityFollows(std::size_t at) const {
    ++at;
    while (at < text_.size() && std::isspace(static_cast<unsigned char>(text_[at]))) ++at;
    if (at >= text_.size() || text_[at] != '#') return false;
    ++at;
    while (at < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at]))) ++at;
    while (at < text_.size() && std::isspace(static_cast<unsigned char>(text_[at]))) ++at;
    return at < text_.size() && text_[at] == '=';
  }

  std::string TakeString() {
    std::string out;
    ++at_;
    while (true) {
      if (at_ >= text_.size() || (text_[at_] == ';' && EntityFollows(at_))) {
        ++facts_.open_strings;
        return out;
      }
      if (text_[at_] == '\'') {
        if (at_ + 1 < text_.size() && text_[at_ + 1] == '\'') {
          ++at_;
        } else {
          ++at_;
          return out;
        }
      }
      out += text_[at_++];
    }
  }

  std::string_view TakeWord() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && IsWord(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
  }

  // "#12 =" begins an entity; "#12" elsewhere is a reference to one.
  void TakeReference() {
    ++at_;
    std::uint64_t id = 0;
    while (at_ < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at_])))
      id = id * 10 + (text_[at_++] - '0');
    std::size_t next = at_;
    while (next < text_.size() && std::isspace(static_cast<unsigned char>(text_[next]))) ++next;
    if (next >= text_.size() || text_[next] != '=') {
      if (in_oriented_edge_) edge_of_[id_] = id;
      return;
    }
    id_ = id;
    ++facts_.entities;
    at_ = next + 1;
  }

  // Returns an oriented edge that refers to itself, directly or indirectly; 0 if there is none. OpenCASCADE
  // would follow such a cycle until its stack overflows.
  std::uint64_t EdgeOfItself() const {
    for (const auto& [id, edge] : edge_of_) {
      auto at = edge_of_.find(edge);
      // The standard allows no chain at all. A longer chain than this is treated as a cycle.
      for (int steps = 0; at != edge_of_.end(); ++steps) {
        if (steps == kMostOrientations) return id;
        at = edge_of_.find(at->second);
      }
    }
    return 0;
  }

  static bool IsNumeral(char c) { return c == '.' || std::isdigit(static_cast<unsigned char>(c)); }

  // Reads the exponent of a number whose E is next. 9999 stands for all larger exponents.
  int TakeExponent() {
    ++at_;
    const bool negative = at_ < text_.size() && text_[at_] == '-';
    if (negative || (at_ < text_.size() && text_[at_] == '+')) ++at_;
    int exponent = 0;
    for (; at_ < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at_])); ++at_)
      exponent = std::min(10 * exponent + (text_[at_] - '0'), 9999);
    return negative ? -exponent : exponent;
  }

  void TakeKeyword(std::string_view word) {
    if (word == "DATA") in_data_ = true;
    if (word == "ENDSEC" && in_data_) ended_ = true;
    if (word == "FILE_SCHEMA") expects_schema_ = true;
    if (word == "ORIENTED_EDGE") in_oriented_edge_ = true;
    if (word == "PCURVE") facts_.has_pcurves = true;
    if (word.starts_with("TESSELLATED_") || word.starts_with("TRIANGULATED_")) facts_.has_tessellation = true;
  }

  const std::string& name_;
  std::string_view text_;
  std::size_t at_ = 0;
  std::uint64_t id_ = 0;
  int depth_ = 0;  // nesting depth of lists
  // Oriented edges → the last entity that they refer to.
  std::unordered_map<std::uint64_t, std::uint64_t> edge_of_;
  bool in_oriented_edge_ = false;
  bool in_data_ = false, expects_schema_ = false, ended_ = false;
  StepFacts facts_;
};

}  // namespace

Result<StepFacts> ScanStep(const std::string& name, std::string_view bytes) {
  Result<StepFacts> facts = Scanner(name, bytes).Run();
  if (facts.ok()) facts.value().faces = DeclaredFaces(bytes);
  return facts;
}

std::string StepFormatName(const std::string& schema) {
  const auto is = [&](std::string_view prefix) { return schema.starts_with(prefix); };
  if (is("CONFIG_CONTROL_DESIGN") || is("AP203")) return "STEP AP203";
  if (is("AUTOMOTIVE_DESIGN") || is("AP214")) return "STEP AP214";
  if (is("AP242")) return "STEP AP242";
  return schema.empty() ? "STEP" : "STEP " + schema;
}

}  // namespace facetless

#include "import/step_text.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace facetless {
namespace {

bool IsWord(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
}

// Tokens that printf and its relatives write for what is no number.
bool IsNotFinite(std::string_view word) {
  std::string upper;
  for (char c : word) upper += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  constexpr std::array<std::string_view, 6> kNames{"NAN", "INF", "INFINITY", "IND", "QNAN", "SNAN"};
  return std::find(kNames.begin(), kNames.end(), upper) != kNames.end();
}

// Walks over the text once, outside strings and comments.
class Scanner {
 public:
  Scanner(const std::string& name, std::string_view text) : name_(name), text_(text) {}

  Result<StepFacts> Run() {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '\'') {
        const std::string string = TakeString();
        if (expects_name_) facts_.faces.push_back({id_, string});
        if (expects_schema_ && facts_.schema.empty())
          facts_.schema = string.substr(0, string.find_first_of(" {"));
        expects_name_ = false;
      } else if (c == '/' && at_ + 1 < text_.size() && text_[at_ + 1] == '*') {
        const std::size_t end = text_.find("*/", at_ + 2);
        at_ = end == std::string_view::npos ? text_.size() : end + 2;
      } else if (c == '#') {
        TakeReference();
      } else if (c == '.' && at_ + 1 < text_.size() &&
                 std::isalpha(static_cast<unsigned char>(text_[at_ + 1]))) {
        // An enumerator: .NAME.
        ++at_;
        TakeWord();
        if (at_ < text_.size() && text_[at_] == '.') ++at_;
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
        if (c == ';') {
          expects_name_ = expects_schema_ = false;
          facts_.complete_bytes = at_;
          facts_.last_entity = id_;
        }
      }
    }
    if (!in_data_)
      return Error{ErrorCode::kFormatBroken,
                   name_ + " is a STEP file without a DATA section; it may have been cut off."};
    facts_.cut_off = !ended_;
    return facts_;
  }

 private:
  // True if a new entity begins after the semicolon at `at`: no text goes on like that.
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

  // #12 = … begins an entity; #12 elsewhere is a reference to one.
  void TakeReference() {
    ++at_;
    std::uint64_t id = 0;
    while (at_ < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at_])))
      id = id * 10 + (text_[at_++] - '0');
    std::size_t next = at_;
    while (next < text_.size() && std::isspace(static_cast<unsigned char>(text_[next]))) ++next;
    if (next >= text_.size() || text_[next] != '=') return;
    id_ = id;
    ++facts_.entities;
    at_ = next + 1;
  }

  void TakeKeyword(std::string_view word) {
    if (word == "DATA") in_data_ = true;
    if (word == "ENDSEC" && in_data_) ended_ = true;
    if (word == "FILE_SCHEMA") expects_schema_ = true;
    if (word == "ADVANCED_FACE" || word == "FACE_SURFACE") expects_name_ = true;
    if (word == "PCURVE") facts_.has_pcurves = true;
    if (word.starts_with("TESSELLATED_") || word.starts_with("TRIANGULATED_")) facts_.has_tessellation = true;
  }

  const std::string& name_;
  std::string_view text_;
  std::size_t at_ = 0;
  std::uint64_t id_ = 0;
  bool in_data_ = false, expects_name_ = false, expects_schema_ = false, ended_ = false;
  StepFacts facts_;
};

}  // namespace

Result<StepFacts> ScanStep(const std::string& name, std::string_view bytes) {
  return Scanner(name, bytes).Run();
}

std::string StepFormatName(const std::string& schema) {
  const auto is = [&](std::string_view prefix) { return schema.starts_with(prefix); };
  if (is("CONFIG_CONTROL_DESIGN") || is("AP203")) return "STEP AP203";
  if (is("AUTOMOTIVE_DESIGN") || is("AP214")) return "STEP AP214";
  if (is("AP242")) return "STEP AP242";
  return schema.empty() ? "STEP" : "STEP " + schema;
}

}  // namespace facetless

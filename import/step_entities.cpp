#include "import/step_entities.h"

#include <algorithm>
#include <cctype>
#include <charconv>

namespace facetless {
namespace {

bool IsSpace(char c) {
  return std::isspace(static_cast<unsigned char>(c)) != 0;
}
bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}
bool IsWord(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

// Skips blanks and comments.
std::size_t SkipBlanks(std::string_view text, std::size_t at) {
  while (at < text.size()) {
    if (IsSpace(text[at])) {
      ++at;
    } else if (text[at] == '/' && at + 1 < text.size() && text[at + 1] == '*') {
      const std::size_t end = text.find("*/", at + 2);
      at = end == std::string_view::npos ? text.size() : end + 2;
    } else {
      break;
    }
  }
  return at;
}

// If an entity ("#12 =") begins at `at`, returns the position behind the equals sign; otherwise 0.
std::size_t EntityBegin(std::string_view text, std::size_t at, std::uint64_t& id) {
  if (at >= text.size() || text[at] != '#') return 0;
  const std::size_t digits = ++at;
  id = 0;
  while (at < text.size() && IsDigit(text[at])) id = id * 10 + static_cast<std::uint64_t>(text[at++] - '0');
  if (at == digits) return 0;
  at = SkipBlanks(text, at);
  return at < text.size() && text[at] == '=' ? at + 1 : 0;
}

// Returns the position behind the closing apostrophe of the text that begins at `at`. A text that is not
// closed ends where a new entity begins.
std::size_t SkipString(std::string_view text, std::size_t at) {
  for (++at; at < text.size(); ++at) {
    if (text[at] == ';') {
      // Skip blanks only. If comments were skipped, too, each semicolon would scan the same comment again.
      std::size_t next = at + 1;
      while (next < text.size() && IsSpace(text[next])) ++next;
      std::uint64_t ignored;
      if (EntityBegin(text, next, ignored) != 0) return at;
    }
    if (text[at] != '\'') continue;
    if (at + 1 < text.size() && text[at + 1] == '\'') {
      ++at;
    } else {
      return at + 1;
    }
  }
  return at;
}

// Returns the position behind the semicolon that ends the statement.
std::size_t StatementEnd(std::string_view text, std::size_t at) {
  while (at < text.size()) {
    if (text[at] == '\'') {
      at = SkipString(text, at);
    } else if (text[at] == '/' && at + 1 < text.size() && text[at + 1] == '*') {
      at = SkipBlanks(text, at);
    } else if (text[at++] == ';') {
      return at;
    }
  }
  return std::string_view::npos;
}

std::string_view WordAt(std::string_view text, std::size_t at) {
  const std::size_t begin = at;
  while (at < text.size() && IsWord(text[at])) ++at;
  return text.substr(begin, at - begin);
}

// Parses one entity's body by recursive descent. The depth of lists was checked before (step_text.h).
class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  std::optional<StepRecord> Record() {
    StepRecord record;
    Skip();
    if (at_ < text_.size() && text_[at_] == '(') {
      record.complex = true;
      ++at_;
      for (Skip(); at_ < text_.size() && text_[at_] != ')'; Skip()) {
        if (!Part(record)) return {};
      }
      if (at_ >= text_.size()) return {};
      ++at_;
    } else if (!Part(record)) {
      return {};
    }
    Skip();
    if (at_ != text_.size() || record.parts.empty()) return {};
    return record;
  }

 private:
  void Skip() { at_ = SkipBlanks(text_, at_); }

  bool Part(StepRecord& record) {
    StepPart part;
    part.keyword = WordAt(text_, at_);
    if (part.keyword.empty()) return false;
    at_ += part.keyword.size();
    Skip();
    if (at_ >= text_.size() || text_[at_] != '(' || !List(part.values)) return false;
    record.parts.push_back(std::move(part));
    return true;
  }

  // Parses from an opening parenthesis to the position behind the closing one.
  bool List(std::vector<StepValue>& values) {
    if (depth_ == kDeepestList) return false;
    ++depth_;
    const bool closed = Elements(values);
    --depth_;
    return closed;
  }

  bool Elements(std::vector<StepValue>& values) {
    ++at_;
    Skip();
    if (at_ < text_.size() && text_[at_] == ')') {
      ++at_;
      return true;
    }
    while (true) {
      StepValue value;
      if (!Value(value)) return false;
      values.push_back(std::move(value));
      Skip();
      if (at_ >= text_.size()) return false;
      const char c = text_[at_++];
      if (c == ')') return true;
      if (c != ',') return false;
    }
  }

  bool Value(StepValue& value) {
    using Kind = StepValue::Kind;
    Skip();
    if (at_ >= text_.size()) return false;
    const char c = text_[at_];
    if (c == '#') {
      value.kind = Kind::kReference;
      const std::size_t begin = at_++;
      while (at_ < text_.size() && IsDigit(text_[at_]))
        value.reference = value.reference * 10 + static_cast<std::uint64_t>(text_[at_++] - '0');
      value.text = text_.substr(begin, at_ - begin);
    } else if (c == '\'') {
      value.kind = Kind::kString;
      const std::size_t end = SkipString(text_, at_);
      if (end < at_ + 2 || text_[end - 1] != '\'') return false;
      value.text = text_.substr(at_ + 1, end - at_ - 2);
      at_ = end;
    } else if (c == '$' || c == '*') {
      value.kind = c == '$' ? Kind::kUnset : Kind::kDerived;
      ++at_;
    } else if (c == '(') {
      value.kind = Kind::kList;
      return List(value.items);
    } else if (c == '.' && at_ + 1 < text_.size() &&
               std::isalpha(static_cast<unsigned char>(text_[at_ + 1]))) {
      value.kind = Kind::kEnum;
      ++at_;
      value.text = WordAt(text_, at_);
      at_ += value.text.size();
      // Some writers put a typed value between full stops. It is no enumerator then.
      if (at_ >= text_.size() || text_[at_] != '.') return false;
      ++at_;
    } else if (std::isalpha(static_cast<unsigned char>(c))) {
      value.kind = Kind::kTyped;
      value.text = WordAt(text_, at_);
      at_ += value.text.size();
      Skip();
      return at_ < text_.size() && text_[at_] == '(' && List(value.items);
    } else {
      value.kind = Kind::kNumber;
      const std::size_t begin = at_;
      while (at_ < text_.size() && text_[at_] != ',' && text_[at_] != ')' && text_[at_] != '(' &&
             !IsSpace(text_[at_]))
        ++at_;
      value.text = text_.substr(begin, at_ - begin);
      return at_ > begin;
    }
    return true;
  }

  // The same limit as in the scanner of files (step_text.cpp).
  static constexpr int kDeepestList = 200;

  std::string_view text_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

void Append(const std::vector<StepValue>& values, std::string& out) {
  out += '(';
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) out += ',';
    out += ToText(values[i]);
  }
  out += ')';
}

}  // namespace

double StepValue::Number(double otherwise) const {
  if (kind == Kind::kTyped && items.size() == 1) return items.front().Number(otherwise);
  if (kind != Kind::kNumber) return otherwise;
  std::string_view digits = text;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  double value = otherwise;
  const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return parsed.ec == std::errc{} ? value : otherwise;
}

std::vector<double> StepValue::Numbers() const {
  std::vector<double> numbers;
  numbers.reserve(items.size());
  for (const StepValue& item : items) numbers.push_back(item.Number(0));
  return numbers;
}

const StepPart* StepRecord::Find(std::string_view keyword) const {
  const auto part =
      std::find_if(parts.begin(), parts.end(), [&](const StepPart& p) { return p.keyword == keyword; });
  return part == parts.end() ? nullptr : &*part;
}

StepEntities::StepEntities(std::string_view bytes) : bytes_(bytes) {
  bool in_data = false, after_end = false;
  std::size_t at = 0;
  while (true) {
    at = SkipBlanks(bytes, at);
    if (at >= bytes.size()) break;
    StepEntity entity;
    const std::size_t body = in_data ? EntityBegin(bytes, at, entity.id) : 0;
    const std::string_view word = body == 0 ? WordAt(bytes, at) : std::string_view();
    const std::size_t end = StatementEnd(bytes, body == 0 ? at : body);
    if (end == std::string_view::npos) break;
    if (body != 0) {
      entity.begin = at;
      entity.body_begin = body;
      entity.end = end;
      entity.keyword = WordAt(bytes, SkipBlanks(bytes, body));
      entity.structure = structures_ - 1;
      if (structures_ == 1) {
        index_.try_emplace(entity.id, entities_.size());
        largest_id_ = std::max(largest_id_, entity.id);
      }
      entities_.push_back(entity);
    } else if (word == "DATA") {
      in_data = true;
    } else if (word == "ENDSEC") {
      if (in_data && structures_ == 1) data_end_ = at;
      in_data = false;
    } else if (bytes.substr(at, 16) == "END-ISO-10303-21") {
      if (first_structure_end_ == 0) first_structure_end_ = end;
      after_end = true;
      in_data = false;
    } else if (bytes.substr(at, 12) == "ISO-10303-21" && after_end) {
      ++structures_;
      after_end = false;
    }
    at = end;
  }
}

const StepEntity* StepEntities::Find(std::uint64_t id) const {
  const auto known = index_.find(id);
  return known == index_.end() ? nullptr : &entities_[known->second];
}

std::optional<StepRecord> StepEntities::Record(const StepEntity& entity) const {
  return ParseStepRecord(entity.Body(bytes_));
}

std::optional<StepRecord> StepEntities::Record(std::uint64_t id) const {
  const StepEntity* entity = Find(id);
  return entity ? Record(*entity) : std::nullopt;
}

std::optional<StepRecord> ParseStepRecord(std::string_view body) {
  return Parser(body).Record();
}

std::string ToText(const StepValue& value) {
  using Kind = StepValue::Kind;
  std::string text;
  switch (value.kind) {
    case Kind::kReference:
      return "#" + std::to_string(value.reference);
    case Kind::kString:
      return text.append("'").append(value.text).append("'");
    case Kind::kEnum:
      return text.append(".").append(value.text).append(".");
    case Kind::kUnset:
      return "$";
    case Kind::kDerived:
      return "*";
    case Kind::kNumber:
      return std::string(value.text);
    case Kind::kTyped:
      text = value.text;
      [[fallthrough]];
    case Kind::kList:
      Append(value.items, text);
  }
  return text;
}

std::string ToText(const StepRecord& record) {
  std::string text = record.complex ? "(" : "";
  for (const StepPart& part : record.parts) {
    text += part.keyword;
    Append(part.values, text);
  }
  return record.complex ? text + ")" : text;
}

}  // namespace facetless

// The entities of a STEP file as text: where each begins and ends, its keyword, and its attributes as a tree.
//
// Example:
//   const StepEntities entities(bytes);
//   for (const StepEntity& entity : entities.all())
//     if (entity.keyword == "EDGE_LOOP") { auto record = ParseStepRecord(entity.Body(bytes)); … }
//
//  1. The text is never copied. Views point into the bytes that were passed, which must outlive them.
//  2. No function fails: text that is no entity is skipped, and an entity that cannot be parsed has no
//     record.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace facetless {

struct StepEntity {
  std::uint64_t id = 0;        // #id
  std::size_t begin = 0;       // position of '#'
  std::size_t body_begin = 0;  // position behind '='
  std::size_t end = 0;         // position behind ';'
  std::string_view keyword;    // "ADVANCED_FACE"; empty for an entity of several parts
  // Index of the exchange structure (ISO-10303-21 … END-ISO-10303-21) that contains it.
  std::uint32_t structure = 0;
  std::string_view Body(std::string_view bytes) const {
    return bytes.substr(body_begin, end - 1 - body_begin);
  }
};

struct StepValue {
  enum class Kind {
    kReference,  // #12
    kString,     // 'text'; `text` holds it as written, without the apostrophes
    kEnum,       // .T.; `text` holds "T"
    kUnset,      // $
    kDerived,    // *
    kList,       // (…)
    kTyped,      // LENGTH_MEASURE(1.); `text` holds the name
    kNumber,     // a number, or anything else without blanks
  };
  Kind kind = Kind::kUnset;
  std::string_view text;
  std::uint64_t reference = 0;
  std::vector<StepValue> items;  // elements of a list, or of a typed value

  bool IsList() const { return kind == Kind::kList; }
  bool IsReference() const { return kind == Kind::kReference; }
  // Returns the number; `otherwise` if the value is no number.
  double Number(double otherwise) const;
  // Returns the numbers of a list of numbers.
  std::vector<double> Numbers() const;
};

struct StepPart {
  std::string_view keyword;
  std::vector<StepValue> values;
};

struct StepRecord {
  std::vector<StepPart> parts;  // one part, or several for a complex entity
  bool complex = false;

  // Returns the part with that name; null if there is none.
  const StepPart* Find(std::string_view keyword) const;
};

class StepEntities {
 public:
  explicit StepEntities(std::string_view bytes);

  const std::vector<StepEntity>& all() const { return entities_; }
  // Returns the first entity with that id within the first exchange structure; null if there is none.
  const StepEntity* Find(std::uint64_t id) const;
  std::optional<StepRecord> Record(const StepEntity& entity) const;
  std::optional<StepRecord> Record(std::uint64_t id) const;

  std::string_view bytes() const { return bytes_; }
  std::uint64_t largest_id() const { return largest_id_; }
  // The number of exchange structures in the file, and the position behind the last line of the first one.
  std::uint32_t structures() const { return structures_; }
  std::size_t first_structure_end() const { return first_structure_end_; }
  bool has_end() const { return first_structure_end_ != 0; }
  // The position of the ENDSEC that ends the last data section of the first exchange structure; 0 if it has
  // none.
  std::size_t data_end() const { return data_end_; }

 private:
  std::string_view bytes_;
  std::vector<StepEntity> entities_;
  std::unordered_map<std::uint64_t, std::size_t> index_;
  std::uint64_t largest_id_ = 0;
  std::uint32_t structures_ = 1;
  std::size_t first_structure_end_ = 0, data_end_ = 0;
};

// Returns an entity's attributes; nothing if its parentheses or texts are not closed.
std::optional<StepRecord> ParseStepRecord(std::string_view body);

// Returns the record as STEP text.
std::string ToText(const StepRecord& record);
std::string ToText(const StepValue& value);

// Calls `visit(id)` for each reference in a body, except in texts and comments.
template <typename Visit>
void ForEachReference(std::string_view body, Visit visit) {
  for (std::size_t at = 0; at < body.size(); ++at) {
    if (body[at] == '\'') {
      // An apostrophe within a text is doubled. What follows it is treated as another text, which does no
      // harm.
      at = body.find('\'', at + 1);
      if (at == std::string_view::npos) return;
    } else if (body[at] == '/' && at + 1 < body.size() && body[at + 1] == '*') {
      at = body.find("*/", at + 2);
      if (at == std::string_view::npos) return;
    } else if (body[at] == '#') {
      std::uint64_t id = 0;
      while (at + 1 < body.size() && body[at + 1] >= '0' && body[at + 1] <= '9')
        id = id * 10 + static_cast<std::uint64_t>(body[++at] - '0');
      visit(id);
    }
  }
}

}  // namespace facetless

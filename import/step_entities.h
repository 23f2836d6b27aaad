// The entities of a STEP file as text: where each begins and ends, what it is called, and its attributes as a
// tree.
//
// Example:
//   const StepEntities entities(bytes);
//   for (const StepEntity& entity : entities.all())
//     if (entity.keyword == "EDGE_LOOP") { auto record = ParseStepRecord(entity.Body(bytes)); … }
//
//  1. The text is never copied: views point into the bytes that were given, which must outlive them.
//  2. Nothing fails: what is no entity is passed over, and what cannot be parsed has no record.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace facetless {

struct StepEntity {
  std::uint64_t id = 0;         // #id
  std::size_t begin = 0;        // of '#'
  std::size_t body_begin = 0;   // behind '='
  std::size_t end = 0;          // behind ';'
  std::string_view keyword;     // "ADVANCED_FACE"; empty for an entity of several parts
  std::uint32_t structure = 0;  // which exchange structure (ISO-10303-21 … END-ISO-10303-21) it stands in
  std::string_view Body(std::string_view bytes) const {
    return bytes.substr(body_begin, end - 1 - body_begin);
  }
};

struct StepValue {
  enum class Kind {
    kReference,  // #12
    kString,     // 'text', text holds it without apostrophes, as written
    kEnum,       // .T., text holds "T"
    kUnset,      // $
    kDerived,    // *
    kList,       // (…)
    kTyped,      // LENGTH_MEASURE(1.), text holds the name
    kNumber,     // and whatever else is written without blanks
  };
  Kind kind = Kind::kUnset;
  std::string_view text;
  std::uint64_t reference = 0;
  std::vector<StepValue> items;  // of a list, or of a typed value

  bool IsList() const { return kind == Kind::kList; }
  bool IsReference() const { return kind == Kind::kReference; }
  // The number that is written; `otherwise` if it is none.
  double Number(double otherwise) const;
  // The numbers of a list of numbers.
  std::vector<double> Numbers() const;
};

struct StepPart {
  std::string_view keyword;
  std::vector<StepValue> values;
};

struct StepRecord {
  std::vector<StepPart> parts;  // one, or several of a complex entity
  bool complex = false;

  // The part of that name; null if there is none.
  const StepPart* Find(std::string_view keyword) const;
};

class StepEntities {
 public:
  explicit StepEntities(std::string_view bytes);

  const std::vector<StepEntity>& all() const { return entities_; }
  // The first entity of that id within the first exchange structure; null if there is none.
  const StepEntity* Find(std::uint64_t id) const;
  std::optional<StepRecord> Record(const StepEntity& entity) const;
  std::optional<StepRecord> Record(std::uint64_t id) const;

  std::string_view bytes() const { return bytes_; }
  std::uint64_t largest_id() const { return largest_id_; }
  // Exchange structures that the file holds, one after the other; and where the first one ends, behind its
  // last line.
  std::uint32_t structures() const { return structures_; }
  std::size_t first_structure_end() const { return first_structure_end_; }
  bool has_end() const { return first_structure_end_ != 0; }
  // Where the last data section of the first exchange structure ends: at its ENDSEC; 0 if it has none.
  std::size_t data_end() const { return data_end_; }

 private:
  std::string_view bytes_;
  std::vector<StepEntity> entities_;
  std::unordered_map<std::uint64_t, std::size_t> index_;
  std::uint64_t largest_id_ = 0;
  std::uint32_t structures_ = 1;
  std::size_t first_structure_end_ = 0, data_end_ = 0;
};

// An entity's attributes; nothing if its parentheses or texts are not closed.
std::optional<StepRecord> ParseStepRecord(std::string_view body);

// As it would be written in a file.
std::string ToText(const StepRecord& record);
std::string ToText(const StepValue& value);

// Calls `visit(id)` for each reference of a body, texts and comments left out.
template <typename Visit>
void ForEachReference(std::string_view body, Visit visit) {
  for (std::size_t at = 0; at < body.size(); ++at) {
    if (body[at] == '\'') {
      // An apostrophe within a text is doubled: what follows it is taken for another text, which does no
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

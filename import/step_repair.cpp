#include "import/step_repair.h"

#include <set>

#include "import/step_repairer.h"

namespace facetless::step_repair {

namespace {

// OpenCASCADE's scanner holds texts of up to 16,383 bytes; the standard allows 32,769 characters. Texts of
// this length are always names.
constexpr std::size_t kLongestText = 16350;

constexpr std::array<std::string_view, 22> kSurfaces{"PLANE",
                                                     "CYLINDRICAL_SURFACE",
                                                     "CONICAL_SURFACE",
                                                     "SPHERICAL_SURFACE",
                                                     "TOROIDAL_SURFACE",
                                                     "DEGENERATE_TOROIDAL_SURFACE",
                                                     "B_SPLINE_SURFACE",
                                                     "B_SPLINE_SURFACE_WITH_KNOTS",
                                                     "RATIONAL_B_SPLINE_SURFACE",
                                                     "BEZIER_SURFACE",
                                                     "UNIFORM_SURFACE",
                                                     "QUASI_UNIFORM_SURFACE",
                                                     "SURFACE_OF_REVOLUTION",
                                                     "SURFACE_OF_LINEAR_EXTRUSION",
                                                     "OFFSET_SURFACE",
                                                     "RECTANGULAR_TRIMMED_SURFACE",
                                                     "CURVE_BOUNDED_SURFACE",
                                                     "RECTANGULAR_COMPOSITE_SURFACE",
                                                     "SURFACE_REPLICA",
                                                     "ORIENTED_SURFACE",
                                                     "BOUNDED_SURFACE",
                                                     "DUPIN_CYCLIDE_SURFACE"};

}  // namespace

StepRepair Repairer::Run() {
  DropOtherStructures();
  DropDuplicates();
  for (const StepEntity& entity : entities_.all()) {
    if (entity.structure == 0 && !dropped_.contains(&entity)) Check(entity);
  }
  LeaveOutSpurs();
  TakeOut();
  MapReplicas();
  MapOperators();
  FindUnread();
  FindUnplaced();
  CheckUnits();
  if (entities_.structures() == 1 && !entities_.has_end() && entities_.data_end() != 0)
    Warn("The file's last line, END-ISO-10303-21, is missing; it may have been cut off.");
  Write();
  return std::move(repair_);
}

void Repairer::Warn(std::string sentence) {
  // The same fault may occur in every entity of a file. A hundred reports are enough.
  constexpr std::size_t kMostWarnings = 100;
  ++warned_;
  if (warned_ < kMostWarnings) repair_.warnings.push_back(std::move(sentence));
  if (warned_ == kMostWarnings) repair_.warnings.push_back("More repairs were made than are listed.");
}

std::optional<StepRecord> Repairer::Record(std::uint64_t id) const {
  const StepEntity* entity = entities_.Find(id);
  return entity ? FindStepRecord(*entity) : std::nullopt;
}

std::optional<StepRecord> Repairer::FindStepRecord(const StepEntity& entity) const {
  const auto edited = edits_.find(&entity);
  return ParseStepRecord(edited != edits_.end() ? std::string_view(edited->second)
                                                : entity.Body(entities_.bytes()));
}

void Repairer::AppendShortened(std::string_view text, std::uint64_t id, std::string& out) {
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t open = text.find_first_of("'/", at);
    if (open == std::string_view::npos) break;
    out.append(text.substr(at, open - at));
    at = open;
    if (text[at] == '/') {
      const bool comment = at + 1 < text.size() && text[at + 1] == '*';
      const std::size_t end = comment ? text.find("*/", at + 2) : at;
      const std::size_t behind = !comment ? at + 1 : end == std::string_view::npos ? text.size() : end + 2;
      // The reader has no room for a long comment, either. The comment is not needed.
      if (behind - at <= kLongestText) out.append(text.substr(at, behind - at));
      at = behind;
      continue;
    }
    std::size_t end = at + 1;
    while (end < text.size() && (text[end] != '\'' || (end + 1 < text.size() && text[end + 1] == '\'')))
      end += text[end] == '\'' ? 2 : 1;
    end = std::min(end, text.size());
    const std::size_t length = end - at - 1;
    if (length <= kLongestText) {
      out.append(text.substr(at, end - at));
    } else {
      std::size_t kept = at + 1 + kLongestText;
      // Do not cut within a doubled apostrophe, a directive or a character of several bytes.
      const std::size_t directive = text.substr(0, kept).rfind("\\X");
      if (directive != std::string_view::npos && directive > at &&
          text.substr(directive, kept - directive).find("\\X0\\") == std::string_view::npos &&
          kept - directive < 4000)
        kept = directive;
      while (kept > at + 1 && (static_cast<unsigned char>(text[kept]) & 0xc0) == 0x80) --kept;
      std::size_t apostrophes = 0;
      while (kept - apostrophes > at + 1 && text[kept - apostrophes - 1] == '\'') ++apostrophes;
      if (apostrophes % 2 == 1) --kept;
      out.append(text.substr(at, kept - at));
      repair_.changed = true;
      Warn("A text of " + std::to_string(length) + " bytes" + (id == 0 ? "" : " in entity " + Label(id)) +
           " was cut to its first " + std::to_string(kept - at - 1) + ".");
    }
    if (end < text.size()) out += '\'';
    at = end + 1;
  }
  if (at < text.size()) out.append(text.substr(at));
}

std::string Repairer::WithAliases(const std::string& body) const {
  std::string out;
  for (std::size_t at = 0; at < body.size();) {
    if (body[at] == '\'') {
      const std::size_t end = body.find('\'', at + 1);
      const std::size_t behind = end == std::string::npos ? body.size() : end + 1;
      out.append(body, at, behind - at);
      at = behind;
    } else if (body[at] == '#') {
      std::uint64_t id = 0;
      std::size_t end = at + 1;
      while (end < body.size() && body[end] >= '0' && body[end] <= '9')
        id = id * 10 + static_cast<std::uint64_t>(body[end++] - '0');
      // An alias may refer to another alias. A cycle of aliases is followed only a limited number of times.
      for (std::size_t steps = 0; steps <= aliases_.size(); ++steps) {
        const auto alias = aliases_.find(id);
        if (alias == aliases_.end()) break;
        id = alias->second;
      }
      out += Label(id);
      at = end;
    } else {
      out += body[at++];
    }
  }
  return out;
}

void Repairer::Write() {
  const std::string_view bytes = entities_.bytes();
  const bool long_text = HasLongText();
  const bool no_end = !entities_.has_end() && entities_.data_end() != 0;
  if (edits_.empty() && gone_.empty() && dropped_.empty() && added_.empty() && aliases_.empty() &&
      !long_text && !no_end && entities_.structures() == 1)
    return;
  repair_.changed = true;
  std::string& out = repair_.bytes;
  out.reserve(bytes.size() + added_.size() + 64);
  const std::size_t stop = entities_.structures() > 1 ? entities_.first_structure_end() : bytes.size();
  std::size_t at = 0;
  const auto copy = [&](std::size_t end) {
    // New entities go to the end of the data section.
    if (!added_.empty() && at <= entities_.data_end() && entities_.data_end() < end &&
        entities_.data_end() != 0) {
      AppendShortened(bytes.substr(at, entities_.data_end() - at), 0, out);
      out += "\n" + added_;
      added_.clear();
      at = entities_.data_end();
    }
    AppendShortened(bytes.substr(at, end - at), 0, out);
    at = end;
  };
  for (const StepEntity& entity : entities_.all()) {
    if (entity.structure != 0 || entity.begin >= stop) break;
    copy(entity.begin);
    at = entity.end;
    if (gone_.contains(&entity) || dropped_.contains(&entity)) continue;
    const auto edited = edits_.find(&entity);
    std::string body = edited != edits_.end() ? edited->second : std::string(entity.Body(bytes));
    if (!aliases_.empty()) body = WithAliases(body);
    out += Label(entity.id) + "=";
    AppendShortened(body, entity.id, out);
    out += ";";
  }
  copy(stop);
  if (no_end) out += "\nEND-ISO-10303-21;\n";
}

bool Repairer::HasLongText() const {
  const std::string_view bytes = entities_.bytes();
  for (std::size_t begin = 0; (begin = bytes.find("/*", begin)) != std::string_view::npos; ++begin) {
    const std::size_t end = bytes.find("*/", begin);
    if (end == std::string_view::npos || end - begin > kLongestText) return true;
    begin = end;
  }
  std::size_t at = 0;
  while ((at = bytes.find('\'', at)) != std::string_view::npos) {
    const std::size_t end = bytes.find('\'', at + 1);
    if (end == std::string_view::npos) return bytes.size() - at > kLongestText;
    if (end - at > kLongestText) return true;
    at = end + 1;
    // A doubled apostrophe splits a text into halves here, but the length of the whole text counts.
    std::size_t begin = end;
    while (at < bytes.size() && bytes[at] == '\'') {
      const std::size_t next = bytes.find('\'', at + 1);
      if (next == std::string_view::npos || next - begin > kLongestText) return true;
      at = next + 1;
    }
  }
  return false;
}

}  // namespace facetless::step_repair

namespace facetless {

using namespace step_repair;  // NOLINT(google-build-using-namespace): its own parts

StepRepair RepairStep(std::string_view bytes) {
  return Repairer(bytes).Run();
}

std::size_t FlattenScopes(std::string& bytes) {
  constexpr std::string_view kBegin = "&SCOPE", kEnd = "ENDSCOPE";
  if (bytes.find(kBegin) == std::string::npos) return 0;
  std::string out;
  std::vector<std::string> open;          // what begins an entity, before its scope
  std::size_t scopes = 0, statement = 0;  // statement: where the last one began in `out`
  for (std::size_t at = 0; at < bytes.size();) {
    const std::string_view rest = std::string_view(bytes).substr(at);
    if (rest.front() == '\'') {
      const std::size_t end = std::min(rest.find('\'', 1), rest.size() - 1) + 1;
      out += rest.substr(0, end);
      at += end;
    } else if (rest.starts_with("/*")) {
      const std::size_t end = rest.find("*/");
      at += end == std::string_view::npos ? rest.size() : end + 2;
    } else if (rest.starts_with(kBegin)) {
      open.push_back(out.substr(statement));
      out.resize(statement);
      at += kBegin.size();
      ++scopes;
    } else if (rest.starts_with(kEnd) && !open.empty()) {
      at += kEnd.size();
      // Skip the list of exported entities.
      const std::size_t list = rest.find_first_not_of(" \t\n", kEnd.size());
      if (list != std::string_view::npos && rest[list] == '/') {
        const std::size_t end = rest.find('/', list + 1);
        at += (end == std::string_view::npos ? rest.size() : end + 1) - kEnd.size();
      }
      out += open.back();
      open.pop_back();
    } else {
      out += rest.front();
      if (rest.front() == ';') statement = out.size();
      ++at;
    }
  }
  bytes = std::move(out);
  return scopes;
}

std::vector<StepFace> DeclaredFaces(std::string_view bytes) {
  const StepEntities entities(bytes);
  std::vector<StepFace> faces;
  for (const StepEntity& entity : entities.all()) {
    if (entity.structure != 0 || entities.Find(entity.id) != &entity) continue;
    if (IsFaceKeyword(entity.keyword)) {
      const auto record = entities.Record(entity);
      faces.push_back({entity.id, record ? NameIn(*record) : "", false});
    } else if (entity.keyword.empty()) {
      // The face is an entity of several parts.
      const std::string_view body = entity.Body(bytes);
      if (body.find("FACE_SURFACE") == std::string_view::npos) continue;
      const auto record = entities.Record(entity);
      if (record && record->Find("FACE_SURFACE") != nullptr)
        faces.push_back({entity.id, NameIn(*record), false});
    } else if (entity.keyword == "GEOMETRIC_SET") {
      const auto record = entities.Record(entity);
      std::vector<std::uint64_t> elements;
      if (record && Value(*record, 1) != nullptr) ReferencesOf(*Value(*record, 1), elements);
      for (const std::uint64_t id : elements) {
        const auto element = entities.Record(id);
        if (!element) continue;
        const bool surface = std::any_of(element->parts.begin(), element->parts.end(),
                                         [](const StepPart& part) { return Holds(kSurfaces, part.keyword); });
        if (surface) faces.push_back({id, NameIn(*element), true});
      }
    }
  }
  // A surface in two sets counts once.
  std::unordered_set<std::uint64_t> seen;
  std::erase_if(faces, [&](const StepFace& face) { return !seen.insert(face.id).second; });
  return faces;
}

}  // namespace facetless

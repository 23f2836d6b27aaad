// Mends empty lists, senses, spurs of loops and entities with the same id, and removes what cannot be mended
// together with everything that depends on it.
#include "import/step_repairer.h"

#include <map>
#include <set>

namespace facetless::step_repair {

// Attributes that must be true or false.
struct Sense {
  std::string_view keyword;
  std::size_t attribute;
  const char* what;
};
constexpr std::array kSenses{Sense{"EDGE_CURVE", 4, "the sense of edge curve"},
                             Sense{"ORIENTED_EDGE", 4, "the orientation of oriented edge"},
                             Sense{"FACE_BOUND", 2, "the orientation of bound"},
                             Sense{"FACE_OUTER_BOUND", 2, "the orientation of bound"},
                             Sense{"ADVANCED_FACE", 3, "the sense of face"},
                             Sense{"FACE_SURFACE", 3, "the sense of face"},
                             Sense{"ORIENTED_FACE", 3, "the orientation of face"},
                             Sense{"ORIENTED_CLOSED_SHELL", 3, "the orientation of shell"},
                             Sense{"ORIENTED_OPEN_SHELL", 3, "the orientation of shell"},
                             Sense{"TRIMMED_CURVE", 4, "the sense of trimmed curve"}};

namespace {

// A list that needs at least one element: the keyword of its entity, the index of the attribute (the name
// counts as one), and the predicate of the report if the list is empty.
struct Needed {
  std::string_view keyword;
  std::size_t attribute;
  const char* what;
};
constexpr std::array kNeeded{
    Needed{"EDGE_LOOP", 1, "has no edges"},
    Needed{"POLY_LOOP", 1, "has no points"},
    Needed{"PATH", 1, "has no edges"},
    Needed{"OPEN_PATH", 1, "has no edges"},
    Needed{"CONNECTED_FACE_SET", 1, "has no faces"},
    Needed{"OPEN_SHELL", 1, "has no faces"},
    Needed{"CLOSED_SHELL", 1, "has no faces"},
    Needed{"WIRE_SHELL", 1, "has no loops"},
    Needed{"CONNECTED_EDGE_SET", 1, "has no edges"},
    Needed{"SHELL_BASED_SURFACE_MODEL", 1, "has no shells"},
    Needed{"FACE_BASED_SURFACE_MODEL", 1, "has no faces"},
    Needed{"SHELL_BASED_WIREFRAME_MODEL", 1, "has no shells"},
    Needed{"EDGE_BASED_WIREFRAME_MODEL", 1, "has no edges"},
    Needed{"GEOMETRIC_SET", 1, "has no elements"},
    Needed{"GEOMETRIC_CURVE_SET", 1, "has no elements"},
    Needed{"CARTESIAN_POINT", 1, "has no coordinates"},
    Needed{"DIRECTION", 1, "has no ratios"},
    Needed{"POLYLINE", 1, "has no points"},
    Needed{"COMPOSITE_CURVE", 1, "has no segments"},
    Needed{"COMPOSITE_CURVE_ON_SURFACE", 1, "has no segments"},
    Needed{"BOUNDARY_CURVE", 1, "has no segments"},
    Needed{"OUTER_BOUNDARY_CURVE", 1, "has no segments"},
    Needed{"CURVE_BOUNDED_SURFACE", 2, "has no boundaries"},
    Needed{"RECTANGULAR_COMPOSITE_SURFACE", 1, "has no segments"},
    Needed{"DEFINITIONAL_REPRESENTATION", 1, "has no items"},
    Needed{"BEZIER_CURVE", 2, "has no control points"},
    Needed{"UNIFORM_CURVE", 2, "has no control points"},
    Needed{"QUASI_UNIFORM_CURVE", 2, "has no control points"},
    Needed{"B_SPLINE_CURVE_WITH_KNOTS", 2, "has no control points"},
    Needed{"B_SPLINE_CURVE_WITH_KNOTS", 6, "has no multiplicities"},
    Needed{"B_SPLINE_CURVE_WITH_KNOTS", 7, "has no knots"},
    Needed{"BEZIER_SURFACE", 3, "has no control points"},
    Needed{"UNIFORM_SURFACE", 3, "has no control points"},
    Needed{"QUASI_UNIFORM_SURFACE", 3, "has no control points"},
    Needed{"B_SPLINE_SURFACE_WITH_KNOTS", 3, "has no control points"},
    Needed{"B_SPLINE_SURFACE_WITH_KNOTS", 8, "has no multiplicities"},
    Needed{"B_SPLINE_SURFACE_WITH_KNOTS", 9, "has no multiplicities"},
    Needed{"B_SPLINE_SURFACE_WITH_KNOTS", 10, "has no knots"},
    Needed{"B_SPLINE_SURFACE_WITH_KNOTS", 11, "has no knots"},
};
// The same for the parts of a complex entity, which have no name attribute.
constexpr std::array kNeededInParts{
    Needed{"B_SPLINE_CURVE", 1, "has no control points"},
    Needed{"B_SPLINE_CURVE_WITH_KNOTS", 0, "has no multiplicities"},
    Needed{"B_SPLINE_CURVE_WITH_KNOTS", 1, "has no knots"},
    Needed{"RATIONAL_B_SPLINE_CURVE", 0, "has no weights"},
    Needed{"B_SPLINE_SURFACE", 2, "has no control points"},
    Needed{"B_SPLINE_SURFACE_WITH_KNOTS", 0, "has no multiplicities"},
    Needed{"B_SPLINE_SURFACE_WITH_KNOTS", 1, "has no multiplicities"},
    Needed{"B_SPLINE_SURFACE_WITH_KNOTS", 2, "has no knots"},
    Needed{"B_SPLINE_SURFACE_WITH_KNOTS", 3, "has no knots"},
    Needed{"RATIONAL_B_SPLINE_SURFACE", 0, "has no weights"},
    Needed{"COMPOSITE_CURVE", 0, "has no segments"},
    Needed{"CONNECTED_FACE_SET", 0, "has no faces"},
    Needed{"PATH", 0, "has no edges"},
};

// Lists from which no element can be removed: a loop without one of its edges is another loop.
constexpr std::array<std::string_view, 22> kWhole{"EDGE_LOOP",
                                                  "POLY_LOOP",
                                                  "PATH",
                                                  "OPEN_PATH",
                                                  "ADVANCED_FACE",
                                                  "FACE_SURFACE",
                                                  "FACE",
                                                  "POLYLINE",
                                                  "COMPOSITE_CURVE",
                                                  "COMPOSITE_CURVE_ON_SURFACE",
                                                  "BOUNDARY_CURVE",
                                                  "OUTER_BOUNDARY_CURVE",
                                                  "CURVE_BOUNDED_SURFACE",
                                                  "RECTANGULAR_COMPOSITE_SURFACE",
                                                  "B_SPLINE_CURVE_WITH_KNOTS",
                                                  "B_SPLINE_SURFACE_WITH_KNOTS",
                                                  "BEZIER_CURVE",
                                                  "BEZIER_SURFACE",
                                                  "UNIFORM_CURVE",
                                                  "UNIFORM_SURFACE",
                                                  "QUASI_UNIFORM_CURVE",
                                                  "QUASI_UNIFORM_SURFACE"};

std::string Lower(std::string_view keyword) {
  std::string text;
  for (const char c : keyword)
    text += c == '_' ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// Surfaces of revolution. Their placement gives the axis.
constexpr std::array<std::string_view, 4> kTurned{"CYLINDRICAL_SURFACE", "CONICAL_SURFACE",
                                                  "SPHERICAL_SURFACE", "TOROIDAL_SURFACE"};

}  // namespace

void Repairer::DropOtherStructures() {
  if (entities_.structures() == 1) return;
  Warn(std::to_string(entities_.structures()) +
       " STEP files follow each other in this file, and only the first is read; split the file to read the "
       "others.");
  for (const StepEntity& entity : entities_.all()) {
    if (entity.structure == 0) continue;
    if (IsFaceKeyword(entity.keyword)) {
      const auto record = entities_.Record(entity);
      repair_.lost.push_back({Label(entity.id) + " of file " + std::to_string(entity.structure + 1),
                              record ? NameIn(*record) : "",
                              "it is in file " + std::to_string(entity.structure + 1) + " of " +
                                  std::to_string(entities_.structures()) +
                                  " that follow each other, of which only the first is read"});
    }
  }
}

void Repairer::DropDuplicates() {
  for (const StepEntity& entity : entities_.all()) {
    if (entity.structure != 0) continue;
    const StepEntity* first = entities_.Find(entity.id);
    if (first == &entity) continue;
    dropped_.insert(&entity);
    repair_.changed = true;
    if (first->Body(entities_.bytes()) == entity.Body(entities_.bytes())) {
      Warn("Entity " + Label(entity.id) + " is written twice, with the same content.");
      continue;
    }
    const auto record = entities_.Record(entity);
    repair_.lost.push_back({Label(entity.id) + ", the second of that number", record ? NameIn(*record) : "",
                            "its number is used twice; of the two entities only the first is read"});
    Warn("Entity " + Label(entity.id) + " is defined twice, with different contents; the first one is used.");
  }
}

bool Repairer::MayHoldEmptyList(std::string_view body) {
  for (std::size_t at = body.find('('); at != std::string_view::npos; at = body.find('(', at + 1)) {
    const std::size_t next = body.find_first_not_of(" \t\n", at + 1);
    if (next != std::string_view::npos && (body[next] == ')' || body[next] == '/')) return true;
  }
  return false;
}

bool Repairer::EndsInSense(std::string_view body) {
  body = body.substr(0, body.find_last_not_of(" \t\n") + 1);
  return body.ends_with(".T.)") || body.ends_with(".F.)");
}

void Repairer::Check(const StepEntity& entity) {
  const std::string_view keyword = entity.keyword, body = entity.Body(entities_.bytes());
  const bool complex = keyword.empty();
  const auto named = [&](const auto& rule) { return rule.keyword == keyword; };
  const bool sensed = !complex && std::any_of(kSenses.begin(), kSenses.end(), named) && !EndsInSense(body);
  const bool empty = !complex && MayHoldEmptyList(body);
  const bool listed = complex || (empty && std::any_of(kNeeded.begin(), kNeeded.end(), named));
  const bool curve = empty && (IsSurfaceCurve(keyword) || keyword == "TRIMMED_CURVE");
  if (keyword == "CARTESIAN_POINT") CheckCoordinates(entity);
  if (!listed && !sensed && !curve) return;
  std::optional<StepRecord> record = entities_.Record(entity);
  if (!record) return;
  if (complex) {
    CheckParts(entity, *record);
    return;
  }
  for (const Needed& rule : kNeeded) {
    if (rule.keyword == keyword && IsEmpty(Value(*record, rule.attribute))) return Remove(entity, rule.what);
  }
  for (const Sense& rule : kSenses) {
    if (rule.keyword == keyword) CheckSense(entity, *record, rule);
  }
  if (curve) CheckCurve(entity, *record);
}

void Repairer::CheckCoordinates(const StepEntity& entity) {
  const std::string_view body = entity.Body(entities_.bytes());
  if (std::count(body.begin(), body.end(), ',') <= 3) return;
  const auto record = entities_.Record(entity);
  const StepValue* list = record ? Value(*record, 1) : nullptr;
  if (list == nullptr || !list->IsList() || list->items.size() <= 3) return;
  const bool pointed = std::any_of(list->items.begin(), list->items.end(), [](const StepValue& item) {
    return item.text.find('.') != std::string_view::npos;
  });
  const std::string count = std::to_string(list->items.size());
  if (pointed) {
    Warn("The point " + Label(entity.id) + " has " + count + " coordinates, of which three are read.");
  } else if (repair_.refusal.empty()) {
    repair_.refusal = "writes its numbers with decimal commas: the point " + Label(entity.id) + " has " +
                      count + " coordinates instead of three; export the model again with decimal points.";
  }
}

bool Repairer::IsSurfaceCurve(std::string_view keyword) {
  return keyword == "SURFACE_CURVE" || keyword == "SEAM_CURVE" || keyword == "INTERSECTION_CURVE" ||
         keyword == "BOUNDED_SURFACE_CURVE";
}

bool Repairer::IsEmpty(const StepValue* value) {
  if (value == nullptr || !value->IsList()) return false;
  return value->items.empty() ||
         std::any_of(value->items.begin(), value->items.end(),
                     [](const StepValue& item) { return item.IsList() && item.items.empty(); });
}

void Repairer::CheckParts(const StepEntity& entity, StepRecord& record) {
  if (!record.complex) return;
  for (const Needed& rule : kNeededInParts) {
    const StepPart* part = record.Find(rule.keyword);
    if (part != nullptr && rule.attribute < part->values.size() && IsEmpty(&part->values[rule.attribute]))
      return Remove(entity, rule.what);
  }
  // The standard requires the parts to be in alphabetical order, and OpenCASCADE accepts no other order.
  const auto before = [](const StepPart& a, const StepPart& b) { return a.keyword < b.keyword; };
  if (std::is_sorted(record.parts.begin(), record.parts.end(), before)) return;
  std::stable_sort(record.parts.begin(), record.parts.end(), before);
  Edit(entity, record);
  Warn("The parts of entity " + Label(entity.id) + " were not in alphabetical order and were sorted.");
}

void Repairer::CheckSense(const StepEntity& entity, StepRecord& record, const Sense& rule) {
  if (rule.attribute >= record.parts.front().values.size()) return;
  StepValue& value = record.parts.front().values[rule.attribute];
  if (value.kind == Kind::kEnum && (value.text == "T" || value.text == "F")) return;
  // The orientation of an oriented shell or face is not a derived attribute. A reference or a list in its
  // place means that other attributes are missing.
  if (value.IsReference() || value.IsList()) return;
  const std::string written = ToText(value);
  value = {};
  value.kind = Kind::kEnum;
  value.text = written == ".FALSE." ? "F" : "T";
  Edit(entity, record);
  Warn("The file gives " + written + " for " + std::string(rule.what) + " " + Label(entity.id) +
       ", which is neither true nor false; " + (value.text == "F" ? "false" : "true") + " was assumed.");
}

void Repairer::CheckCurve(const StepEntity& entity, const StepRecord& record) {
  const bool trimmed = entity.keyword == "TRIMMED_CURVE";
  const bool lacking =
      trimmed ? IsEmpty(Value(record, 2)) || IsEmpty(Value(record, 3)) : IsEmpty(Value(record, 2));
  const StepValue* basis = Value(record, 1);
  if (!lacking) return;
  if (basis == nullptr || !basis->IsReference() || basis->reference == entity.id)
    return Remove(entity, trimmed ? "has no trims" : "has no curves on surfaces");
  aliases_[entity.id] = basis->reference;
  gone_.insert(&entity);
  Warn("The " + Lower(entity.keyword) + " " + Label(entity.id) +
       (trimmed ? " has no trims" : " has no curves on surfaces") + "; curve " + Label(basis->reference) +
       " was used in its place.");
}

std::vector<std::uint64_t> Repairer::ReferencesIn(std::string_view body) {
  std::vector<std::uint64_t> references;
  ForEachReference(body, [&](std::uint64_t id) { references.push_back(id); });
  return references;
}

void Repairer::LeaveOutSpurs() {
  const std::string_view bytes = entities_.bytes();
  for (const StepEntity& face : entities_.all()) {
    if (!IsFaceKeyword(face.keyword) || face.structure != 0 || dropped_.contains(&face)) continue;
    const std::vector<std::uint64_t> parts = ReferencesIn(face.Body(bytes));
    const StepEntity* surface = parts.empty() ? nullptr : entities_.Find(parts.back());
    if (surface == nullptr || !Holds(kTurned, surface->keyword)) continue;
    for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
      const StepEntity* bound = entities_.Find(parts[i]);
      if (bound == nullptr) continue;
      const std::vector<std::uint64_t> loops = ReferencesIn(bound->Body(bytes));
      const StepEntity* loop = loops.size() == 1 ? entities_.Find(loops.front()) : nullptr;
      if (loop != nullptr && loop->keyword == "EDGE_LOOP" && !gone_.contains(loop))
        LeaveOutSpurs(*loop, *surface);
    }
  }
}

bool Repairer::EndsOnAxis(const Use& use, const StepEntity& surface) const {
  const auto edge = Record(use.edge), form = entities_.Record(surface);
  if (!edge || !form) return true;
  const auto vertex = Record(ReferenceIn(*edge, use.forward ? 2 : 1));
  const auto point = vertex ? Coordinates(Value(*vertex, 1)) : std::nullopt;
  if (!point) return true;
  const Similarity frame = FrameOf(ReferenceIn(*form, 1));
  const Vector axis{frame.linear[2], frame.linear[5], frame.linear[8]},
      offset = Minus(*point, frame.origin, 1);
  const Vector across = Minus(offset, axis, Dot(offset, axis));
  // Coordinates in files have at least six digits.
  constexpr double kRounding = 1e-5;
  return !(Dot(across, across) > kRounding * kRounding * Dot(offset, offset));
}

void Repairer::LeaveOutSpurs(const StepEntity& loop, const StepEntity& surface) {
  std::vector<Use> uses;
  std::unordered_set<std::uint64_t> edges;
  for (const std::uint64_t id : ReferencesIn(loop.Body(entities_.bytes()))) {
    const StepEntity* oriented = entities_.Find(id);
    if (oriented == nullptr || oriented->keyword != "ORIENTED_EDGE") return;
    const std::vector<std::uint64_t> edge = ReferencesIn(oriented->Body(entities_.bytes()));
    if (edge.empty()) return;
    uses.push_back(
        {id, edge.back(), oriented->Body(entities_.bytes()).find(".F.") == std::string_view::npos});
    edges.insert(edge.back());
  }
  if (edges.size() == uses.size()) return;
  // Remove pairs of opposite uses from the sequence, then compare its two ends.
  const auto opposite = [&](const Use& a, const Use& b) {
    return a.edge == b.edge && a.forward != b.forward && !EndsOnAxis(a, surface);
  };
  std::vector<Use> kept;
  for (const Use& use : uses) {
    if (!kept.empty() && opposite(kept.back(), use)) {
      kept.pop_back();
    } else {
      kept.push_back(use);
    }
  }
  std::size_t ends = 0;
  while (kept.size() > 2 * ends + 2 && opposite(kept[kept.size() - 1 - ends], kept[ends])) ++ends;
  kept.assign(kept.begin() + static_cast<std::ptrdiff_t>(ends),
              kept.end() - static_cast<std::ptrdiff_t>(ends));
  if (kept.empty()) return;
  if (kept.size() == uses.size()) return;
  Warn("The edge loop " + Label(loop.id) +
       " follows edges forwards and backwards; those edges were removed.");
  std::string body = "EDGE_LOOP('',(";
  for (std::size_t i = 0; i < kept.size(); ++i) body += (i == 0 ? "" : ",") + Label(kept[i].oriented);
  edits_[&loop] = body + "))";
}

void Repairer::Remove(const StepEntity& entity, const char* what) {
  if (removed_.contains(entity.id)) return;
  std::string name = entity.keyword.empty() ? "entity" : Lower(entity.keyword);
  name += " " + Label(entity.id);
  Warn("The " + name + " " + what + "; it was left out.");
  Out(entity, "its " + name + " " + what);
}

void Repairer::Out(const StepEntity& entity, const std::string& reason) {
  removed_[entity.id] = reason;
  gone_.insert(&entity);
  open_.push_back(entity.id);
  if (IsFaceKeyword(entity.keyword)) repair_.faces_out[entity.id] = reason;
}

void Repairer::TakeOut() {
  if (open_.empty()) return;
  std::unordered_map<std::uint64_t, std::vector<const StepEntity*>> users;
  for (const StepEntity& entity : entities_.all()) {
    if (entity.structure != 0 || dropped_.contains(&entity)) continue;
    ForEachReference(entity.Body(entities_.bytes()), [&](std::uint64_t id) {
      auto& list = users[id];
      if (list.empty() || list.back() != &entity) list.push_back(&entity);
    });
  }
  while (!open_.empty()) {
    // Collect the entities that refer to any entity of this wave, in the order of the file.
    std::map<const StepEntity*, std::vector<std::uint64_t>> touched;
    for (const std::uint64_t id : open_) {
      for (const StepEntity* user : users[id]) {
        if (!gone_.contains(user)) touched[user].push_back(id);
      }
    }
    open_.clear();
    for (const auto& [user, ids] : touched)
      RemoveReferences(*user, {ids.begin(), ids.end()}, removed_[ids.front()]);
  }
}

void Repairer::RemoveReferences(const StepEntity& user, const std::unordered_set<std::uint64_t>& ids,
                                const std::string& reason) {
  std::optional<StepRecord> record = FindStepRecord(user);
  if (!record) return;
  const bool whole = record->complex || Holds(kWhole, user.keyword);
  bool needed = false;
  for (StepPart& part : record->parts) needed = WithoutReferences(part.values, ids, whole) || needed;
  if (needed) return Out(user, reason);
  Edit(user, *record);
  // The list may be empty now although it needs an element.
  for (const Needed& rule : kNeeded) {
    if (rule.keyword == user.keyword && IsEmpty(Value(*record, rule.attribute))) return Out(user, reason);
  }
  if (IsSurfaceCurve(user.keyword)) CheckCurve(user, *record);
}

bool Repairer::WithoutReferences(std::vector<StepValue>& values, const std::unordered_set<std::uint64_t>& ids,
                                 bool whole) {
  const auto out = [&](const StepValue& value) {
    return value.IsReference() && ids.contains(value.reference);
  };
  bool needed = false;
  for (StepValue& value : values) {
    needed = needed || out(value);
    if (value.kind == Kind::kTyped || (value.IsList() && whole)) {
      needed = WithoutReferences(value.items, ids, true) || needed;
    } else if (value.IsList()) {
      std::erase_if(value.items, out);
      needed = WithoutReferences(value.items, ids, false) || needed;
    }
  }
  return needed;
}

}  // namespace facetless::step_repair

// The parts of RepairStep and the data that they share: one pass over the entities of a STEP file.
//
//  1. step_repair.cpp runs the passes and writes the repaired copy; step_repair_lists.cpp mends or removes
//     entities; step_repair_placements.cpp rewrites placements; step_repair_ledger.cpp lists entities that
//     the importer does not read or that no placement places.
//  2. Only those four files include this header.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "import/step_entities.h"
#include "import/step_repair.h"
#include "import/step_strings.h"

namespace facetless::step_repair {

using Kind = StepValue::Kind;

template <typename Array>
bool Holds(const Array& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

inline bool IsFaceKeyword(std::string_view keyword) {
  return keyword == "ADVANCED_FACE" || keyword == "FACE_SURFACE" || keyword == "FACE";
}

inline std::string Label(std::uint64_t id) {
  return "#" + std::to_string(id);
}

inline const StepValue* Value(const StepRecord& record, std::size_t index) {
  return !record.parts.empty() && index < record.parts.front().values.size()
             ? &record.parts.front().values[index]
             : nullptr;
}

// Returns the name of a representation item, which is its first attribute.
inline std::string NameIn(const StepRecord& record) {
  const StepPart* part = record.complex ? record.Find("REPRESENTATION_ITEM") : &record.parts.front();
  if (part == nullptr || part->values.empty() || part->values.front().kind != Kind::kString) return {};
  const std::string_view raw = part->values.front().text;
  std::string text;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    text += raw[i];
    if (raw[i] == '\'' && i + 1 < raw.size() && raw[i + 1] == '\'') ++i;
  }
  return DecodeStepText(text);
}

// The attributes that all kinds of representations share.
struct Representation {
  std::uint64_t id = 0;
  std::vector<std::uint64_t> items;
  std::uint64_t context = 0;
};

// Adds the references in a list to `out`. Returns false if the value is no list.
inline bool ReferencesOf(const StepValue& value, std::vector<std::uint64_t>& out) {
  if (!value.IsList()) return false;
  for (const StepValue& item : value.items) {
    if (item.IsReference()) out.push_back(item.reference);
  }
  return true;
}

// A frame, or the map of a transformation operator: x → linear · x + origin.
struct Similarity {
  LinearMap linear{1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<double, 3> origin{};
};

using Vector = std::array<double, 3>;

inline Vector Minus(const Vector& a, const Vector& b, double t) {
  return {a[0] - t * b[0], a[1] - t * b[1], a[2] - t * b[2]};
}
inline double Dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vector Cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
// Returns the vector scaled to length 1; nothing if its length is zero or not finite.
inline std::optional<Vector> Unit(const Vector& v) {
  const double length = std::sqrt(Dot(v, v));
  if (!(length > 0) || !std::isfinite(length)) return {};
  return Vector{v[0] / length, v[1] / length, v[2] / length};
}

struct Sense;

class Repairer {
 public:
  explicit Repairer(std::string_view bytes) : entities_(bytes) {}
  StepRepair Run();

 private:
  // step_repair.cpp
  void Warn(std::string sentence);
  std::optional<StepRecord> Record(std::uint64_t id) const;
  // Returns the entity's record with all edits so far.
  std::optional<StepRecord> FindStepRecord(const StepEntity& entity) const;
  void Edit(const StepEntity& entity, const StepRecord& record) { edits_[&entity] = ToText(record); }
  // Appends the text. Strings that are too long for the reader are cut.
  void AppendShortened(std::string_view text, std::uint64_t id, std::string& out);
  // Replaces references to entities that now have another number.
  std::string WithAliases(const std::string& body) const;
  void Write();
  bool HasLongText() const;

  // step_repair_lists.cpp
  // Removes further STEP files that follow the first one.
  void DropOtherStructures();
  // If two entities have the same id, the first is used. A second one with other contents is lost.
  void DropDuplicates();
  // Returns whether an opening parenthesis is followed by the closing one, apart from blanks. Such a body
  // needs a closer look.
  static bool MayHoldEmptyList(std::string_view body);
  static bool EndsInSense(std::string_view body);
  // Looks at the text first, because most entities of a file are points and edges, which are sound.
  void Check(const StepEntity& entity);
  // A point has at most three coordinates. If it has more and none contains a point, they are numbers with
  // decimal commas.
  void CheckCoordinates(const StepEntity& entity);
  static bool IsSurfaceCurve(std::string_view keyword);
  // Returns whether the value is an empty list, or a list that contains an empty list.
  static bool IsEmpty(const StepValue* value);
  void CheckParts(const StepEntity& entity, StepRecord& record);
  void CheckSense(const StepEntity& entity, StepRecord& record, const Sense& rule);
  void CheckCurve(const StepEntity& entity, const StepRecord& record);
  static std::vector<std::uint64_t> ReferencesIn(std::string_view body);
  // Removes spurs: edges that are immediately followed by themselves in the opposite sense. On a surface
  // around an axis, such a pair encloses nothing, but OpenCASCADE treats it as the seam. It really is the
  // seam if it turns back on the axis: at the apex of a cone or the pole of a sphere.
  void LeaveOutSpurs();
  // One use of an edge in a loop.
  struct Use {
    std::uint64_t oriented = 0, edge = 0;
    bool forward = true;
  };
  // Returns whether the use ends on the axis of the surface. Returns true if the place is unknown.
  bool EndsOnAxis(const Use& use, const StepEntity& surface) const;
  void LeaveOutSpurs(const StepEntity& loop, const StepEntity& surface);
  void Remove(const StepEntity& entity, const char* what);
  void Out(const StepEntity& entity, const std::string& reason);
  // Removes the entities that cannot exist without removed ones, step by step.
  void TakeOut();
  // Removes the references `ids` from an entity's lists, or removes the entity itself.
  void RemoveReferences(const StepEntity& user, const std::unordered_set<std::uint64_t>& ids,
                        const std::string& reason);
  // Removes the references from lists. Returns true if an attribute itself holds one of them, or a list that
  // must stay whole.
  static bool WithoutReferences(std::vector<StepValue>& values, const std::unordered_set<std::uint64_t>& ids,
                                bool whole);

  // step_repair_placements.cpp
  std::uint64_t NewEntity(const std::string& body);
  std::uint64_t NewFrame(const Similarity& frame);
  void FindRepresentations();
  // Turns each replica of a solid into a mapped item of a representation of its own.
  void MapReplicas();
  std::optional<Vector> Coordinates(const StepValue* reference) const;
  // Evaluates a CARTESIAN_TRANSFORMATION_OPERATOR_3D as ISO 10303-42 defines it: base_axis(3, axis1, axis2,
  // axis3).
  std::optional<Similarity> OperatorOf(std::uint64_t id) const;
  // Evaluates an AXIS2_PLACEMENT_3D. Returns the identity if there is none.
  Similarity FrameOf(std::uint64_t id) const;
  // Returns the rotation to write for a map: the map itself if it is a rotation, else its stand-in. Returns
  // nothing if there are too many maps.
  std::optional<LinearMap> RotationFor(const LinearMap& map);
  // Rewrites placements that OpenCASCADE 7.6 evaluates wrongly. Each becomes one frame relative to the
  // origin. OpenCASCADE treats operators as rotations. For a pair of frames A and B it computes A⁻¹ · B
  // instead of B · A⁻¹; the two agree if one of the frames is the origin, which is the usual case.
  void MapOperators();
  bool Is(std::uint64_t id, std::string_view keyword) const;
  // Returns the map of a placement's target; nothing if the target is of an unknown kind.
  std::optional<Similarity> TargetOf(std::uint64_t id) const;
  // Returns target · origin⁻¹.
  static Similarity Placed(const Similarity& target, const Similarity& origin);
  // Returns whether origin⁻¹ · target, which OpenCASCADE computes, is the same as Placed().
  static bool Commutes(const Similarity& target, const Similarity& origin);
  // Writes the frame for the placement, or for its stand-in, and returns its id.
  std::optional<std::uint64_t> FrameFor(Similarity placed);
  void MapItem(const StepEntity& entity);
  const Representation* FindRepresentation(std::uint64_t id);
  void MapRelationship(const StepEntity& entity);
  // Returns the placement to write. Returns nothing if OpenCASCADE evaluates it correctly, or if the two
  // representations have different contexts, whose units may differ.
  std::optional<Similarity> PlacedByItems(std::uint64_t id, const StepRecord& relationship);
  void LosePlacement(const StepEntity& entity, const std::string& name);

  // step_repair_ledger.cpp
  // Reports an item of a shape that is no body: a curve, which is not drawn, or an item of an unknown kind.
  void NoteOtherItem(const StepEntity& item);
  // Lists items of representations that are bodies of kinds that OpenCASCADE does not read.
  void FindUnread();
  std::uint64_t ReferenceIn(const StepRecord& record, std::size_t index) const;
  struct Assembly;
  // Collects occurrences, products and shapes, and the references between them.
  void CollectAssembly(Assembly& assembly) const;
  // Finds the owner of each representation, and the representations that contain bodies or map others.
  // FindRepresentations must have run.
  void CollectShapes(Assembly& assembly) const;
  // Returns the name of the product of a PRODUCT_DEFINITION.
  std::string NameOfDefinition(std::uint64_t definition) const;
  // Lists occurrences that no placement places, and products that have no shape.
  void FindUnplaced();
  // Returns whether the length of a unit in metres can be read: it is an SI unit or a multiple of one.
  bool IsReadable(const StepRecord& unit, int depth = 0) const;
  // Returns whether the context assigns a readable length unit. An unreadable one is replaced by millimetres.
  bool HasLengthUnit(std::uint64_t context);
  void CheckUnits();

  const StepEntities entities_;
  StepRepair repair_;
  std::unordered_map<const StepEntity*, std::string> edits_;  // new bodies of entities
  std::unordered_set<const StepEntity*> gone_;                // removed entities
  std::unordered_set<const StepEntity*> dropped_;             // second entities with the same id
  // Removed entities, with the reason that is given for the entities that need them.
  std::unordered_map<std::uint64_t, std::string> removed_;
  std::unordered_map<std::uint64_t, std::uint64_t> aliases_;
  std::vector<std::uint64_t> open_;  // removed entities whose users have not been examined yet
  std::vector<const StepEntity*> replicas_;
  std::vector<Representation> representations_;
  std::unordered_map<std::uint64_t, std::size_t> representation_of_;  // by id
  bool found_representations_ = false;
  std::string added_;
  std::uint64_t added_count_ = 0;
  std::size_t warned_ = 0, curve_sets_ = 0;
};

}  // namespace facetless::step_repair

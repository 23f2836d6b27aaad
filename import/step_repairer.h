// The parts of RepairStep, and what they share: one pass over the entities of a STEP file.
//
//  1. step_repair.cpp runs the passes and writes the repaired copy; step_repair_lists.cpp mends entities, or
//     takes them out; step_repair_placements.cpp rewrites placements; step_repair_ledger.cpp names what
//     nobody reads or places.
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

// The name of a representation item, its first attribute.
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

// A representation: the attributes that all kinds share.
struct Representation {
  std::uint64_t id = 0;
  std::vector<std::uint64_t> items;
  std::uint64_t context = 0;
};

// Adds the references of a list to `out`. False if the value is no list.
inline bool ReferencesOf(const StepValue& value, std::vector<std::uint64_t>& out) {
  if (!value.IsList()) return false;
  for (const StepValue& item : value.items) {
    if (item.IsReference()) out.push_back(item.reference);
  }
  return true;
}

// A frame, or what an operator does: x → linear · x + origin.
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
// Of length 1; nothing if it has none.
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
  // As it is by now.
  std::optional<StepRecord> FindStepRecord(const StepEntity& entity) const;
  void Edit(const StepEntity& entity, const StepRecord& record) { edits_[&entity] = ToText(record); }
  // Texts are cut where the reader's room for them ends.
  void AppendShortened(std::string_view text, std::uint64_t id, std::string& out);
  // References to what is known under another number now.
  std::string WithAliases(const std::string& body) const;
  void Write();
  bool HasLongText() const;

  // step_repair_lists.cpp
  // A second file behind the first one.
  void DropOtherStructures();
  // Of two entities of one id the first counts; a second one that says something else is lost.
  void DropDuplicates();
  // An opening parenthesis and, but for blanks, the closing one: what needs a closer look.
  static bool MayHoldEmptyList(std::string_view body);
  static bool EndsInSense(std::string_view body);
  // Looks at the text first: most entities of a file are points and edges, which are sound.
  void Check(const StepEntity& entity);
  // Points have at most three coordinates. More of them, none with a point, are numbers with decimal commas.
  void CheckCoordinates(const StepEntity& entity);
  static bool IsSurfaceCurve(std::string_view keyword);
  // An empty list, or a list with an empty list in it.
  static bool IsEmpty(const StepValue* value);
  void CheckParts(const StepEntity& entity, StepRecord& record);
  void CheckSense(const StepEntity& entity, StepRecord& record, const Sense& rule);
  void CheckCurve(const StepEntity& entity, const StepRecord& record);
  static std::vector<std::uint64_t> ReferencesIn(std::string_view body);
  // On a surface that goes around an axis an edge that is followed by itself in the other sense encloses
  // nothing; OpenCASCADE takes it for the seam. It is one where it turns back on the axis: at the apex of a
  // cone, at the pole of a sphere.
  void LeaveOutSpurs();
  // One use of an edge in a loop.
  struct Use {
    std::uint64_t oriented = 0, edge = 0;
    bool forward = true;
  };
  // True if the use ends on the axis of the surface, or nobody knows where.
  bool EndsOnAxis(const Use& use, const StepEntity& surface) const;
  void LeaveOutSpurs(const StepEntity& loop, const StepEntity& surface);
  void Remove(const StepEntity& entity, const char* what);
  void Out(const StepEntity& entity, const std::string& reason);
  // Takes out what cannot be without what is out, step by step.
  void TakeOut();
  // Takes what is out out of an entity's lists, or the entity itself out.
  void RemoveReferences(const StepEntity& user, const std::unordered_set<std::uint64_t>& ids,
                        const std::string& reason);
  // Takes the reference out of lists; true if an attribute itself, or a list that must be whole, holds it.
  static bool WithoutReferences(std::vector<StepValue>& values, const std::unordered_set<std::uint64_t>& ids,
                                bool whole);

  // step_repair_placements.cpp
  std::uint64_t NewEntity(const std::string& body);
  std::uint64_t NewFrame(const Similarity& frame);
  void FindRepresentations();
  // A replica of a solid is a mapped item of a representation of its own.
  void MapReplicas();
  std::optional<Vector> Coordinates(const StepValue* reference) const;
  // CARTESIAN_TRANSFORMATION_OPERATOR_3D, by ISO 10303-42: base_axis(3, axis1, axis2, axis3).
  std::optional<Similarity> OperatorOf(std::uint64_t id) const;
  // AXIS2_PLACEMENT_3D; the identity where there is none.
  Similarity FrameOf(std::uint64_t id) const;
  // The rotation that is written for a map: itself if it is one. Nothing if there are too many.
  std::optional<LinearMap> RotationFor(const LinearMap& map);
  // Placements that OpenCASCADE 7.6 gets wrong become a frame each, seen from the origin: operators, which it
  // takes for rotations; and pairs of frames A and B, of which it makes A⁻¹ · B where B · A⁻¹ is meant. The
  // two agree where one of the frames is the origin, as it mostly is.
  void MapOperators();
  bool Is(std::uint64_t id, std::string_view keyword) const;
  // What the target of a placement does; nothing if it is no kind that is known here.
  std::optional<Similarity> TargetOf(std::uint64_t id) const;
  // target · origin⁻¹.
  static Similarity Placed(const Similarity& target, const Similarity& origin);
  // True if OpenCASCADE's origin⁻¹ · target is the same.
  static bool Commutes(const Similarity& target, const Similarity& origin);
  // The frame that is written for the placement: itself, or its stand-in.
  std::optional<std::uint64_t> FrameFor(Similarity placed);
  void MapItem(const StepEntity& entity);
  const Representation* FindRepresentation(std::uint64_t id);
  void MapRelationship(const StepEntity& entity);
  // Nothing where OpenCASCADE gets it right, or the two representations have contexts, and may have units, of
  // their own.
  std::optional<Similarity> PlacedByItems(std::uint64_t id, const StepRecord& relationship);
  void LosePlacement(const StepEntity& entity, const std::string& name);

  // step_repair_ledger.cpp
  // Items of shapes that are no bodies: curves, which are not drawn, and kinds that are not known here.
  void NoteOtherItem(const StepEntity& item);
  // Bodies of kinds that nobody reads, as items of representations.
  void FindUnread();
  std::uint64_t ReferenceIn(const StepRecord& record, std::size_t index) const;
  // Occurrences that nothing places, and products that have no shape.
  void FindUnplaced();
  // A length unit whose length in metres can be read: an SI unit, or a multiple of one.
  bool IsReadable(const StepRecord& unit, int depth = 0) const;
  // True if the context assigns a length unit that can be read. One that cannot is made millimetres.
  bool HasLengthUnit(std::uint64_t context);
  void CheckUnits();

  const StepEntities entities_;
  StepRepair repair_;
  std::unordered_map<const StepEntity*, std::string> edits_;  // new bodies
  std::unordered_set<const StepEntity*> gone_, dropped_;      // taken out; second ones of their id
  std::unordered_map<std::uint64_t, std::string>
      removed_;  // what is taken out, and the reason for whatever needs it
  std::unordered_map<std::uint64_t, std::uint64_t> aliases_;
  std::vector<std::uint64_t> open_;  // taken out, but not yet looked after
  std::vector<const StepEntity*> replicas_;
  std::vector<Representation> representations_;
  std::unordered_map<std::uint64_t, std::size_t> representation_of_;  // by id
  bool found_representations_ = false;
  std::string added_;
  std::uint64_t added_count_ = 0;
  std::size_t warned_ = 0, curve_sets_ = 0;
};

}  // namespace facetless::step_repair

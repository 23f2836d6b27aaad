#include "import/step_repair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <string_view>
#include <unordered_set>

#include "import/step_entities.h"

namespace facetless {
namespace {

using Kind = StepValue::Kind;

// OpenCASCADE's scanner holds texts of up to 16,383 bytes; the standard allows 32,769 characters. Only names are so long.
constexpr std::size_t kLongestText = 16350;

// A list that needs at least one element: which attribute of which entity (with its name counted), and what it lacks without.
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
// The same within an entity of several parts, which have no name of their own.
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

// Lists that cannot do without an element: a loop without one of its edges is another loop.
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

// Bodies that OpenCASCADE 7.6 makes no shape of, and what they are called.
struct Unread {
  std::string_view keyword;
  const char* what;
};
constexpr std::array kUnread{Unread{"CSG_SOLID", "a CSG solid"},
                             Unread{"BOOLEAN_RESULT", "a CSG solid"},
                             Unread{"BOOLEAN_CLIPPING_RESULT", "a CSG solid"},
                             Unread{"BLOCK", "a CSG primitive"},
                             Unread{"SPHERE", "a CSG primitive"},
                             Unread{"TORUS", "a CSG primitive"},
                             Unread{"ELLIPSOID", "a CSG primitive"},
                             Unread{"ECCENTRIC_CONE", "a CSG primitive"},
                             Unread{"RIGHT_ANGULAR_WEDGE", "a CSG primitive"},
                             Unread{"RIGHT_CIRCULAR_CONE", "a CSG primitive"},
                             Unread{"RIGHT_CIRCULAR_CYLINDER", "a CSG primitive"},
                             Unread{"RECTANGULAR_PYRAMID", "a CSG primitive"},
                             Unread{"FACETED_PRIMITIVE", "a CSG primitive"},
                             Unread{"CYCLIDE_SEGMENT_SOLID", "a CSG primitive"},
                             Unread{"HALF_SPACE_SOLID", "a half space"},
                             Unread{"BOXED_HALF_SPACE", "a half space"},
                             Unread{"SOLID_REPLICA", "a replica of a solid"},
                             Unread{"SURFACE_REPLICA", "a replica of a surface"},
                             Unread{"EXTRUDED_AREA_SOLID", "a swept solid"},
                             Unread{"REVOLVED_AREA_SOLID", "a swept solid"},
                             Unread{"SURFACE_CURVE_SWEPT_AREA_SOLID", "a swept solid"},
                             Unread{"SWEPT_AREA_SOLID", "a swept solid"},
                             Unread{"SWEPT_FACE_SOLID", "a swept solid"},
                             Unread{"EXTRUDED_FACE_SOLID", "a swept solid"},
                             Unread{"REVOLVED_FACE_SOLID", "a swept solid"},
                             Unread{"EXTRUDED_AREA_SOLID_TAPERED", "a swept solid"},
                             Unread{"REVOLVED_AREA_SOLID_TAPERED", "a swept solid"},
                             Unread{"EXTRUDED_FACE_SOLID_WITH_TRIM_CONDITIONS", "a swept solid"},
                             Unread{"SURFACE_CURVE_SWEPT_FACE_SOLID", "a swept solid"},
                             Unread{"SWEPT_DISK_SOLID", "a swept solid"},
                             Unread{"TESSELLATED_SOLID", "a tessellated solid, which is a mesh"},
                             Unread{"TESSELLATED_SHELL", "a tessellated shell, which is a mesh"},
                             Unread{"TESSELLATED_FACE", "a tessellated face, which is a mesh"},
                             Unread{"TRIANGULATED_FACE", "a tessellated face, which is a mesh"},
                             Unread{"COMPLEX_TRIANGULATED_FACE", "a tessellated face, which is a mesh"},
                             Unread{"CUBIC_BEZIER_TRIANGULATED_FACE", "a tessellated face, which is a mesh"}};

// Bodies and sheets of faces that it reads.
constexpr std::array<std::string_view, 16> kRead{"MANIFOLD_SOLID_BREP",
                                                 "BREP_WITH_VOIDS",
                                                 "FACETED_BREP",
                                                 "FACETED_BREP_AND_BREP_WITH_VOIDS",
                                                 "SHELL_BASED_SURFACE_MODEL",
                                                 "FACE_BASED_SURFACE_MODEL",
                                                 "GEOMETRIC_SET",
                                                 "GEOMETRIC_CURVE_SET",
                                                 "MAPPED_ITEM",
                                                 "CLOSED_SHELL",
                                                 "OPEN_SHELL",
                                                 "ORIENTED_CLOSED_SHELL",
                                                 "ADVANCED_FACE",
                                                 "FACE_SURFACE",
                                                 "CONNECTED_FACE_SET",
                                                 "CURVE_BOUNDED_SURFACE"};

// Wireframes.
constexpr std::array<std::string_view, 3> kCurveSets{"GEOMETRIC_CURVE_SET", "EDGE_BASED_WIREFRAME_MODEL",
                                                     "SHELL_BASED_WIREFRAME_MODEL"};
// Surfaces around an axis, which their placement is.
constexpr std::array<std::string_view, 4> kTurned{"CYLINDRICAL_SURFACE", "CONICAL_SURFACE",
                                                  "SPHERICAL_SURFACE", "TOROIDAL_SURFACE"};
// What a shape may hold that is nothing to be seen.
constexpr std::array<std::string_view, 24> kWithoutBody{"COORDINATES_LIST",
                                                        "TESSELLATED_CURVE_SET",
                                                        "TESSELLATED_POINT_SET",
                                                        "TESSELLATED_VERTEX",
                                                        "TESSELLATED_EDGE",
                                                        "TRIANGULATED_SURFACE_SET",
                                                        "COMPLEX_TRIANGULATED_SURFACE_SET",
                                                        "REPOSITIONED_TESSELLATED_ITEM",
                                                        "AXIS1_PLACEMENT",
                                                        "AXIS2_PLACEMENT_2D",
                                                        "AXIS2_PLACEMENT_3D",
                                                        "CARTESIAN_POINT",
                                                        "DIRECTION",
                                                        "VECTOR",
                                                        "PLACEMENT",
                                                        "LINE",
                                                        "CIRCLE",
                                                        "ELLIPSE",
                                                        "POLYLINE",
                                                        "VERTEX_POINT",
                                                        "PLANE",
                                                        "STYLED_ITEM",
                                                        "TESSELLATED_GEOMETRIC_SET",
                                                        "CARTESIAN_TRANSFORMATION_OPERATOR_3D"};

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

template <typename Array>
bool Holds(const Array& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool IsFaceKeyword(std::string_view keyword) {
  return keyword == "ADVANCED_FACE" || keyword == "FACE_SURFACE" || keyword == "FACE";
}

std::string Label(std::uint64_t id) {
  return "#" + std::to_string(id);
}

std::string Lower(std::string_view keyword) {
  std::string text;
  for (const char c : keyword)
    text += c == '_' ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

const StepValue* Value(const StepRecord& record, std::size_t index) {
  return !record.parts.empty() && index < record.parts.front().values.size()
             ? &record.parts.front().values[index]
             : nullptr;
}

// The name of a representation item, its first attribute.
std::string NameIn(const StepRecord& record) {
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

bool ReferencesOf(const StepValue& value, std::vector<std::uint64_t>& out) {
  if (!value.IsList()) return false;
  for (const StepValue& item : value.items) {
    if (item.IsReference()) out.push_back(item.reference);
  }
  return true;
}

std::optional<Representation> AsRepresentation(const StepEntity& entity, const StepRecord& record) {
  const StepPart* part = record.complex ? record.Find("REPRESENTATION") : &record.parts.front();
  if (part == nullptr || part->values.size() < 3) return {};
  if (!record.complex &&
      (!part->keyword.ends_with("REPRESENTATION") || part->keyword == "DEFINITIONAL_REPRESENTATION"))
    return {};
  if (!part->values[2].IsReference()) return {};
  Representation representation;
  representation.id = entity.id;
  representation.context = part->values[2].reference;
  if (!ReferencesOf(part->values[1], representation.items)) return {};
  return representation;
}

std::string Real(double value) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.17E", value);
  return text;
}

std::string Triple(const std::array<double, 3>& v) {
  return "(" + Real(v[0]) + "," + Real(v[1]) + "," + Real(v[2]) + ")";
}

// A frame, or what an operator does: x → linear · x + origin.
struct Similarity {
  LinearMap linear{1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<double, 3> origin{};
};

using Vector = std::array<double, 3>;

Vector Minus(const Vector& a, const Vector& b, double t) {
  return {a[0] - t * b[0], a[1] - t * b[1], a[2] - t * b[2]};
}
double Dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vector Cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
// Of length 1; nothing if it has none.
std::optional<Vector> Unit(const Vector& v) {
  const double length = std::sqrt(Dot(v, v));
  if (!(length > 0) || !std::isfinite(length)) return {};
  return Vector{v[0] / length, v[1] / length, v[2] / length};
}

class Repairer {
 public:
  explicit Repairer(std::string_view bytes) : entities_(bytes) {}

  StepRepair Run() {
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

 private:
  void Warn(std::string sentence) {
    // A file may have the same fault in every entity: a report of a hundred says it.
    constexpr std::size_t kMostWarnings = 100;
    ++warned_;
    if (warned_ < kMostWarnings) repair_.warnings.push_back(std::move(sentence));
    if (warned_ == kMostWarnings) repair_.warnings.push_back("More repairs were made than are listed.");
  }

  std::optional<StepRecord> Record(std::uint64_t id) const {
    const StepEntity* entity = entities_.Find(id);
    return entity ? RecordOf(*entity) : std::nullopt;
  }
  // As it is by now.
  std::optional<StepRecord> RecordOf(const StepEntity& entity) const {
    const auto edited = edits_.find(&entity);
    return ParseStepRecord(edited != edits_.end() ? std::string_view(edited->second)
                                                  : entity.Body(entities_.bytes()));
  }
  void Edit(const StepEntity& entity, const StepRecord& record) { edits_[&entity] = ToText(record); }

  // A second file behind the first one.
  void DropOtherStructures() {
    if (entities_.structures() == 1) return;
    Warn(std::to_string(entities_.structures()) +
         " STEP files stand one after the other in this file, and only the first is read; split the file to "
         "read the others.");
    for (const StepEntity& entity : entities_.all()) {
      if (entity.structure == 0) continue;
      if (IsFaceKeyword(entity.keyword)) {
        const auto record = entities_.Record(entity);
        repair_.lost.push_back({Label(entity.id) + " of file " + std::to_string(entity.structure + 1),
                                record ? NameIn(*record) : "",
                                "it stands in file " + std::to_string(entity.structure + 1) + " of " +
                                    std::to_string(entities_.structures()) +
                                    " that stand one after the other, of which only the first is read"});
      }
    }
  }

  // Of two entities of one id the first counts; a second one that says something else is lost.
  void DropDuplicates() {
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
      Warn("Entity " + Label(entity.id) +
           " is defined twice, with different contents; the first one is used.");
    }
  }

  // An opening parenthesis and, but for blanks, the closing one: what needs a closer look.
  static bool MayHoldEmptyList(std::string_view body) {
    for (std::size_t at = body.find('('); at != std::string_view::npos; at = body.find('(', at + 1)) {
      const std::size_t next = body.find_first_not_of(" \t\n", at + 1);
      if (next != std::string_view::npos && (body[next] == ')' || body[next] == '/')) return true;
    }
    return false;
  }

  static bool EndsInSense(std::string_view body) {
    body = body.substr(0, body.find_last_not_of(" \t\n") + 1);
    return body.ends_with(".T.)") || body.ends_with(".F.)");
  }

  // Looks at the text first: most entities of a file are points and edges, which are sound.
  void Check(const StepEntity& entity) {
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
      if (rule.keyword == keyword && IsEmpty(Value(*record, rule.attribute)))
        return Remove(entity, rule.what);
    }
    for (const Sense& rule : kSenses) {
      if (rule.keyword == keyword) CheckSense(entity, *record, rule);
    }
    if (curve) CheckCurve(entity, *record);
  }

  // Points have at most three coordinates. More of them, none with a point, are numbers with decimal commas.
  void CheckCoordinates(const StepEntity& entity) {
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

  static bool IsSurfaceCurve(std::string_view keyword) {
    return keyword == "SURFACE_CURVE" || keyword == "SEAM_CURVE" || keyword == "INTERSECTION_CURVE" ||
           keyword == "BOUNDED_SURFACE_CURVE";
  }

  // An empty list, or a list with an empty list in it.
  static bool IsEmpty(const StepValue* value) {
    if (value == nullptr || !value->IsList()) return false;
    return value->items.empty() ||
           std::any_of(value->items.begin(), value->items.end(),
                       [](const StepValue& item) { return item.IsList() && item.items.empty(); });
  }

  void CheckParts(const StepEntity& entity, StepRecord& record) {
    if (!record.complex) return;
    for (const Needed& rule : kNeededInParts) {
      const StepPart* part = record.Find(rule.keyword);
      if (part != nullptr && rule.attribute < part->values.size() && IsEmpty(&part->values[rule.attribute]))
        return Remove(entity, rule.what);
    }
    // The standard wants the parts in the order of the alphabet; OpenCASCADE knows no other.
    const auto before = [](const StepPart& a, const StepPart& b) { return a.keyword < b.keyword; };
    if (std::is_sorted(record.parts.begin(), record.parts.end(), before)) return;
    std::stable_sort(record.parts.begin(), record.parts.end(), before);
    Edit(entity, record);
    Warn("The parts of entity " + Label(entity.id) + " were not in alphabetical order and were sorted.");
  }

  void CheckSense(const StepEntity& entity, StepRecord& record, const Sense& rule) {
    if (rule.attribute >= record.parts.front().values.size()) return;
    StepValue& value = record.parts.front().values[rule.attribute];
    if (value.kind == Kind::kEnum && (value.text == "T" || value.text == "F")) return;
    // Closed shells and faces with an orientation derive nothing here; a reference means that attributes are missing.
    if (value.IsReference() || value.IsList()) return;
    const std::string written = ToText(value);
    value = {};
    value.kind = Kind::kEnum;
    value.text = written == ".FALSE." ? "F" : "T";
    Edit(entity, record);
    Warn("For " + std::string(rule.what) + " " + Label(entity.id) + " the file says " + written +
         ", neither true nor false; " + (value.text == "F" ? "false" : "true") + " was taken for it.");
  }

  void CheckCurve(const StepEntity& entity, const StepRecord& record) {
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

  static std::vector<std::uint64_t> ReferencesIn(std::string_view body) {
    std::vector<std::uint64_t> references;
    ForEachReference(body, [&](std::uint64_t id) { references.push_back(id); });
    return references;
  }

  // On a surface that goes around an axis an edge that is followed by itself in the other sense encloses nothing; OpenCASCADE takes it for the
  // seam. It is one where it turns back on the axis: at the apex of a cone, at the pole of a sphere.
  void LeaveOutSpurs() {
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

  // One use of an edge in a loop.
  struct Use {
    std::uint64_t oriented = 0, edge = 0;
    bool forward = true;
  };

  // True if the use ends on the axis of the surface, or nobody knows where.
  bool EndsOnAxis(const Use& use, const StepEntity& surface) const {
    const auto edge = Record(use.edge), form = entities_.Record(surface);
    if (!edge || !form) return true;
    const auto vertex = Record(ReferenceIn(*edge, use.forward ? 2 : 1));
    const auto point = vertex ? Coordinates(Value(*vertex, 1)) : std::nullopt;
    if (!point) return true;
    const Similarity frame = FrameOf(ReferenceIn(*form, 1));
    const Vector axis{frame.linear[2], frame.linear[5], frame.linear[8]},
        offset = Minus(*point, frame.origin, 1);
    const Vector across = Minus(offset, axis, Dot(offset, axis));
    // Coordinates in files have six digits or more.
    constexpr double kRounding = 1e-5;
    return !(Dot(across, across) > kRounding * kRounding * Dot(offset, offset));
  }

  void LeaveOutSpurs(const StepEntity& loop, const StepEntity& surface) {
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
    // Reduce the word of uses, then its two ends against each other.
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
    Warn("The edge loop " + Label(loop.id) + " runs along edges there and back; those edges were left out.");
    std::string body = "EDGE_LOOP('',(";
    for (std::size_t i = 0; i < kept.size(); ++i) body += (i == 0 ? "" : ",") + Label(kept[i].oriented);
    edits_[&loop] = body + "))";
  }

  void Remove(const StepEntity& entity, const char* what) {
    if (removed_.contains(entity.id)) return;
    std::string name = entity.keyword.empty() ? "entity" : Lower(entity.keyword);
    name += " " + Label(entity.id);
    Warn("The " + name + " " + what + "; it was left out.");
    Out(entity, "its " + name + " " + what);
  }

  void Out(const StepEntity& entity, const std::string& reason) {
    removed_[entity.id] = reason;
    gone_.insert(&entity);
    open_.push_back(entity.id);
    if (IsFaceKeyword(entity.keyword)) repair_.faces_out[entity.id] = reason;
  }

  // Takes out what cannot be without what is out, step by step.
  void TakeOut() {
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
      // What refers to anything of this wave, in the order of the file.
      std::map<const StepEntity*, std::vector<std::uint64_t>> touched;
      for (const std::uint64_t id : open_) {
        for (const StepEntity* user : users[id]) {
          if (!gone_.contains(user)) touched[user].push_back(id);
        }
      }
      open_.clear();
      for (const auto& [user, ids] : touched)
        TakeOutOf(*user, {ids.begin(), ids.end()}, removed_[ids.front()]);
    }
  }

  // Takes what is out out of an entity's lists, or the entity itself out.
  void TakeOutOf(const StepEntity& user, const std::unordered_set<std::uint64_t>& ids,
                 const std::string& reason) {
    std::optional<StepRecord> record = RecordOf(user);
    if (!record) return;
    const bool whole = record->complex || Holds(kWhole, user.keyword);
    bool needed = false;
    for (StepPart& part : record->parts) needed = WithoutReferences(part.values, ids, whole) || needed;
    if (needed) return Out(user, reason);
    Edit(user, *record);
    // A list that is empty now may be one too many.
    for (const Needed& rule : kNeeded) {
      if (rule.keyword == user.keyword && IsEmpty(Value(*record, rule.attribute))) return Out(user, reason);
    }
    if (IsSurfaceCurve(user.keyword)) CheckCurve(user, *record);
  }

  // Takes the reference out of lists; true if an attribute itself, or a list that must be whole, holds it.
  static bool WithoutReferences(std::vector<StepValue>& values, const std::unordered_set<std::uint64_t>& ids,
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

  std::uint64_t NewEntity(const std::string& body) {
    const std::uint64_t id = entities_.largest_id() + ++added_count_;
    added_ += Label(id) + "=" + body + ";\n";
    return id;
  }

  std::uint64_t NewFrame(const Similarity& frame) {
    const LinearMap& m = frame.linear;
    const std::uint64_t origin = NewEntity("CARTESIAN_POINT(''," + Triple(frame.origin) + ")");
    const std::uint64_t axis = NewEntity("DIRECTION(''," + Triple({m[2], m[5], m[8]}) + ")");
    const std::uint64_t reference = NewEntity("DIRECTION(''," + Triple({m[0], m[3], m[6]}) + ")");
    return NewEntity("AXIS2_PLACEMENT_3D(''," + Label(origin) + "," + Label(axis) + "," + Label(reference) +
                     ")");
  }

  void FindRepresentations() {
    if (found_representations_) return;
    found_representations_ = true;
    for (const StepEntity& entity : entities_.all()) {
      if (entity.structure != 0 || gone_.contains(&entity) || dropped_.contains(&entity)) continue;
      if (!entity.keyword.empty() && !entity.keyword.ends_with("REPRESENTATION")) continue;
      if (entity.keyword.empty() &&
          entity.Body(entities_.bytes()).find("REPRESENTATION") == std::string_view::npos)
        continue;
      const auto record = RecordOf(entity);
      if (!record) continue;
      if (auto representation = AsRepresentation(entity, *record))
        representations_.push_back(std::move(*representation));
    }
  }

  // A replica of a solid is a mapped item of a representation of its own.
  void MapReplicas() {
    const bool any = std::any_of(entities_.all().begin(), entities_.all().end(),
                                 [](const StepEntity& entity) { return entity.keyword == "SOLID_REPLICA"; });
    if (!any) return;
    FindRepresentations();
    const std::vector<Representation> representations = representations_;
    for (const Representation& representation : representations) {
      for (const std::uint64_t item : representation.items) {
        const StepEntity* entity = entities_.Find(item);
        if (entity == nullptr || entity->keyword != "SOLID_REPLICA") continue;
        std::optional<StepRecord> record = RecordOf(*entity);
        if (!record || record->parts.front().keyword != "SOLID_REPLICA") continue;
        const StepValue *parent = Value(*record, 1), *transformation = Value(*record, 2);
        if (parent == nullptr || transformation == nullptr || !parent->IsReference() ||
            !transformation->IsReference() || !OperatorOf(transformation->reference))
          continue;
        const std::uint64_t frame = NewFrame({});
        const std::uint64_t source =
            NewEntity("SHAPE_REPRESENTATION('',(" + Label(frame) + "," + Label(parent->reference) + ")," +
                      Label(representation.context) + ")");
        representations_.push_back({source, {parent->reference}, representation.context});
        const std::uint64_t map = NewEntity("REPRESENTATION_MAP(" + Label(frame) + "," + Label(source) + ")");
        edits_[entity] = "MAPPED_ITEM(" + ToText(record->parts.front().values.front()) + "," + Label(map) +
                         "," + Label(transformation->reference) + ")";
        replicas_.push_back(entity);
      }
    }
  }

  std::optional<Vector> Coordinates(const StepValue* reference) const {
    if (reference == nullptr || !reference->IsReference()) return {};
    const auto record = Record(reference->reference);
    if (!record || Value(*record, 1) == nullptr) return {};
    const std::vector<double> numbers = Value(*record, 1)->Numbers();
    if (numbers.size() != 3) return {};
    return Vector{numbers[0], numbers[1], numbers[2]};
  }

  // CARTESIAN_TRANSFORMATION_OPERATOR_3D, by ISO 10303-42: base_axis(3, axis1, axis2, axis3).
  std::optional<Similarity> OperatorOf(std::uint64_t id) const {
    const auto record = Record(id);
    if (!record || record->parts.front().keyword != "CARTESIAN_TRANSFORMATION_OPERATOR_3D") return {};
    const std::vector<StepValue>& values = record->parts.front().values;
    // Some schemas count the name of the item and that of the transformation, some only one.
    if (values.size() < 7 || values.size() > 8) return {};
    const std::size_t first = values.size() - 5;
    const auto axis1 = Coordinates(&values[first]), axis2 = Coordinates(&values[first + 1]);
    const auto origin = Coordinates(&values[first + 2]), axis3 = Coordinates(&values[first + 4]);
    const double scale = values[first + 3].kind == Kind::kUnset ? 1 : values[first + 3].Number(NAN);
    if (!origin || !(scale > 0) || !std::isfinite(scale)) return {};
    const auto z = axis3 ? Unit(*axis3) : Vector{0, 0, 1};
    if (!z) return {};
    // The x axis lies across z, the y axis across both, on the side that the file says.
    Vector wish = axis1 ? *axis1 : std::fabs((*z)[0]) < 0.9 ? Vector{1, 0, 0} : Vector{0, 1, 0};
    const auto x = Unit(Minus(wish, *z, Dot(wish, *z)));
    if (!x) return {};
    Vector y = Cross(*z, *x);
    if (axis2 && Dot(*axis2, y) < 0) y = {-y[0], -y[1], -y[2]};
    Similarity similarity;
    for (std::size_t r = 0; r < 3; ++r) {
      similarity.linear[3 * r] = scale * (*x)[r];
      similarity.linear[3 * r + 1] = scale * y[r];
      similarity.linear[3 * r + 2] = scale * (*z)[r];
    }
    similarity.origin = *origin;
    return similarity;
  }

  // AXIS2_PLACEMENT_3D; the identity where there is none.
  Similarity FrameOf(std::uint64_t id) const {
    Similarity frame;
    const auto record = Record(id);
    if (!record || record->parts.front().keyword != "AXIS2_PLACEMENT_3D") return frame;
    if (const auto origin = Coordinates(Value(*record, 1))) frame.origin = *origin;
    const auto axis = Coordinates(Value(*record, 2)), reference = Coordinates(Value(*record, 3));
    const auto z = axis ? Unit(*axis) : Vector{0, 0, 1};
    if (!z) return frame;
    const Vector wish = reference ? *reference : std::fabs((*z)[0]) < 0.9 ? Vector{1, 0, 0} : Vector{0, 1, 0};
    const auto x = Unit(Minus(wish, *z, Dot(wish, *z)));
    if (!x) return frame;
    const Vector y = Cross(*z, *x);
    for (std::size_t r = 0; r < 3; ++r) {
      frame.linear[3 * r] = (*x)[r];
      frame.linear[3 * r + 1] = y[r];
      frame.linear[3 * r + 2] = (*z)[r];
    }
    return frame;
  }

  // The rotation that is written for a map: itself if it is one. Nothing if there are too many.
  std::optional<LinearMap> RotationFor(const LinearMap& map) {
    if (IsRotation(map)) return map;
    const auto same = [&](const LinearMap& other) {
      double distance = 0, size = 0;
      for (std::size_t i = 0; i < map.size(); ++i) {
        distance = std::fmax(distance, std::fabs(map[i] - other[i]));
        size = std::fmax(size, std::fabs(map[i]));
      }
      return distance <= 1e-14 * size;
    };
    auto known = std::find_if(repair_.linear_maps.begin(), repair_.linear_maps.end(), same);
    if (known == repair_.linear_maps.end()) {
      if (repair_.linear_maps.size() == kMostLinearMaps) return {};
      repair_.linear_maps.push_back(map);
      known = repair_.linear_maps.end() - 1;
    }
    return StandIn(static_cast<std::size_t>(known - repair_.linear_maps.begin()));
  }

  // Placements that OpenCASCADE 7.6 gets wrong become a frame each, seen from the origin: operators, which it takes for rotations; and pairs of
  // frames A and B, of which it makes A⁻¹ · B where B · A⁻¹ is meant. The two agree where one of the frames is the origin, as it mostly is.
  void MapOperators() {
    for (const StepEntity& entity : entities_.all()) {
      if (entity.structure != 0 || gone_.contains(&entity) || dropped_.contains(&entity)) continue;
      if (entity.keyword == "MAPPED_ITEM" || (entity.keyword == "SOLID_REPLICA" && edits_.contains(&entity)))
        MapItem(entity);
      if (entity.keyword.empty()) MapRelationship(entity);
    }
  }

  bool Is(std::uint64_t id, std::string_view keyword) const {
    const StepEntity* entity = entities_.Find(id);
    return entity != nullptr && entity->keyword == keyword;
  }

  // What the target of a placement does; nothing if it is no kind that is known here.
  std::optional<Similarity> TargetOf(std::uint64_t id) const {
    if (Is(id, "CARTESIAN_TRANSFORMATION_OPERATOR_3D")) return OperatorOf(id);
    if (Is(id, "AXIS2_PLACEMENT_3D")) return FrameOf(id);
    return {};
  }

  // target · origin⁻¹.
  static Similarity Placed(const Similarity& target, const Similarity& origin) {
    Similarity placed;
    placed.linear = Product(target.linear, Transposed(origin.linear));
    placed.origin = Minus(target.origin, Apply(placed.linear, origin.origin), 1);
    return placed;
  }

  // True if OpenCASCADE's origin⁻¹ · target is the same.
  static bool Commutes(const Similarity& target, const Similarity& origin) {
    const Similarity right = Placed(target, origin);
    const LinearMap back = Transposed(origin.linear), linear = Product(back, target.linear);
    const Vector at = Apply(back, Minus(target.origin, origin.origin, 1));
    double distance = 0, size = 0;
    for (std::size_t i = 0; i < 9; ++i)
      distance = std::fmax(distance, std::fabs(linear[i] - right.linear[i]));
    double moved = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      moved = std::fmax(moved, std::fabs(at[i] - right.origin[i]));
      size = std::fmax(size, std::fmax(std::fabs(target.origin[i]), std::fabs(origin.origin[i])));
    }
    constexpr double kRounding = 1e-9;
    return distance <= kRounding && moved <= kRounding * size;
  }

  // The frame that is written for the placement: itself, or its stand-in.
  std::optional<std::uint64_t> FrameFor(Similarity placed) {
    const std::optional<LinearMap> rotation = RotationFor(placed.linear);
    if (!rotation) return {};
    placed.linear = *rotation;
    return NewFrame(placed);
  }

  void MapItem(const StepEntity& entity) {
    std::optional<StepRecord> record = RecordOf(entity);
    if (!record || record->parts.front().values.size() != 3) return;
    std::vector<StepValue>& values = record->parts.front().values;
    if (!values[1].IsReference() || !values[2].IsReference()) return;
    const bool is_operator = Is(values[2].reference, "CARTESIAN_TRANSFORMATION_OPERATOR_3D");
    const std::optional<Similarity> target = TargetOf(values[2].reference);
    if (!target && is_operator) return LosePlacement(entity, NameIn(*record));
    // A replica's own map, made by us, is seen from the origin; so is one whose origin is of another kind.
    const auto map = Record(values[1].reference);
    const std::uint64_t from = map ? ReferenceIn(*map, 0) : 0;
    const bool framed = Is(from, "AXIS2_PLACEMENT_3D");
    const Similarity origin = framed ? FrameOf(from) : Similarity{};
    if (!target || (!is_operator && (!framed || Commutes(*target, origin)))) return;
    const std::optional<std::uint64_t> frame = FrameFor(Placed(*target, origin));
    if (!frame) return LosePlacement(entity, NameIn(*record));
    if (map)
      values[1].reference =
          NewEntity("REPRESENTATION_MAP(" + Label(NewFrame({})) + "," + Label(ReferenceIn(*map, 1)) + ")");
    values[2].reference = *frame;
    Edit(entity, *record);
  }

  const Representation* FindRepresentation(std::uint64_t id) {
    FindRepresentations();
    if (representation_of_.empty()) {
      for (std::size_t i = 0; i < representations_.size(); ++i)
        representation_of_[representations_[i].id] = i;
    }
    const auto known = representation_of_.find(id);
    return known == representation_of_.end() ? nullptr : &representations_[known->second];
  }

  void MapRelationship(const StepEntity& entity) {
    if (entity.Body(entities_.bytes()).find("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION") ==
        std::string_view::npos)
      return;
    std::optional<StepRecord> record = RecordOf(entity);
    if (!record) return;
    StepPart* transformation = nullptr;
    for (StepPart& part : record->parts) {
      if (part.keyword == "REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION") transformation = &part;
    }
    if (transformation == nullptr || transformation->values.size() != 1 ||
        !transformation->values[0].IsReference())
      return;
    std::uint64_t& used = transformation->values[0].reference;
    std::optional<Similarity> placed;
    if (Is(used, "CARTESIAN_TRANSFORMATION_OPERATOR_3D")) {
      placed = OperatorOf(used);
      if (!placed) return LosePlacement(entity, {});
    } else if (Is(used, "ITEM_DEFINED_TRANSFORMATION")) {
      placed = PlacedByItems(used, *record);
    }
    if (!placed) return;
    const std::optional<std::uint64_t> frame = FrameFor(*placed);
    if (!frame) return LosePlacement(entity, {});
    used = NewEntity("ITEM_DEFINED_TRANSFORMATION('',''," + Label(NewFrame({})) + "," + Label(*frame) + ")");
    Edit(entity, *record);
  }

  // Nothing where OpenCASCADE gets it right, or the two representations have contexts, and may have units, of their own.
  std::optional<Similarity> PlacedByItems(std::uint64_t id, const StepRecord& relationship) {
    const auto items = Record(id);
    const StepPart* part = relationship.Find("REPRESENTATION_RELATIONSHIP");
    if (!items || items->parts.front().values.size() != 4 || part == nullptr || part->values.size() != 4)
      return {};
    std::uint64_t first = ReferenceIn(*items, 2), second = ReferenceIn(*items, 3);
    const Representation *from = FindRepresentation(part->values[2].reference),
                         *to = FindRepresentation(part->values[3].reference);
    if (from == nullptr || to == nullptr || from->context != to->context) return {};
    if (!Is(first, "AXIS2_PLACEMENT_3D") || !Is(second, "AXIS2_PLACEMENT_3D")) return {};
    // Some writers name the two the other way around.
    const auto holds = [](const Representation* representation, std::uint64_t item) {
      return std::find(representation->items.begin(), representation->items.end(), item) !=
             representation->items.end();
    };
    if (!holds(from, first) && holds(to, first) && holds(from, second)) std::swap(first, second);
    const Similarity origin = FrameOf(first), target = FrameOf(second);
    if (Commutes(target, origin)) return {};
    return Placed(target, origin);
  }

  void LosePlacement(const StepEntity& entity, const std::string& name) {
    repair_.lost.push_back(
        {Label(entity.id), name, "its transformation, which scales or mirrors, cannot be computed"});
    removed_[entity.id] = "its transformation cannot be computed";
    gone_.insert(&entity);
  }

  // Items of shapes that are no bodies: curves, which are not drawn, and kinds that are not known here.
  void NoteOtherItem(const StepEntity& item) {
    if (Holds(kCurveSets, item.keyword)) {
      ++curve_sets_;
    } else if (!item.keyword.empty() && !Holds(kRead, item.keyword) && !Holds(kWithoutBody, item.keyword) &&
               !item.keyword.ends_with("_CURVE") && !item.keyword.ends_with("_SURFACE") &&
               item.keyword.find("REPRESENTATION_ITEM") == std::string_view::npos &&
               item.keyword.find("ANNOTATION") == std::string_view::npos) {
      Warn("Item " + Label(item.id) + " of a shape, of the kind " + std::string(item.keyword) +
           ", is not shown.");
    }
  }

  // Bodies of kinds that nobody reads, as items of representations.
  void FindUnread() {
    FindRepresentations();
    std::set<std::uint64_t> seen;
    for (const Representation& representation : representations_) {
      for (const std::uint64_t item : representation.items) {
        const StepEntity* entity = entities_.Find(item);
        if (entity == nullptr || gone_.contains(entity) ||
            std::find(replicas_.begin(), replicas_.end(), entity) != replicas_.end() ||
            !seen.insert(item).second)
          continue;
        const auto unread = std::find_if(kUnread.begin(), kUnread.end(),
                                         [&](const Unread& kind) { return kind.keyword == entity->keyword; });
        if (unread == kUnread.end()) {
          const StepEntity* holder = entities_.Find(representation.id);
          if (holder != nullptr && holder->keyword.ends_with("SHAPE_REPRESENTATION")) NoteOtherItem(*entity);
          continue;
        }
        const auto record = RecordOf(*entity);
        // A tessellation that says of which body it is one is not missed where the body is shown.
        if (record && entity->keyword.starts_with("TESSELLATED_S") && Value(*record, 2) != nullptr &&
            Value(*record, 2)->IsReference())
          continue;
        repair_.lost.push_back({Label(item), record ? NameIn(*record) : "",
                                std::string("it is ") + unread->what + " (" + std::string(entity->keyword) +
                                    "), and only boundary representations are read; export it as one"});
      }
    }
    if (curve_sets_ > 0)
      Warn("The file holds " + std::to_string(curve_sets_) +
           (curve_sets_ == 1 ? " set of curves (a wireframe), which is not shown."
                             : " sets of curves (wireframes), which are not shown."));
  }

  std::uint64_t ReferenceIn(const StepRecord& record, std::size_t index) const {
    const StepValue* value = Value(record, index);
    return value != nullptr && value->IsReference() ? value->reference : 0;
  }

  // Occurrences that nothing places, and products that have no shape.
  void FindUnplaced() {
    std::map<std::uint64_t, const StepEntity*> usages;  // occurrences
    std::unordered_map<std::uint64_t, std::uint64_t>
        definition_of;                         // PRODUCT_DEFINITION_SHAPE → what it is the shape of
    std::vector<std::uint64_t> placed_shapes;  // … that a placement names
    std::unordered_map<std::uint64_t, std::set<std::uint64_t>> shapes;  // what has a shape → representations
    // Shape → representation; representations that are the same.
    std::vector<std::pair<std::uint64_t, std::uint64_t>> used;
    std::unordered_map<std::uint64_t, std::vector<std::uint64_t>> linked;
    std::vector<const StepEntity*> products;
    for (const StepEntity& entity : entities_.all()) {
      if (entity.structure != 0 || gone_.contains(&entity) || dropped_.contains(&entity)) continue;
      const std::string_view keyword = entity.keyword;
      const bool usage = keyword == "NEXT_ASSEMBLY_USAGE_OCCURRENCE";
      const bool shape = keyword == "PRODUCT_DEFINITION_SHAPE";
      const bool placement = keyword == "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION";
      const bool definition = keyword == "SHAPE_DEFINITION_REPRESENTATION";
      const bool link = keyword == "SHAPE_REPRESENTATION_RELATIONSHIP";
      if (keyword == "PRODUCT_DEFINITION" || keyword == "PRODUCT_DEFINITION_WITH_ASSOCIATED_DOCUMENTS")
        products.push_back(&entity);
      if (!usage && !shape && !placement && !definition && !link) continue;
      const auto record = RecordOf(entity);
      if (!record) continue;
      if (usage) usages[entity.id] = &entity;
      if (shape) definition_of[entity.id] = ReferenceIn(*record, 2);
      if (placement) placed_shapes.push_back(ReferenceIn(*record, 1));
      if (definition) used.emplace_back(ReferenceIn(*record, 0), ReferenceIn(*record, 1));
      if (link) {
        const std::uint64_t a = ReferenceIn(*record, 2), b = ReferenceIn(*record, 3);
        linked[a].push_back(b);
        linked[b].push_back(a);
      }
    }
    if (usages.empty()) return;
    FindRepresentations();
    for (const auto& [shape, representation] : used) {
      if (const auto of = definition_of.find(shape); of != definition_of.end()) {
        shapes[of->second].insert(representation);
        // Representations that are the same shape.
        const std::vector<std::uint64_t>& others = linked[representation];
        shapes[of->second].insert(others.begin(), others.end());
      }
    }
    std::set<std::uint64_t> placed, bodies, mapped;
    for (const std::uint64_t shape : placed_shapes) {
      if (const auto of = definition_of.find(shape); of != definition_of.end()) placed.insert(of->second);
    }
    std::unordered_map<std::uint64_t, std::set<std::uint64_t>> maps;  // representation → those that it maps
    for (const Representation& representation : representations_) {
      for (const std::uint64_t item : representation.items) {
        const StepEntity* entity = entities_.Find(item);
        if (entity == nullptr || gone_.contains(entity)) continue;
        const bool unread = std::any_of(kUnread.begin(), kUnread.end(),
                                        [&](const Unread& kind) { return kind.keyword == entity->keyword; });
        if (unread || Holds(kRead, entity->keyword)) bodies.insert(representation.id);
        if (entity->keyword != "MAPPED_ITEM") continue;
        const auto record = RecordOf(*entity);
        const auto map = record ? Record(ReferenceIn(*record, 1)) : std::nullopt;
        if (map) maps[representation.id].insert(ReferenceIn(*map, 1));
      }
    }
    const auto has_bodies = [&](std::uint64_t definition) {
      const std::set<std::uint64_t>& own = shapes[definition];
      return std::any_of(own.begin(), own.end(), [&](std::uint64_t id) { return bodies.contains(id); });
    };
    const auto name_of = [&](std::uint64_t definition) {
      const auto record = Record(definition);
      const auto formation = record ? Record(ReferenceIn(*record, 2)) : std::nullopt;
      const auto product = formation ? Record(ReferenceIn(*formation, 2)) : std::nullopt;
      if (!product) return std::string();
      const StepValue* name = Value(*product, 1);
      std::string text =
          name != nullptr && name->kind == Kind::kString ? DecodeStepText(name->text) : std::string();
      return text.empty() ? NameIn(*product) : text;
    };
    std::set<std::uint64_t> parents, children;
    for (const auto& [id, entity] : usages) {
      const auto record = RecordOf(*entity);
      if (!record) continue;
      const std::uint64_t parent = ReferenceIn(*record, 3), child = ReferenceIn(*record, 4);
      parents.insert(parent);
      children.insert(child);
    }
    for (const auto& [id, entity] : usages) {
      const auto record = RecordOf(*entity);
      if (!record || placed.contains(id)) continue;
      const std::uint64_t parent = ReferenceIn(*record, 3), child = ReferenceIn(*record, 4);
      // The parent may hold the child as a mapped item instead.
      const bool is_mapped =
          std::any_of(shapes[parent].begin(), shapes[parent].end(), [&](std::uint64_t own) {
            return std::any_of(shapes[child].begin(), shapes[child].end(),
                               [&](std::uint64_t other) { return maps[own].contains(other); });
          });
      if (is_mapped || (!has_bodies(child) && !parents.contains(child))) continue;
      if (parent == child) {
        Warn("The assembly '" + name_of(child) + "' contains itself, by occurrence " + Label(id) +
             ", which is not shown.");
        continue;
      }
      const StepValue* name = Value(*record, 1);
      std::string text =
          name != nullptr && name->kind == Kind::kString ? DecodeStepText(name->text) : std::string();
      repair_.lost.push_back(
          {Label(id), text.empty() ? name_of(child) : text,
           "this occurrence of part '" + name_of(child) + "' has no placement in its assembly"});
    }
    for (const StepEntity* product : products) {
      if (parents.contains(product->id) || has_bodies(product->id)) continue;
      Warn("The part '" + name_of(product->id) + "' (" + Label(product->id) + ") has no shape.");
    }
  }

  // A length unit whose length in metres can be read: an SI unit, or a multiple of one.
  bool IsReadable(const StepRecord& unit, int depth = 0) const {
    constexpr int kDeepest = 8;
    constexpr std::array<std::string_view, 16> kPrefixes{"EXA",   "PETA", "TERA",  "GIGA",  "MEGA",  "KILO",
                                                         "HECTO", "DECA", "DECI",  "CENTI", "MILLI", "MICRO",
                                                         "NANO",  "PICO", "FEMTO", "ATTO"};
    if (const StepPart* si = unit.Find("SI_UNIT")) {
      // The dimensions come first where the unit is an entity of one part.
      const std::size_t first = si->values.size() == 3 ? 1 : 0;
      if (si->values.size() < first + 2) return false;
      const StepValue &prefix = si->values[first], &name = si->values[first + 1];
      return name.text == "METRE" &&
             (prefix.kind == Kind::kUnset || (prefix.kind == Kind::kEnum && Holds(kPrefixes, prefix.text)));
    }
    const StepPart* multiple = unit.Find("CONVERSION_BASED_UNIT");
    if (multiple == nullptr || multiple->values.size() < 2 || depth == kDeepest) return false;
    const StepValue& factor = multiple->values.back();
    const auto measure = factor.IsReference() ? Record(factor.reference) : std::nullopt;
    if (!measure) return false;
    for (const StepPart& part : measure->parts) {
      if (part.values.size() < 2 || !part.values[1].IsReference()) continue;
      const auto base = Record(part.values[1].reference);
      return part.values[0].Number(0) > 0 && base && IsReadable(*base, depth + 1);
    }
    return false;
  }

  // True if the context assigns a length unit that can be read. One that cannot is made millimetres.
  bool HasLengthUnit(std::uint64_t context) {
    const auto record = Record(context);
    if (!record) return false;
    const StepPart* units = record->Find("GLOBAL_UNIT_ASSIGNED_CONTEXT");
    if (units == nullptr) return false;
    for (const StepValue& list : units->values) {
      for (const StepValue& item : list.items) {
        const StepEntity* entity = item.IsReference() ? entities_.Find(item.reference) : nullptr;
        const auto unit = entity ? RecordOf(*entity) : std::nullopt;
        if (!unit || unit->Find("LENGTH_UNIT") == nullptr) continue;
        if (IsReadable(*unit)) return true;
        edits_[entity] = "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))";
        return false;
      }
    }
    return false;
  }

  void CheckUnits() {
    FindRepresentations();
    std::unordered_map<std::uint64_t, bool> known;
    for (const Representation& representation : representations_) {
      const bool bodies =
          std::any_of(representation.items.begin(), representation.items.end(), [&](std::uint64_t item) {
            const StepEntity* entity = entities_.Find(item);
            return entity != nullptr && Holds(kRead, entity->keyword);
          });
      if (!bodies) continue;
      const auto [context, added] = known.try_emplace(representation.context, false);
      if (added) context->second = HasLengthUnit(representation.context);
      if (!context->second) repair_.unit_missing = true;
    }
  }

  // Texts are cut where the reader's room for them ends.
  void AppendShortened(std::string_view text, std::uint64_t id, std::string& out) {
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
        // The reader has no room for a long comment, either; nobody misses it.
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
        // Neither half of a doubled apostrophe, nor of a directive, nor of a character of several bytes stays behind.
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

  // References to what is known under another number now.
  std::string WithAliases(const std::string& body) const {
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
        // An alias of an alias; a circle of them is left to whoever reads it.
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

  void Write() {
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
      // What is new goes to the end of the data.
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

  bool HasLongText() const {
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
      // Halves of a text with doubled apostrophes are as good as their sum: look at what follows together.
      std::size_t begin = end;
      while (at < bytes.size() && bytes[at] == '\'') {
        const std::size_t next = bytes.find('\'', at + 1);
        if (next == std::string_view::npos || next - begin > kLongestText) return true;
        at = next + 1;
      }
    }
    return false;
  }

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

}  // namespace

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
      // The list of what is seen from outside.
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
      // A face as an entity of several parts.
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
  // A surface that two sets hold is one.
  std::unordered_set<std::uint64_t> seen;
  std::erase_if(faces, [&](const StepFace& face) { return !seen.insert(face.id).second; });
  return faces;
}

}  // namespace facetless

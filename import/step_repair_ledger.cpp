// Lists what the file declares but the importer does not read or no placement places, and checks units.
#include "import/step_repairer.h"

#include <map>
#include <set>

namespace facetless::step_repair {

namespace {

// Bodies that OpenCASCADE 7.6 does not convert to shapes, and their names in reports.
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

// Bodies and sheets of faces that OpenCASCADE reads.
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
// Items of a shape that are not visible.
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

// Returns an attribute that is a text, decoded; empty if it is no text.
std::string TextIn(const StepRecord& record, std::size_t index) {
  const StepValue* value = Value(record, index);
  return value != nullptr && value->kind == Kind::kString ? DecodeStepText(value->text) : std::string();
}

}  // namespace

void Repairer::NoteOtherItem(const StepEntity& item) {
  if (Holds(kCurveSets, item.keyword)) {
    ++curve_sets_;
  } else if (!item.keyword.empty() && !Holds(kRead, item.keyword) && !Holds(kWithoutBody, item.keyword) &&
             !item.keyword.ends_with("_CURVE") && !item.keyword.ends_with("_SURFACE") &&
             item.keyword.find("REPRESENTATION_ITEM") == std::string_view::npos &&
             item.keyword.find("ANNOTATION") == std::string_view::npos) {
    Warn("Item " + Label(item.id) + " of a shape is of the kind " + std::string(item.keyword) +
         ", which is not shown.");
  }
}

void Repairer::FindUnread() {
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
      const auto record = FindStepRecord(*entity);
      // A tessellation that names its body is not lost if that body is shown.
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

std::uint64_t Repairer::ReferenceIn(const StepRecord& record, std::size_t index) const {
  const StepValue* value = Value(record, index);
  return value != nullptr && value->IsReference() ? value->reference : 0;
}

// The assembly data of the file. Definitions, shapes and representations are given by their ids.
struct Repairer::Assembly {
  std::map<std::uint64_t, const StepEntity*> usages;  // occurrences
  std::vector<const StepEntity*> products;
  // PRODUCT_DEFINITION_SHAPE → the definition or occurrence whose shape it is.
  std::unordered_map<std::uint64_t, std::uint64_t> definition_of;
  std::vector<std::uint64_t> placed_shapes;  // PRODUCT_DEFINITION_SHAPEs to which a placement refers
  std::vector<std::pair<std::uint64_t, std::uint64_t>> used;             // shape → representation
  std::unordered_map<std::uint64_t, std::vector<std::uint64_t>> linked;  // representations of the same shape
  std::unordered_map<std::uint64_t, std::set<std::uint64_t>>
      shapes;  // definition or occurrence → representations
  std::unordered_map<std::uint64_t, std::set<std::uint64_t>>
      maps;                             // representation → representations that it maps
  std::set<std::uint64_t> placed;       // occurrences with a placement
  std::set<std::uint64_t> with_bodies;  // representations that contain bodies
  std::set<std::uint64_t> parents;      // definitions with components

  const std::set<std::uint64_t>& ShapesOf(std::uint64_t definition) const {
    static const std::set<std::uint64_t> none;
    const auto found = shapes.find(definition);
    return found == shapes.end() ? none : found->second;
  }
  bool HasBodies(std::uint64_t definition) const {
    const std::set<std::uint64_t>& own = ShapesOf(definition);
    return std::any_of(own.begin(), own.end(), [&](std::uint64_t id) { return with_bodies.contains(id); });
  }
  // Returns whether the parent contains the child as a mapped item.
  bool IsMapped(std::uint64_t parent, std::uint64_t child) const {
    for (const std::uint64_t own : ShapesOf(parent)) {
      const auto mapped = maps.find(own);
      if (mapped == maps.end()) continue;
      for (const std::uint64_t other : ShapesOf(child))
        if (mapped->second.contains(other)) return true;
    }
    return false;
  }
};

void Repairer::CollectAssembly(Assembly& assembly) const {
  for (const StepEntity& entity : entities_.all()) {
    if (entity.structure != 0 || gone_.contains(&entity) || dropped_.contains(&entity)) continue;
    const std::string_view keyword = entity.keyword;
    const bool usage = keyword == "NEXT_ASSEMBLY_USAGE_OCCURRENCE";
    const bool shape = keyword == "PRODUCT_DEFINITION_SHAPE";
    const bool placement = keyword == "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION";
    const bool definition = keyword == "SHAPE_DEFINITION_REPRESENTATION";
    const bool link = keyword == "SHAPE_REPRESENTATION_RELATIONSHIP";
    if (keyword == "PRODUCT_DEFINITION" || keyword == "PRODUCT_DEFINITION_WITH_ASSOCIATED_DOCUMENTS")
      assembly.products.push_back(&entity);
    if (!usage && !shape && !placement && !definition && !link) continue;
    const auto record = FindStepRecord(entity);
    if (!record) continue;
    if (usage) {
      assembly.usages[entity.id] = &entity;
      assembly.parents.insert(ReferenceIn(*record, 3));
    }
    if (shape) assembly.definition_of[entity.id] = ReferenceIn(*record, 2);
    if (placement) assembly.placed_shapes.push_back(ReferenceIn(*record, 1));
    if (definition) assembly.used.emplace_back(ReferenceIn(*record, 0), ReferenceIn(*record, 1));
    if (link) {
      const std::uint64_t a = ReferenceIn(*record, 2), b = ReferenceIn(*record, 3);
      assembly.linked[a].push_back(b);
      assembly.linked[b].push_back(a);
    }
  }
}

void Repairer::CollectShapes(Assembly& assembly) const {
  for (const auto& [shape, representation] : assembly.used) {
    const auto of = assembly.definition_of.find(shape);
    if (of == assembly.definition_of.end()) continue;
    std::set<std::uint64_t>& shapes = assembly.shapes[of->second];
    shapes.insert(representation);
    const std::vector<std::uint64_t>& others = assembly.linked[representation];
    shapes.insert(others.begin(), others.end());
  }
  for (const std::uint64_t shape : assembly.placed_shapes) {
    const auto of = assembly.definition_of.find(shape);
    if (of != assembly.definition_of.end()) assembly.placed.insert(of->second);
  }
  for (const Representation& representation : representations_) {
    for (const std::uint64_t item : representation.items) {
      const StepEntity* entity = entities_.Find(item);
      if (entity == nullptr || gone_.contains(entity)) continue;
      const bool unread = std::any_of(kUnread.begin(), kUnread.end(),
                                      [&](const Unread& kind) { return kind.keyword == entity->keyword; });
      if (unread || Holds(kRead, entity->keyword)) assembly.with_bodies.insert(representation.id);
      if (entity->keyword != "MAPPED_ITEM") continue;
      const auto record = FindStepRecord(*entity);
      const auto map = record ? Record(ReferenceIn(*record, 1)) : std::nullopt;
      if (map) assembly.maps[representation.id].insert(ReferenceIn(*map, 1));
    }
  }
}

std::string Repairer::NameOfDefinition(std::uint64_t definition) const {
  const auto record = Record(definition);
  const auto formation = record ? Record(ReferenceIn(*record, 2)) : std::nullopt;
  const auto product = formation ? Record(ReferenceIn(*formation, 2)) : std::nullopt;
  if (!product) return {};
  const std::string text = TextIn(*product, 1);
  return text.empty() ? NameIn(*product) : text;
}

void Repairer::FindUnplaced() {
  Assembly assembly;
  CollectAssembly(assembly);
  if (assembly.usages.empty()) return;
  FindRepresentations();
  CollectShapes(assembly);
  for (const auto& [id, entity] : assembly.usages) {
    const auto record = FindStepRecord(*entity);
    if (!record || assembly.placed.contains(id)) continue;
    const std::uint64_t parent = ReferenceIn(*record, 3), child = ReferenceIn(*record, 4);
    if (assembly.IsMapped(parent, child)) continue;
    if (!assembly.HasBodies(child) && !assembly.parents.contains(child)) continue;
    if (parent == child) {
      Warn("The assembly '" + NameOfDefinition(child) + "' contains itself, by occurrence " + Label(id) +
           ", which is not shown.");
      continue;
    }
    const std::string text = TextIn(*record, 1);
    repair_.lost.push_back(
        {Label(id), text.empty() ? NameOfDefinition(child) : text,
         "this occurrence of part '" + NameOfDefinition(child) + "' has no placement in its assembly"});
  }
  for (const StepEntity* product : assembly.products) {
    if (assembly.parents.contains(product->id) || assembly.HasBodies(product->id)) continue;
    Warn("The part '" + NameOfDefinition(product->id) + "' (" + Label(product->id) + ") has no shape.");
  }
}

bool Repairer::IsReadable(const StepRecord& unit, int depth) const {
  constexpr int kDeepest = 8;
  constexpr std::array<std::string_view, 16> kPrefixes{"EXA",   "PETA", "TERA",  "GIGA",  "MEGA",  "KILO",
                                                       "HECTO", "DECA", "DECI",  "CENTI", "MILLI", "MICRO",
                                                       "NANO",  "PICO", "FEMTO", "ATTO"};
  if (const StepPart* si = unit.Find("SI_UNIT")) {
    // If the unit is an entity of one part, the dimensions are its first attribute.
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

bool Repairer::HasLengthUnit(std::uint64_t context) {
  const auto record = Record(context);
  if (!record) return false;
  const StepPart* units = record->Find("GLOBAL_UNIT_ASSIGNED_CONTEXT");
  if (units == nullptr) return false;
  for (const StepValue& list : units->values) {
    for (const StepValue& item : list.items) {
      const StepEntity* entity = item.IsReference() ? entities_.Find(item.reference) : nullptr;
      const auto unit = entity ? FindStepRecord(*entity) : std::nullopt;
      if (!unit || unit->Find("LENGTH_UNIT") == nullptr) continue;
      if (IsReadable(*unit)) return true;
      edits_[entity] = "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))";
      return false;
    }
  }
  return false;
}

void Repairer::CheckUnits() {
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

}  // namespace facetless::step_repair

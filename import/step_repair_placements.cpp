// Rewrites placements that OpenCASCADE evaluates wrongly as frames of their own.
#include "import/step_repairer.h"

#include <cstdio>

namespace facetless::step_repair {

namespace {

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

}  // namespace

std::uint64_t Repairer::NewEntity(const std::string& body) {
  const std::uint64_t id = entities_.largest_id() + ++added_count_;
  added_ += Label(id) + "=" + body + ";\n";
  return id;
}

std::uint64_t Repairer::NewFrame(const Similarity& frame) {
  const LinearMap& m = frame.linear;
  const std::uint64_t origin = NewEntity("CARTESIAN_POINT(''," + Triple(frame.origin) + ")");
  const std::uint64_t axis = NewEntity("DIRECTION(''," + Triple({m[2], m[5], m[8]}) + ")");
  const std::uint64_t reference = NewEntity("DIRECTION(''," + Triple({m[0], m[3], m[6]}) + ")");
  return NewEntity("AXIS2_PLACEMENT_3D(''," + Label(origin) + "," + Label(axis) + "," + Label(reference) +
                   ")");
}

void Repairer::FindRepresentations() {
  if (found_representations_) return;
  found_representations_ = true;
  for (const StepEntity& entity : entities_.all()) {
    if (entity.structure != 0 || gone_.contains(&entity) || dropped_.contains(&entity)) continue;
    if (!entity.keyword.empty() && !entity.keyword.ends_with("REPRESENTATION")) continue;
    if (entity.keyword.empty() &&
        entity.Body(entities_.bytes()).find("REPRESENTATION") == std::string_view::npos)
      continue;
    const auto record = FindStepRecord(entity);
    if (!record) continue;
    if (auto representation = AsRepresentation(entity, *record))
      representations_.push_back(std::move(*representation));
  }
}

void Repairer::MapReplicas() {
  const bool any = std::any_of(entities_.all().begin(), entities_.all().end(),
                               [](const StepEntity& entity) { return entity.keyword == "SOLID_REPLICA"; });
  if (!any) return;
  FindRepresentations();
  const std::vector<Representation> representations = representations_;
  for (const Representation& representation : representations) {
    for (const std::uint64_t item : representation.items) {
      const StepEntity* entity = entities_.Find(item);
      if (entity == nullptr || entity->keyword != "SOLID_REPLICA") continue;
      std::optional<StepRecord> record = FindStepRecord(*entity);
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

std::optional<Vector> Repairer::Coordinates(const StepValue* reference) const {
  if (reference == nullptr || !reference->IsReference()) return {};
  const auto record = Record(reference->reference);
  if (!record || Value(*record, 1) == nullptr) return {};
  const std::vector<double> numbers = Value(*record, 1)->Numbers();
  if (numbers.size() != 3) return {};
  return Vector{numbers[0], numbers[1], numbers[2]};
}

std::optional<Similarity> Repairer::OperatorOf(std::uint64_t id) const {
  const auto record = Record(id);
  if (!record || record->parts.front().keyword != "CARTESIAN_TRANSFORMATION_OPERATOR_3D") return {};
  const std::vector<StepValue>& values = record->parts.front().values;
  // Some schemas count the names of both the item and the transformation, some count only one.
  if (values.size() < 7 || values.size() > 8) return {};
  const std::size_t first = values.size() - 5;
  const auto axis1 = Coordinates(&values[first]), axis2 = Coordinates(&values[first + 1]);
  const auto origin = Coordinates(&values[first + 2]), axis3 = Coordinates(&values[first + 4]);
  const double scale = values[first + 3].kind == Kind::kUnset ? 1 : values[first + 3].Number(NAN);
  if (!origin || !(scale > 0) || !std::isfinite(scale)) return {};
  const auto z = axis3 ? Unit(*axis3) : Vector{0, 0, 1};
  if (!z) return {};
  // The x axis is perpendicular to z, and the y axis to both, on the side that the file gives.
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

Similarity Repairer::FrameOf(std::uint64_t id) const {
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

std::optional<LinearMap> Repairer::RotationFor(const LinearMap& map) {
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

void Repairer::MapOperators() {
  for (const StepEntity& entity : entities_.all()) {
    if (entity.structure != 0 || gone_.contains(&entity) || dropped_.contains(&entity)) continue;
    if (entity.keyword == "MAPPED_ITEM" || (entity.keyword == "SOLID_REPLICA" && edits_.contains(&entity)))
      MapItem(entity);
    if (entity.keyword.empty()) MapRelationship(entity);
  }
}

bool Repairer::Is(std::uint64_t id, std::string_view keyword) const {
  const StepEntity* entity = entities_.Find(id);
  return entity != nullptr && entity->keyword == keyword;
}

std::optional<Similarity> Repairer::TargetOf(std::uint64_t id) const {
  if (Is(id, "CARTESIAN_TRANSFORMATION_OPERATOR_3D")) return OperatorOf(id);
  if (Is(id, "AXIS2_PLACEMENT_3D")) return FrameOf(id);
  return {};
}

Similarity Repairer::Placed(const Similarity& target, const Similarity& origin) {
  Similarity placed;
  placed.linear = Product(target.linear, Transposed(origin.linear));
  placed.origin = Minus(target.origin, Apply(placed.linear, origin.origin), 1);
  return placed;
}

bool Repairer::Commutes(const Similarity& target, const Similarity& origin) {
  const Similarity right = Placed(target, origin);
  const LinearMap back = Transposed(origin.linear), linear = Product(back, target.linear);
  const Vector at = Apply(back, Minus(target.origin, origin.origin, 1));
  double distance = 0, size = 0;
  for (std::size_t i = 0; i < 9; ++i) distance = std::fmax(distance, std::fabs(linear[i] - right.linear[i]));
  double moved = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    moved = std::fmax(moved, std::fabs(at[i] - right.origin[i]));
    size = std::fmax(size, std::fmax(std::fabs(target.origin[i]), std::fabs(origin.origin[i])));
  }
  constexpr double kRounding = 1e-9;
  return distance <= kRounding && moved <= kRounding * size;
}

std::optional<std::uint64_t> Repairer::FrameFor(Similarity placed) {
  const std::optional<LinearMap> rotation = RotationFor(placed.linear);
  if (!rotation) return {};
  placed.linear = *rotation;
  return NewFrame(placed);
}

void Repairer::MapItem(const StepEntity& entity) {
  std::optional<StepRecord> record = FindStepRecord(entity);
  if (!record || record->parts.front().values.size() != 3) return;
  std::vector<StepValue>& values = record->parts.front().values;
  if (!values[1].IsReference() || !values[2].IsReference()) return;
  const bool is_operator = Is(values[2].reference, "CARTESIAN_TRANSFORMATION_OPERATOR_3D");
  const std::optional<Similarity> target = TargetOf(values[2].reference);
  if (!target && is_operator) return LosePlacement(entity, NameIn(*record));
  // The map that MapReplicas writes for a replica is relative to the origin. So is a map whose origin is of
  // another kind.
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

const Representation* Repairer::FindRepresentation(std::uint64_t id) {
  FindRepresentations();
  if (representation_of_.empty()) {
    for (std::size_t i = 0; i < representations_.size(); ++i) representation_of_[representations_[i].id] = i;
  }
  const auto known = representation_of_.find(id);
  return known == representation_of_.end() ? nullptr : &representations_[known->second];
}

void Repairer::MapRelationship(const StepEntity& entity) {
  if (entity.Body(entities_.bytes()).find("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION") ==
      std::string_view::npos)
    return;
  std::optional<StepRecord> record = FindStepRecord(entity);
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

std::optional<Similarity> Repairer::PlacedByItems(std::uint64_t id, const StepRecord& relationship) {
  const auto items = Record(id);
  const StepPart* part = relationship.Find("REPRESENTATION_RELATIONSHIP");
  if (!items || items->parts.front().values.size() != 4 || part == nullptr || part->values.size() != 4)
    return {};
  std::uint64_t first = ReferenceIn(*items, 2), second = ReferenceIn(*items, 3);
  const Representation *from = FindRepresentation(part->values[2].reference),
                       *to = FindRepresentation(part->values[3].reference);
  if (from == nullptr || to == nullptr || from->context != to->context) return {};
  if (!Is(first, "AXIS2_PLACEMENT_3D") || !Is(second, "AXIS2_PLACEMENT_3D")) return {};
  // Some writers name the two frames in the opposite order.
  const auto holds = [](const Representation* representation, std::uint64_t item) {
    return std::find(representation->items.begin(), representation->items.end(), item) !=
           representation->items.end();
  };
  if (!holds(from, first) && holds(to, first) && holds(from, second)) std::swap(first, second);
  const Similarity origin = FrameOf(first), target = FrameOf(second);
  if (Commutes(target, origin)) return {};
  return Placed(target, origin);
}

void Repairer::LosePlacement(const StepEntity& entity, const std::string& name) {
  repair_.lost.push_back(
      {Label(entity.id), name, "its transformation, which scales or mirrors, cannot be computed"});
  removed_[entity.id] = "its transformation cannot be computed";
  gone_.insert(&entity);
}

}  // namespace facetless::step_repair

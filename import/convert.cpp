#include "import/convert.h"

#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_set>

#include "import/bounds.h"
#include "import/part_converter.h"
#include "render/model/walk.h"

namespace facetless {
namespace {

// Begins the reason of a loss if other pieces of the face are shown.
const std::string kInPart = "a part of it is missing: ";

Placement ToPlacement(const gp_Trsf& transformation) {
  Placement placement;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) placement.m[r][c] = transformation.Value(r + 1, c + 1);
  }
  return placement;
}

void AddInstances(const CadDocument& document, ModelBuilder& builder) {
  for (const Occurrence& occurrence : document.occurrences) {
    Instance instance;
    instance.part = static_cast<std::uint32_t>(occurrence.prototype);
    instance.placement = ToPlacement(occurrence.placement);
    instance.has_color = occurrence.has_color;
    instance.color = occurrence.color;
    instance.name = occurrence.name;
    instance.hidden = occurrence.hidden;
    builder.AddInstance(std::move(instance));
  }
}

void FindLargestGap(const Model& model, ImportInfo& info) {
  for (const Face& face : model.faces) {
    const double gap = LargestGap(model, face);
    if (gap <= info.max_edge_gap_mm) continue;
    info.max_edge_gap_mm = gap;
    info.max_edge_gap_entity = face.entity;
  }
}

// Completes the list of losses so that faces_declared = faces_imported + faces_lost. A face counts once,
// however many pieces OpenCASCADE makes of it and however many parts contain it. It counts as imported if no
// piece of it is lost. A lost item that is no face (a body of another kind, an occurrence) counts as one
// declared face.
void Balance(const std::vector<DeclaredFace>& declared, const Model& model, ImportInfo& info) {
  std::unordered_set<std::string> lost, shown;
  std::erase_if(info.faces_lost,
                [&](const Loss& loss) { return !loss.entity.empty() && !lost.insert(loss.entity).second; });
  std::uint64_t unnamed = 0;
  for (const Face& face : model.faces) {
    if (face.entity.empty()) {
      ++unnamed;
    } else if (!lost.contains(face.entity)) {
      shown.insert(face.entity);
    }
  }
  for (const DeclaredFace& face : declared) {
    if (shown.contains(face.entity) || !lost.insert(face.entity).second) continue;
    info.faces_lost.push_back({kNoIndex, face.name, face.entity, "no visible shape contains it"});
  }
  info.faces_imported = shown.size() + unnamed;
  info.faces_declared = info.faces_imported + info.faces_lost.size();
  // If one piece of a face is lost, the face does not count as imported.
  for (const Face& face : model.faces) {
    if (face.entity.empty() || !lost.contains(face.entity)) continue;
    const auto loss = std::find_if(info.faces_lost.begin(), info.faces_lost.end(),
                                   [&](const Loss& l) { return l.entity == face.entity; });
    if (loss != info.faces_lost.end() && !loss->reason.starts_with(kInPart))
      loss->reason = kInPart + loss->reason;
  }
}

Error NothingUsable(const ImportInfo& info, bool declares_faces) {
  std::string message;
  if (!declares_faces) {
    message = info.file + " holds no face: no trimmed surface, shell or solid to render.";
    if (!info.faces_lost.empty()) {
      const Loss& loss = info.faces_lost.front();
      const bool one = info.faces_lost.size() == 1;
      message += " It holds " + std::to_string(info.faces_lost.size()) +
                 (one ? " other body" : " other bodies, the first");
      if (!loss.entity.empty()) message += (one ? ", " : " ") + loss.entity;
      message += ": " + loss.reason + ".";
    }
  } else {
    message =
        "None of the " + std::to_string(info.faces_declared) + " faces of " + info.file + " can be used";
    if (!info.faces_lost.empty()) {
      const Loss& loss = info.faces_lost.front();
      message += "; the first is " + (loss.entity.empty() ? std::string("unnamed") : loss.entity) + ": " +
                 loss.reason;
    }
    message += ".";
  }
  for (const std::string& warning : info.warnings) message += " " + warning;
  return {ErrorCode::kNothingUsable, message};
}

}  // namespace

Result<Conversion> Convert(CadDocument document, const Progress& progress) {
  ModelBuilder builder;
  builder.info() = std::move(document.info);
  std::vector<TopoDS_Face> faces;
  Healing healing = HealDocument(document);
  builder.info().healed = healing.healed;
  for (std::size_t p = 0; p < document.prototypes.size(); ++p) {
    std::size_t done = 0;
    PartConverter part(document, document.prototypes[p], healing.loops, builder, faces);
    part.Run([&] {
      const double share = static_cast<double>(++done) / static_cast<double>(part.face_count());
      progress((static_cast<double>(p) + share) / static_cast<double>(document.prototypes.size()));
    });
  }
  AddInstances(document, builder);
  Balance(document.declared, builder.model(), builder.info());
  const bool shows_none = std::ranges::all_of(builder.model().instances, [&](const Instance& instance) {
    return FacesOf(builder.model(), instance).count == 0;
  });
  if (shows_none) return NothingUsable(builder.info(), !document.declared.empty());
  FindLargestGap(builder.model(), builder.info());
  builder.SetBounds(PlacedBounds(builder.model()));
  Result<Model> model = std::move(builder).Finish();
  if (!model.ok()) return model.error();
  Conversion result{std::move(model).value(), std::move(faces), {}, std::move(healing)};
  for (const Occurrence& occurrence : document.occurrences) result.placements.push_back(occurrence.placement);
  return result;
}

void CompleteForOpenCascade(Conversion& conversion) {
  if (conversion.healing.sound.empty()) return;
  conversion.faces = HealedFaces(conversion.faces, conversion.healing);
  conversion.healing = {};
}

std::vector<TopoDS_Face> PlacedFaces(Conversion& conversion) {
  CompleteForOpenCascade(conversion);
  std::vector<TopoDS_Face> faces;
  faces.reserve(conversion.model.PlacedFaceCount());
  for (std::size_t i = 0; i < conversion.model.instances.size(); ++i) {
    const TopLoc_Location location(conversion.placements[i]);
    // Placements may scale or mirror. Moved() accepts such locations only if its second argument is false.
    for (const std::uint32_t face : Indices(FacesOf(conversion.model, conversion.model.instances[i])))
      faces.push_back(TopoDS::Face(conversion.faces[face].Moved(location, false)));
  }
  return faces;
}

}  // namespace facetless

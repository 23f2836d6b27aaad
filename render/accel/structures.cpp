#include "render/accel/structures.h"

#include <array>

namespace facetless {
namespace {

using Boxes = std::span<const Box3>;

struct Row {
  StructureName name;
  Result<AnyStructure> (*make)(Boxes);
};

template <typename T, auto... settings>
Result<AnyStructure> Make(Boxes boxes) {
  return AnyStructure(HeldStructure<T>(std::make_unique<T>(boxes, settings...)));
}

Result<AnyStructure> MakeVolumeChoice(Boxes boxes) {
  return AnyStructure(HeldStructure<VolumeChoice>(
      std::make_unique<VolumeChoice>(boxes, std::span<const ObjectCost>{}, kVolumeCosts)));
}

Result<AnyStructure> MakeEmbree(Boxes boxes) {
  Result<EmbreeBoxes> tree = EmbreeBoxes::Build(boxes);
  if (!tree) return tree.error();
  return AnyStructure(HeldStructure<EmbreeBoxes>(std::make_unique<EmbreeBoxes>(std::move(tree).value())));
}

constexpr std::string_view kChapter =
    "A. Formella, D. Fellner, Beschleunigungsverfahren bei der Schnittpunktberechnung";
constexpr std::string_view kSkala = "V. Skala, Memory saving technique for space subdivision technique";

constexpr std::array kRows = {
    Row{{"boxes", kChapter}, &Make<BoxList>},
    Row{{"spheres", kChapter}, &Make<SphereList>},
    Row{{"sphere-or-box", kChapter}, &MakeVolumeChoice},
    Row{{"plane-traversal", kChapter}, &Make<PlaneTraversal>},
    Row{{"bvh", kChapter}, &Make<Bvh, BvhBuild::kTopDown>},
    Row{{"bvh-bottom-up", kChapter}, &Make<Bvh, BvhBuild::kBottomUp>},
    Row{{"grid", kChapter}, &Make<Grid>},
    Row{{"grid-repeating", kChapter}, &Make<RepeatingGrid>},
    Row{{"lattice", kChapter}, &Make<Lattice>},
    Row{{"octree", kChapter}, &Make<Octree, OctreeRestart::kCommonAncestor>},
    Row{{"octree-from-root", kChapter}, &Make<Octree, OctreeRestart::kRoot>},
    Row{{"bsp", kChapter}, &Make<BspTree>},
    Row{{"uni-tree", kChapter}, &Make<UniTree>},
    Row{{"direction-tree", kChapter}, &Make<DirectionTree>},
    Row{{"bmssm-slices", kSkala}, &Make<BmssmSlices, SliceForm::kSummary>},
    Row{{"bmssm-slices-plain", kSkala}, &Make<BmssmSlices, SliceForm::kPlain>},
    Row{{"bmssm-slices-two-levels", kSkala}, &Make<BmssmSlices, SliceForm::kTwoLevels>},
    Row{{"ssm-lists", kSkala}, &Make<SsmLists>},
    Row{{"embree", "Embree 3.13, user geometry"}, &MakeEmbree},
};

constexpr std::array kNames = [] {
  std::array<StructureName, kRows.size()> names;
  for (std::size_t i = 0; i < kRows.size(); ++i) names[i] = kRows[i].name;
  return names;
}();

}  // namespace

std::span<const StructureName> StructureNames() {
  return kNames;
}

Result<AnyStructure> MakeStructure(std::string_view name, Boxes boxes) {
  for (const Row& row : kRows)
    if (row.name.name == name) return row.make(boxes);
  std::string known;
  for (const Row& row : kRows) known += (known.empty() ? "" : ", ") + std::string(row.name.name);
  return Error{ErrorCode::kBadUsage,
               "there is no structure named '" + std::string(name) + "'; the names are " + known};
}

}  // namespace facetless

// The structures by name.
//
//     const Result<AnyStructure> structure = MakeStructure("octree", boxes);
//     if (!structure) return structure.error();
//     WithStructure(structure.value(), [&](const auto& s) {  // for many rays: one decision for all of them
//       QueryState state(s.state_size());
//       for (const RaySegment& ray : rays) s.Visit(ray, state, visit);
//     });
//
//  1. Each name of StructureNames() makes one structure, with its default settings. Names are stable: options
//     and reports use them.
//  2. A structure's type is found out once for a batch of rays, so nothing is called through a table per ray.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "render/accel/bmssm_slices.h"
#include "render/accel/box_list.h"
#include "render/accel/bsp_tree.h"
#include "render/accel/bvh.h"
#include "render/accel/direction_tree.h"
#include "render/accel/embree_boxes.h"
#include "render/accel/grid.h"
#include "render/accel/lattice.h"
#include "render/accel/octree.h"
#include "render/accel/plane_traversal.h"
#include "render/accel/sphere_list.h"
#include "render/accel/ssm_lists.h"
#include "render/accel/structure.h"
#include "render/accel/uni_tree.h"
#include "render/accel/volume_choice.h"
#include "render/base/result.h"

namespace facetless {

template <CandidateStructure T>
using HeldStructure = std::unique_ptr<const T>;

using AnyStructure =
    std::variant<HeldStructure<BoxList>, HeldStructure<SphereList>, HeldStructure<VolumeChoice>,
                 HeldStructure<Bvh>, HeldStructure<Grid>, HeldStructure<RepeatingGrid>,
                 HeldStructure<Lattice>, HeldStructure<Octree>, HeldStructure<BspTree>,
                 HeldStructure<PlaneTraversal>, HeldStructure<UniTree>, HeldStructure<DirectionTree>,
                 HeldStructure<BmssmSlices>, HeldStructure<SsmLists>, HeldStructure<EmbreeBoxes>>;

// Of a structure by name.
struct StructureName {
  std::string_view name;
  std::string_view source;  // where it is described
};

// All of them. The first one is the plain list of boxes.
std::span<const StructureName> StructureNames();

// Errors: kBadUsage (no structure has that name; the message lists them); those of EmbreeBoxes::Build.
Result<AnyStructure> MakeStructure(std::string_view name, std::span<const Box3> boxes);

// Calls work(structure) with the structure itself.
template <typename Work>
decltype(auto) WithStructure(const AnyStructure& structure, Work&& work) {
  return std::visit([&](const auto& held) -> decltype(auto) { return work(*held); }, structure);
}

}  // namespace facetless

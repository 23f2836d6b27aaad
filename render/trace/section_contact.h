// How the surfaces of a model meet a section plane: found by subdivision, without a ray. Private to trace/.
//
//  1. A *slab* is what lies between two planes parallel to the section plane. Its points project onto the
//     section plane; two cuts inside the slab differ by at most the area that the surfaces within it cover
//     there. SlabMeeting::area_mm2 bounds that area.
//  2. A surface *touches* the slab if a piece of it lies within the slab and is at least kTangentAspect times
//     as wide as the slab is thick: the plane is tangent to it, or nearly.
//  3. Pieces end where the height above the plane is monotone along a parameter, so that the cut is one arc
//     there, where they lie outside the slab or the face, or where the budget ends. Nothing is dropped for
//     the budget: an unfinished piece counts in full.
//  4. The same bits for any number of threads: one thread does it.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "render/trace/scene.h"
#include "render/trace/section_rows.h"

namespace facetless {

// A piece of a face that meets the slab, projected onto the plane: along the scan's axis and along its rays.
struct SlabPiece {
  double axis_low, axis_high, along_low, along_high;
  std::uint32_t placed_face;
};

struct SlabMeeting {
  double area_mm2 = 0;  // of the faces of closed solids within the slab; an upper bound
  double gap_mm2 =
      0;  // length of the cut in each face times the largest gap along the face's edges; an upper bound
  double outline_mm = 0;                      // length of the cut; an upper bound
  bool complete = true;                       // false: the budget ended first
  std::vector<std::uint32_t> touching_faces;  // placed faces of law 2, ascending
  std::vector<SlabPiece> pieces;              // of closed solids
};

inline constexpr double kTangentAspect = 1024;

// Of the slab of heights [low, high] above the scan's plane; `leave_out` (ascending) are placed faces that do
// not count. `finest` is the height range below which a piece is divided no more; `most_pieces` bounds the
// work.
SlabMeeting MeetSlab(const Scene::Data& scene, const SectionScan& scan, const SectionSolids& solids,
                     double low, double high, double finest, std::size_t most_pieces,
                     std::span<const std::uint32_t> leave_out);

// Components of what the pieces cover, as stretches of the scan's axis, that are thinner than `width`.
struct SlabComponent {
  double axis_low, axis_high, box_mm2;
};
std::vector<SlabComponent> ThinComponents(std::span<const SlabPiece> pieces, double width, double margin);

}  // namespace facetless

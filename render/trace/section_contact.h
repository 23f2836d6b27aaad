// The contact of a model's surfaces with a section plane, determined by subdivision, without rays. Private to
// render/trace.
//
//  1. A *slab* is the space between two planes parallel to the section plane. Points of the slab are
//     projected onto the section plane. Two cuts inside the slab differ by at most the area that the surfaces
//     within the slab cover in this projection; SlabContact::area_mm2 bounds that area.
//  2. A surface *touches* the slab if a piece of it lies within the slab and is at least kTangentAspect times
//     as wide as the slab is thick. The plane is then tangent to the surface, or nearly so.
//  3. A piece is not divided further if the height above the plane is monotone along a parameter (the cut is
//     then a single arc), if the piece lies outside the slab or outside the face, or if the work limit is
//     reached. The limit drops nothing: an unfinished piece counts in full.
//  4. A single thread does the work, so the result has the same bits for any number of threads.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "render/trace/scene.h"
#include "render/trace/section_rows.h"

namespace facetless {

// The extent of a piece of a face that meets the slab, projected onto the plane: along the axis of the scan
// and along its rays, mm.
struct SlabPiece {
  double axis_low, axis_high, along_low, along_high;
  std::uint32_t placed_face;
};

struct SlabContact {
  double area_mm2 = 0;  // upper bound of the area of the faces of closed solids within the slab
  double gap_mm2 =
      0;  // upper bound of the length of the cut in each face times the largest gap along the face's edges
  double outline_mm = 0;                      // upper bound of the length of the cut
  bool complete = true;                       // false: the work limit was reached
  std::vector<std::uint32_t> touching_faces;  // placed faces that touch the slab (law 2), ascending
  std::vector<SlabPiece> pieces;              // pieces of closed solids
};

inline constexpr double kTangentAspect = 1024;

// Examines the slab of heights [low, high] above the plane of the scan, mm. `leave_out` (ascending) lists
// placed faces to ignore. A piece whose height range is below `finest` is not divided further. `most_pieces`
// bounds the work.
SlabContact ExamineSlab(const Scene::Data& scene, const SectionScan& scan, const SectionSolids& solids,
                        double low, double high, double finest, std::size_t most_pieces,
                        std::span<const std::uint32_t> leave_out);

// The connected components of the area that the pieces cover, as intervals of the scan's axis, if they are
// thinner than `width`.
struct SlabComponent {
  double axis_low, axis_high, box_mm2;
};
std::vector<SlabComponent> ThinComponents(std::span<const SlabPiece> pieces, double width, double margin);

}  // namespace facetless

// The area of a cut: the area of the part of a section plane that lies inside closed solids, in mm².
//
//     Result<SectionArea> area = MeasureSection(scene, planes, /*index=*/0, {});
//     if (area) Print(area.value().area_mm2, area.value().error_mm2);
//
//  1. Rays run in the plane, in parallel rows. Their direction is chosen so that few features of real models
//     are parallel to it. The crossings of a row give, by parity, the exact lengths of its chords inside each
//     solid. The other planes clip the rows, so the measured area is the cap that a view shows.
//  2. The lengths are integrated across the rows in blocks of eight, by the open formula that is exact to
//     degree seven. If a block disagrees with its two halves of four rows, or with the adjacent rows of its
//     neighbours, it is divided into eight blocks and measured again, until nothing changes or the limit on
//     rows is reached. Chord lengths end like square roots, and the blocks become small there. Blocks are
//     also divided where the box of a face, or a part of the cut (found by section_contact.h), is thinner
//     than a block.
//  3. error_mm2 is the sum of ErrorParts. `rows` is an estimate, namely the disagreements of the final
//     blocks. The other parts are bounds.
//  4. If a face lies in the plane or touches it, rays in the plane run along the face, and a crossing cannot
//     be told apart from no crossing. The area of a plane displaced by moved_mm is then measured. If a face
//     lies in the plane, the plane is moved to the kept side, in agreement with law 4 of section.h; otherwise
//     it is moved to the side where less changes. The result lists these faces, and error_mm2 includes the
//     change that the displacement may cause.
//  5. The result has the same bits for any number of threads.
//  6. The work is bounded: kMostDivided limits the blocks, a number of pieces limits the subdivision, and
//     rows that cannot be decided do not cause a block to be divided.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/base/execution.h"
#include "render/trace/direct.h"
#include "render/view/section.h"

namespace facetless {

struct SectionArea {
  double area_mm2 = 0;  // area inside any closed solid; overlapping solids are counted once
  double error_mm2 = 0;
  struct ErrorParts {
    double rows = 0;  // disagreements of the blocks, and rounding
    double odd =
        // rows that cross a solid an odd number of times or are undecided, with their whole length inside the
        // model's box, and the errors of the crossings of the other rows
        0;
    double move = 0;    // area covered by the surfaces between the plane and the displaced plane
    double gaps = 0;    // length of the cut in each face times the largest gap at the face's edges
    double missed = 0;  // parts of the cut that are too small for rows
  } error_parts;
  double outline_mm = 0;  // upper bound of the length of the cut's outline; up to ten times too large
  struct OfSolid {
    std::uint32_t solid;  // number of the solid in SectionSolids
    double area_mm2;
  };
  std::vector<OfSolid> solids;                  // the solids that are cut, ascending
  std::vector<std::uint32_t> coincident_faces;  // placed faces that lie in the plane
  std::vector<std::uint32_t> touching_faces;    // placed faces that the plane touches
  double moved_mm = 0;                          // displacement of the plane; positive: to the kept side
  std::uint64_t rows = 0, doubtful_rows = 0, odd_rows = 0;
  std::uint64_t undecided_rows = 0;  // rows on which the fallback solver gave up
  std::vector<std::uint32_t>
      open_faces;  // placed faces that are cut and belong to no closed solid, ascending
  double ms = 0;
};

struct SectionAreaOptions {
  Execution execution;
  std::uint64_t max_bytes = ExactTraceOptions{}.max_bytes;
};

// Measures the cut by plane `index` of `planes`. Errors: kBadUsage (planes), kCancelled, kLimitExceeded
// (leaves).
Result<SectionArea> MeasureSection(const Scene& scene, std::span<const SectionPlane> planes,
                                   std::size_t index, const SectionAreaOptions& options);

}  // namespace facetless

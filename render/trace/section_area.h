// The area of a cut: how much of a section plane lies inside closed solids, in mm².
//
//  1. Rays run in the plane, along rows of a direction that is parallel to few things people draw. All
//     crossings of a row, by parity, give the exact lengths of its chords inside each solid. Other planes
//     clip the rows: what is measured is the cap that a view shows.
//  2. The lengths are integrated across the rows in blocks of eight, by the open formula that is exact to
//     degree seven. A block that disagrees with its two halves of four rows, or with the neighbours' next
//     rows, is divided by eight and measured anew, down to where nothing changes or the budget of rows ends:
//     chords end like square roots, and those ends get small blocks. Small blocks also go to places where the
//     box of a face is thinner than a block, or where a part of the cut is (section_contact.h finds such
//     parts).
//  3. error_mm2 is the sum of ErrorParts. `rows` is an estimate: the disagreements of the blocks that remain.
//     The others are bounds.
//  4. A face that lies in the plane, or touches it, makes the rays of the plane run along it, where no
//     crossing can be told from none. The area is then that of a plane moved by moved_mm: to the kept side
//     where a face lies in the plane, as section.h's law 4 has it, else to the side where less changes. The
//     faces are named, and what the move may change is in error_mm2.
//  5. The same bits for any number of threads.
//  6. The work is bounded: blocks by kMostDivided, subdivision by a number of pieces, and rows that cannot be
//     decided divide no block.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/base/execution.h"
#include "render/trace/direct.h"
#include "render/view/section.h"

namespace facetless {

struct SectionArea {
  double area_mm2 = 0;  // inside any closed solid; where several overlap counted once
  double error_mm2 = 0;
  struct ErrorParts {
    double rows = 0;  // the blocks' disagreements, and rounding
    double odd =
        // rows that cross a solid an odd number of times or are undecided, with their whole way through the
        // model,
        0;
    // and the errors of the other rows' crossings
    double move = 0;    // what the surfaces cover between the plane and where it was moved
    double gaps = 0;    // the cut's length in each face times the largest gap at the face's edges
    double missed = 0;  // parts of the cut that are too small for rows
  } error_parts;
  double outline_mm = 0;  // length of the cut's outline; an upper bound, up to ten times too large
  struct OfSolid {
    std::uint32_t solid;  // as SectionSolids numbers them
    double area_mm2;
  };
  std::vector<OfSolid> solids;                  // those that are cut, ascending
  std::vector<std::uint32_t> coincident_faces;  // placed faces in the plane
  std::vector<std::uint32_t> touching_faces;    // placed faces that the plane touches
  double moved_mm = 0;                          // positive: to the kept side
  std::uint64_t rows = 0, doubtful_rows = 0, odd_rows = 0;
  std::uint64_t undecided_rows = 0;  // on which the fallback solver gave up
  std::vector<std::uint32_t>
      open_faces;  // placed faces that are cut and belong to no closed solid, ascending
  double ms = 0;
};

struct SectionAreaOptions {
  Execution execution;
  std::uint64_t max_bytes = ExactTraceOptions{}.max_bytes;
};

// Of plane `index` of `planes`. Errors: kBadUsage (planes), kCancelled, kLimitExceeded (leaves).
Result<SectionArea> MeasureSection(const Scene& scene, std::span<const SectionPlane> planes,
                                   std::size_t index, const SectionAreaOptions& options);

}  // namespace facetless

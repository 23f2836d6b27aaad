// The area of a cut: how much of a section plane lies inside closed solids, in mm².
//
//  1. Rays run in the plane, along rows of a direction that is parallel to few things people draw. All crossings of a
//     row, by parity, give the exact lengths of its chords inside each solid. Other planes clip the rows: what is
//     measured is the cap that a view shows.
//  2. The lengths are integrated across the rows in blocks of eight, by the open formula that is exact to degree
//     seven. A block that disagrees with its two halves of four rows, or with the neighbours' next rows, is divided by
//     eight and measured anew, down to where nothing changes or the budget of rows ends: chords end like square roots,
//     and those ends get small blocks. So does a face whose box is thinner than a block.
//  3. error_mm2 is an estimate, not a bound: the disagreements of the blocks that remain, and the whole rows that cross
//     a solid an odd number of times.
//  4. A face that lies in the plane makes the rays of the plane run inside it. The area is then that of a plane moved
//     by moved_mm to the kept side, as section.h's law 4 has it, and the faces are named.
//  5. The same bits for any number of threads.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "render/trace/direct.h"
#include "render/trace/section.h"

namespace facetless {

struct SectionArea {
  double area_mm2 = 0;  // inside any closed solid; where several overlap counted once
  double error_mm2 = 0;
  struct OfSolid {
    std::uint32_t solid;  // as SectionSolids numbers them
    double area_mm2;
  };
  std::vector<OfSolid> solids;                  // those that are cut, ascending
  std::vector<std::uint32_t> coincident_faces;  // placed faces in the plane
  double moved_mm = 0;
  std::uint64_t rows = 0, doubtful_rows = 0, odd_rows = 0;
  std::uint32_t open_faces = 0;  // placed faces that are cut and belong to no closed solid
  double ms = 0;
};

struct SectionAreaOptions {
  int threads = 0;  // 0: all cores
  std::uint64_t max_bytes = DirectOptions{}.max_bytes;
  const std::atomic<bool>* cancel = nullptr;
};

// Of plane `index` of `planes`. Errors: kBadUsage (planes), kCancelled, kLimitExceeded (leaves).
Result<SectionArea> MeasureSection(const Scene& scene, std::span<const SectionPlane> planes,
                                   std::size_t index, const SectionAreaOptions& options);

}  // namespace facetless

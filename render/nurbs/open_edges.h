// Open edges of a model: edges at which its faces do not meet, however exactly they are traced, because the
// file itself leaves them open.
//
//  1. An edge of a solid is open if it is used by one face only, by more than two, or twice in the same sense
//     (one face has the wrong orientation). An edge of any shape is open if its distance from one of its
//     faces exceeds the edge's tolerance.
//  2. Collapsed edges are not open, nor are edges that are used once by a face that belongs to no solid.
//  3. The list is sorted, worst edge first: holes precede gaps; holes are sorted by length, gaps by width.
#pragma once

#include <cstdint>
#include <vector>

#include "render/model/model.h"

namespace facetless {

enum class OpenCause : std::uint8_t {
  kUsedOnce,
  kUsedOften,  // three times or more
  kSameSense,  // twice, both in one sense
  kGap,        // wider than the edge's tolerance
};
const char* OpenCauseName(OpenCause cause);  // "used_once", "used_often", "same_sense", "gap"

struct OpenEdge {
  OpenCause cause = OpenCause::kGap;
  std::uint32_t edge = 0;
  std::vector<std::uint32_t> faces;  // indices into Model::faces, ascending
  double gap_mm = 0;                 // largest measured gap of all uses of the edge
  double tolerance_mm = 0;           // tolerance of the edge, from the file or the importer
  double length_mm = 0;              // length of the control polygon
  Vec3 at;  // the widest point of a gap, or the middle of the edge; part coordinates, mm
};

std::vector<OpenEdge> FindOpenEdges(const Model& model);

}  // namespace facetless

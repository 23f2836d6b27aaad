// What a file itself leaves open: the edges at which its faces don't meet, however exactly they are traced.
//
//  1. Of solids: an edge that is used by one face only, or by more than two, or twice in the same sense (a
//     face is the wrong way round). Of all shapes: an edge that lies farther off one of its faces than its
//     own tolerance.
//  2. Collapsed edges, and those of faces that are no solid's and used once, are as they should be.
//  3. Worst first: holes before gaps; holes by length, gaps by width.
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
  double gap_mm = 0;                 // the largest measured, of its uses
  double tolerance_mm = 0;           // its own, as the file or the importer has it
  double length_mm = 0;              // of the polygon through its control points
  Vec3 at;                           // where it is widest, or its middle; part coordinates
};

std::vector<OpenEdge> FindOpenEdges(const Model& model);

}  // namespace facetless

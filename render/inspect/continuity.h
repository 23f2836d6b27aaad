// Continuity between neighbouring faces: position, normal and curvature along every edge that two faces
// share.
//
//     const Continuity continuity = MeasureContinuity(model, /*threads=*/0);
//     if (!continuity.edges.empty()) Print(continuity.edges.front().gap_mm.value);  // the worst edge
//
//  1. The edge is examined at kPlaces + 1 points along its 3D curve, ends included. For each face, the foot
//     of the point on its surface is found from the p-curve and refined by Newton's method. gap_mm is the
//     distance between the two feet, and angle_deg the angle between the outward normals there.
//  2. The curvature is the normal curvature across the edge, in the section perpendicular to it. If the
//     normals agree along an edge, the surfaces are curvature continuous if and only if this number agrees
//     (Pegna and Wolter 1992). The relative jump is relative to the larger of the two curvatures.
//  3. Faces of an open shell may have opposite orientations. Their coedges show this, and one normal is then
//     reversed.
//  4. An edge has the grade of its worst point. kGap: the feet are farther apart than twice the edge's
//     tolerance in the file (each face may use the whole tolerance), or than kPositionShare of the diagonal
//     if that is larger. kG0: an angle exceeds kAngleDeg. kG1: a jump exceeds both kCurvatureShare of the
//     curvature and kFlatShare/diagonal. kG2: none of these.
//  5. Degenerate points (a pole on the edge) are left out. An edge without other points has no grade and is
//     counted. Edges at which a face meets itself (seams) are included; breaks inside a face are not.
//  6. All values are in part coordinates: a prototype is measured once, however often it is placed.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/base/execution.h"
#include "render/base/result.h"
#include "render/model/model.h"

namespace facetless {

inline constexpr int kPlaces = 16;
inline constexpr double kPositionShare = 1e-6, kAngleDeg = 0.1, kCurvatureShare = 0.02, kFlatShare = 1e-3;

enum class Grade : std::uint8_t { kGap, kG0, kG1, kG2 };
inline constexpr std::array<const char*, 4> kGradeNames = {"gap", "G0", "G1", "G2"};

// The worst value of one measure along an edge, and its place in part coordinates.
struct WorstPlace {
  double value = 0;
  Vec3 at;
};

struct EdgeContinuity {
  std::uint32_t edge = 0;
  std::uint32_t faces[2] = {0, 0};  // into Model::faces; equal for a seam
  Grade grade = Grade::kG2;
  double length_mm = 0, tolerance_mm = 0;  // tolerance: the gap that law 4 allows
  WorstPlace gap_mm, angle_deg,
      curvature_jump;             // curvature_jump is in 1/mm, and only of points whose normals agree
  double relative_jump = 0;       // at the same point as curvature_jump; 0 … 2
  double curvatures[2] = {0, 0};  // curvatures of both faces at that point, 1/mm
};

struct Continuity {
  std::vector<EdgeContinuity>
      edges;  // worst first: by grade, then by the measure of the grade, then by index
  std::array<std::size_t, 4> counts{};
  std::size_t border_edges = 0;      // edges used by one face only
  std::size_t crowded_edges = 0;     // edges used by more than two faces
  std::size_t unmeasured_edges = 0;  // edges without a grade (law 5)
};

// Error: kCancelled.
Result<Continuity> MeasureContinuity(const Model& model, const Execution& execution);

}  // namespace facetless

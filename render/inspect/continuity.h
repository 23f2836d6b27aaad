// How smoothly neighbouring faces meet: position, normal and curvature along every edge that two faces share.
//
//  1. At kPlaces + 1 places along the 3D edge, ends included, each face answers with the foot of the place on
//     its surface: from the p-curve, refined by Newton on the surface. gap_mm is the distance of both feet,
//     angle_deg that of the outward normals.
//  2. Curvature is the normal curvature across the edge, of the section perpendicular to it. Where normals
//     agree along an edge, surfaces are curvature continuous exactly where this one number agrees (Pegna and
//     Wolter 1992). The jump is relative to the larger of both.
//  3. Faces of an open shell may be oriented against each other: their coedges tell, and one normal is
//     turned.
//  4. An edge has the grade of its worst place. kGap: feet are farther apart than twice the edge's tolerance
//     in the file (which each face may use up), or kPositionShare of the diagonal where that is larger. kG0:
//     an angle above kAngleDeg. kG1: a jump of more than kCurvatureShare of the curvature and of
//     kFlatShare/diagonal. kG2: none of these.
//  5. Degenerate places (a pole on the edge) are left out; an edge without another place has no grade and is
//     counted. Edges of one face with itself (seams) take part; breaks inside a face do not.
//  6. Everything is in part coordinates: a prototype is measured once, however often it is placed.
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

// The worst of one measure along an edge, and where.
struct WorstPlace {
  double value = 0;
  Vec3 at;
};

struct EdgeContinuity {
  std::uint32_t edge = 0;
  std::uint32_t faces[2] = {0, 0};  // into Model::faces; equal for a seam
  Grade grade = Grade::kG2;
  double length_mm = 0, tolerance_mm = 0;        // tolerance: what law 4 allows for the gap
  WorstPlace gap_mm, angle_deg, curvature_jump;  // 1/mm; the jump only of places whose normals agree
  double relative_jump = 0;                      // at the same place as curvature_jump; 0 … 2
  double curvatures[2] = {0, 0};                 // there, of both faces
};

struct Continuity {
  std::vector<EdgeContinuity> edges;  // worst first: by grade, then by its own measure, then by number
  std::array<std::size_t, 4> counts{};
  std::size_t border_edges = 0;      // used by one face only
  std::size_t crowded_edges = 0;     // used by more than two
  std::size_t unmeasured_edges = 0;  // law 5
};

// Error: kCancelled.
Result<Continuity> MeasureContinuity(const Model& model, const Execution& execution);

}  // namespace facetless

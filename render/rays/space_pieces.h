// SpacePieces: the faces of a model, divided into pieces that are nearly parallelograms, in the coordinates of their
// part. Rays in any direction look for roots in them.
//
//     const Result<SpacePieces> made = SpacePieces::Make(scene, wanted, max_bytes, execution);
//     for (const SpacePiece& piece : made.value().OfFace(face)) boxes.push_back(piece.box);
//
//  1. A piece is part of one patch: a Bézier net of its own, and the place of it in the patch. The pieces of a face
//     cover all of the face, and the continuation of its patches across the gap to its edges (FaceData::continued).
//     Pieces outside the trimmed face are left out, and pieces inside are marked, both proven by FaceTrim::Classify.
//  2. A net has the components (x − w·origin.x, y − w·origin.y, w, z − w·origin.z), where `origin` is the middle of
//     the face's box: a face far from the part's origin loses no precision. SpacePiece::error bounds the distance of
//     each component from the exact surface.
//  3. A piece is divided until its control points lie within kFlatness of a parallelogram, as a share of its diagonal,
//     or until it has been halved kMostHalvings times in one direction. Pieces of any shape give correct answers: the
//     shape decides only how fast.
//  4. The box holds all control points, their errors included, and so the piece. Weights are positive (model.h, law 5).
//  5. The pieces depend on the model alone, not on the number of threads or the instruction set.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/base/execution.h"
#include "render/base/result.h"
#include "render/nurbs/bezier.h"
#include "render/nurbs/leaf_place.h"
#include "render/nurbs/leaf_splitter.h"
#include "render/trace/direct.h"

namespace facetless {

struct SpacePiece {
  Box3 box;                     // in the part's coordinates
  const double* net = nullptr;  // as BezierNet::value; law 2
  double error[kNetComponents] = {};
  LeafPlace place;
  std::uint32_t face = 0;  // of the model
  bool whole = false;      // proven to lie inside the trimmed face
};

class SpacePieces {
 public:
  // Divides the faces of the model for which wanted[face] is set. Errors: kLimitExceeded (the pieces need more than
  // `max_bytes`), kCancelled. `scene` must outlive the pieces.
  static Result<SpacePieces> Make(const Scene& scene, const std::vector<bool>& wanted,
                                  std::uint64_t max_bytes, const Execution& execution);

  std::span<const SpacePiece> all() const { return pieces_; }
  Range OfFace(std::uint32_t face) const { return ranges_[face]; }
  Vec3 origin(std::uint32_t face) const { return origins_[face]; }
  std::size_t bytes() const;

 private:
  class Divider;

  std::vector<SpacePiece> pieces_;
  std::vector<Range> ranges_;  // of each face
  std::vector<Vec3> origins_;
  std::vector<CoefficientArena> arenas_;
};

}  // namespace facetless

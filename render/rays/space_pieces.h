// SpacePieces: the faces of a model, divided into pieces that are nearly parallelograms, in the coordinates of their
// part. Rays in any direction look for roots in them.
//
//     const Result<SpacePieces> made = SpacePieces::Make(scene, wanted, kOpenShare, max_bytes, execution);
//     if (!made) return made.error();
//     const Range range = made.value().OfFace(face);
//     for (const SpacePiece& piece : made.value().all().subspan(range.first, range.count)) boxes.push_back(piece.box);
//
//  1. A piece is a part of one patch. It has a Bézier net of its own, and its place in the patch. The pieces of a face
//     cover all of the face, and the continuation of its patches across the gap to its edges (FaceData::continued).
//     Pieces that are proven to lie outside the trimmed face are left out, and those that are proven to lie inside are
//     marked (FaceTrim::FindLine; whole patches by FaceTrim::Classify).
//  2. A net has the components (x − w·origin.x, y − w·origin.y, w, z − w·origin.z), where `origin` is the middle of
//     the face's box, so that a face far from the part's origin loses no precision. SpacePiece::error bounds the
//     distance of each component from the exact surface.
//  3. A piece is divided until it is nearly a parallelogram, and until a line divides it into a part inside the face
//     and a part that is trimmed away (TrimLine, with bands that are kSteepBand times as wide, for slanted rays). The
//     smaller a piece is compared with the model, the less it needs to be like a parallelogram, because few rays meet
//     it. The shape of the pieces affects only the speed, not the answers.
//  4. The box holds all control points, their errors included, and so the piece. Weights are positive (model.h, law 5).
//  5. A piece has cones that hold, up to sign, the direction of Sa × Sb for any two tangents Sa along u and Sb along v
//     of the surface at points of a *neighbourhood*: the patch over the piece and a share of its sides (kCloseShare,
//     kWideShare) more on each side. A line along d meets the neighbourhood at most once if |d·axis| > sine·|d|: two
//     points of it differ by a mean tangent along u and one along v, and d is no combination of the two. Pieces of plane
//     faces have no cones, because a line that is not parallel to a plane meets it only once.
//  6. The pieces depend on the model alone, not on the number of threads or the instruction set.
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

// If a ray passes the border of a piece within about its bend, or passes its trim line within the width of that, the
// answer requires solving for a root. The area of such rays is the bend or the width, as a share of the diagonal of the
// piece, times the square of this diagonal. A piece is kept if this area is at most this share of the square of the
// model's diagonal.
inline constexpr double kOpenShare = 1.0 / (256 * 256);
inline constexpr double kSteepBand =
    9;  // a little more than 1/kSteep (block_tree.h), as pieces are not quite plane
inline constexpr double kCloseShare = 1.0 / 32, kWideShare = 0.5;

struct SpacePiece {
  Box3 box;                     // in the part's coordinates
  const double* net = nullptr;  // as BezierNet::value; law 2
  double error[kNetComponents] = {};
  LeafPlace place;
  std::uint32_t face = 0;  // of the model
  bool whole = false;      // proven to lie inside the trimmed face
  TrimLine line;           // in its native parameters, if it is not whole
  // Native parameters.
  double u_low = 0, u_high = 1, v_low = 0, v_high = 1;
  Vec2 patch_low, patch_high;  // native parameters of its patch

  struct Cone {
    Vec3 axis;        // unit vector, in the part's coordinates
    double sine = 2;  // at least 1: there is no cone
  };
  Cone close, wide;  // law 5

  bool Holds(double u, double v) const { return u >= u_low && u <= u_high && v >= v_low && v <= v_high; }
  // Whether native parameters lie in the piece, enlarged on each side by `share` of its width and height (law 5).
  bool HasNear(double u, double v, double share) const {
    const double width = share * (u_high - u_low), height = share * (v_high - v_low);
    return u >= u_low - width && u <= u_high + width && v >= v_low - height && v <= v_high + height;
  }
};

class SpacePieces {
 public:
  // Divides the faces of the model for which wanted[face] is set. Errors: kLimitExceeded (the pieces need more than
  // `max_bytes`), kCancelled. `scene` must outlive the pieces.
  static Result<SpacePieces> Make(const Scene& scene, const std::vector<bool>& wanted, double open_share,
                                  std::uint64_t max_bytes, const Execution& execution);

  std::span<const SpacePiece> all() const { return pieces_; }
  Range OfFace(std::uint32_t face) const { return ranges_[face]; }  // a range of all()
  Vec3 origin(std::uint32_t face) const { return origins_[face]; }  // law 2
  std::size_t bytes() const;

 private:
  class Divider;

  std::vector<SpacePiece> pieces_;
  std::vector<Range> ranges_;  // of each face
  std::vector<Vec3> origins_;
  std::vector<CoefficientArena> arenas_;
};

}  // namespace facetless

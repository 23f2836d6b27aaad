// ExactRays: rays in any direction against the exact faces of a whole model (view/secondary_rays.h).
//
//     Result<std::unique_ptr<ExactRays>> rays = ExactRays::Build(scene, {.structure = "bvh"}, execution);
//     if (!rays) return rays.error();
//     rays.value()->FindBlocked(starts, batch, passages);
//
//  1. The faces are divided into pieces in space (space_pieces.h), once for each part, and each placed piece has a box.
//     A structure of render/accel, chosen by name, finds the boxes that a ray meets. A box holds its piece with all
//     errors, so a piece that is not visited is proven to be empty.
//  2. ray_roots.h finds the roots in a piece and says which are proven. The start's own root is recognised by its face
//     and parameters, and no start is lifted off the surface.
//  3. A blocked ray is certified if a proven root lies strictly between the start and the length. A clear ray is
//     certified if every candidate is proven empty or trimmed away. The nearest hit is certified if it is proven, and
//     if everything in front of it and within its error is proven absent (kDoubtCoincident: another face is there).
//     Any other answer is the best one that is known, with the doubts that prevent a proof. A ray that is not usable
//     (its direction is not a unit vector, its length is not above 0, or its start is not finite) meets nothing, with
//     kDoubtUnresolved.
//  4. The structure "blocks" answers FindBlocked first in single precision, with bounds that prove most answers
//     (block_tree.h, kernels/ray_blocks.h), and solves only the pieces that are left open. A piece of the start's own
//     face is skipped if it is proven that the ray meets it only in its start: if the face is plane, or if the start
//     lies in a neighbourhood of the piece whose cone excludes the direction (space_pieces.h, law 5). Both proofs
//     require that the start lies on its face as RayStart states. FindNearest solves the pieces that are not proven to
//     be missed, from near to far. Rays that start far outside of the model, and rays that leave very many pieces open,
//     are answered by "bvh", which is built for the first such ray.
//  5. Queries allocate nothing per ray. They may be called from any number of threads; the answers are the same for any
//     grouping, any structure, and any instruction set.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "render/accel/structures.h"
#include "render/base/execution.h"
#include "render/base/parallel.h"
#include "render/rays/block_tree.h"
#include "render/rays/ray_roots.h"
#include "render/view/secondary_rays.h"

namespace facetless {

// The structure that is fastest for rays between surfaces (law 4).
inline constexpr const char* kBlocks = kUsualStructure;

struct ExactRaysOptions {
  std::string structure = kBlocks;  // a name of StructureNames(), or kBlocks
  // Indexed by placed face: rays ignore the faces that are set. Null: no face is ignored.
  const std::vector<bool>* leave_out = nullptr;
  // How fine the pieces are. A larger share makes fewer pieces in less time, and rays slower; answers are proven alike.
  double open_share = kOpenShare;
  std::uint64_t max_bytes = std::uint64_t{4} << 30;  // of the pieces, their boxes and the structure
};

class ExactRays final : public SecondaryRays {
 public:
  // Errors: kBadUsage (no structure has that name), kLimitExceeded, kCancelled. `scene` must outlive the result.
  static Result<std::unique_ptr<ExactRays>> Build(const Scene& scene, const ExactRaysOptions& options,
                                                  const Execution& execution);

  void FindBlocked(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                   std::span<RayPassage> passages) const override;
  void FindNearest(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                   std::span<SecondaryHit> hits) const override;

  std::string structure() const override { return structure_name_; }
  double build_ms() const override { return build_ms_; }
  std::uint64_t bytes() const override;
  std::size_t pieces() const { return placed_.size(); }

  // Counts, for measurements, how FindBlocked answers rays with kBlocks: rays for which the blocks alone decided
  // (`blocked`, `clear`), rays for which pieces were solved, and the pieces that were open, skipped (law 4) or solved.
  struct Paths {
    std::uint64_t rays = 0, blocked = 0, clear = 0, solved = 0, pieces_open = 0, pieces_own = 0,
                  pieces_solved = 0;
  };
  Paths CountPaths(std::span<const RayStart> starts, std::span<const SecondaryRay> rays) const;

 private:
  // A piece of an instance; its box has the same index.
  struct PlacedPiece {
    std::uint32_t instance, piece, placed_face;
  };
  // A piece that the ray is not proven to miss.
  struct OpenPiece {
    float near;        // no root in the piece is nearer, mm
    std::uint32_t id;  // index into placed_
  };
  // The memory of one thread for its rays, which is kept between batches.
  struct Worker {
    explicit Worker(const RayScene& scene) : roots(scene) {}
    RayRoots roots;
    std::optional<QueryState> state;  // made for the first ray that needs it
    BlockVisit visit;
    std::uint32_t prepared = kNoIndex;  // index of the start for which `roots` is prepared
    std::vector<OpenPiece> open;
    Paths paths;
  };

  ExactRays() = default;
  Result<void> PlacePieces(const std::vector<bool>& shown, std::uint64_t max_bytes);
  std::vector<Box3> MakeBoxes() const;
  void SetStructure(AnyStructure structure) const;
  const AnyStructure& structure_of_boxes() const;
  void BuildBlocks(const std::vector<Box3>& boxes);
  void DescribePiece(std::uint32_t id, Vec3 from, PieceShape* shape) const;
  void FindFlatFaces();
  void BlockedByTree(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                     std::span<RayPassage> passages, Worker& worker) const;
  void BlockedByStructure(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                          std::span<RayPassage> passages) const;
  // Answers a ray with the blocks. Returns false, without an answer, if they leave too many pieces open.
  bool PassageThroughBlocks(std::span<const RayStart> starts, const SecondaryRay& ray, Worker& worker,
                            RayPassage* passage) const;
  // Answers the nearest hit in the same way.
  bool NearestThroughBlocks(std::span<const RayStart> starts, const SecondaryRay& ray, Worker& worker,
                            SecondaryHit* hit) const;
  void NearestByStructure(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                          std::span<SecondaryHit> hits) const;
  // Lists the open pieces of worker.visit in worker.open, without those that IsOwnOnly excludes. Returns whether one of
  // the excluded pieces has the start's own root.
  bool ListOpen(const RayStart& start, const SecondaryRay& ray, Worker& worker) const;
  // Whether it is proven that a ray from the start meets the piece at most in the start itself.
  bool IsOwnOnly(const RayStart& start, Vec3 direction, const SpacePiece& piece,
                 std::uint32_t instance) const;
  // Calls finish(ray, roots) after the visit of each ray.
  template <typename Structure, typename Finish>
  void Trace(const Structure& structure, std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
             bool any, const Finish& finish) const;

  RayScene scene_;
  std::vector<PlacedPiece> placed_;
  mutable AnyStructure structure_;
  mutable std::once_flag structure_once_;  // for kBlocks
  mutable std::atomic<std::uint64_t> structure_bytes_{0};
  std::optional<BlockTree> blocks_;
  RayBlocks view_;  // of blocks_
  VisitBlocks visit_blocks_ = nullptr;
  std::vector<Vec3> plane_normals_;  // by face: the unit normal in its part if the face is plane, else zero
  std::string structure_name_;
  double build_ms_ = 0;
  mutable std::unique_ptr<PerThread<Worker>> workers_;
};

}  // namespace facetless

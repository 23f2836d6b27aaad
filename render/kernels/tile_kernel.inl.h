// The body of the tile kernel (tile_kernel.h). Each tile_kernel_<isa>.cpp includes this file once, after it
// has set its target.

#include <algorithm>
#include <cstdint>

#include "render/kernels/packet.inl.h"

namespace facetless::FACETLESS_KERNEL_NAMESPACE {

void TraceTile(const TileJob& job) {
  constexpr std::size_t kCount = std::size_t(kTileSize) * kTileSize;
  std::fill_n(job.depth, kCount, kInfinity);
  std::fill_n(job.leaf, kCount, kNoLeaf);
  std::fill_n(job.doubt, kCount, std::uint8_t{0});
  if (job.words == 0) return;
  Packet packet(job);
  for (int row = 0; row < job.rows; row += kPacketHeight)
    for (int column = 0; column < job.columns; column += kPacketWidth) packet.Run(row, column);
}

#if defined(FACETLESS_SCALAR_KERNEL)
SampleRoot SolveSample(const CertifiedLeaf& leaf, const KernelArithmetic& arithmetic, double x, double y,
                       TileHit* hit) {
  const Solution solution = SolveLeaf(leaf, leaf.RootError(arithmetic), &x, &y, 1);
  if (solution.unconverged) return SampleRoot::kUnconverged;
  if (!solution.hit) return SampleRoot::kMiss;
  double depth;
  Depths(leaf, solution.depth, &depth);
  *hit = {depth, solution.s.raw, solution.t.raw, leaf.depth_error};
  return SampleRoot::kHit;
}
#endif

}  // namespace facetless::FACETLESS_KERNEL_NAMESPACE

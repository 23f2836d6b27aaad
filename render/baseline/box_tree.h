// Embree's tree over boxes on the screen that are not triangles: what the bench compares the bitmaps of
// accel/ with.
//
//  1. A box is a half-open range of pixel columns and rows and the depth from which on something may lie in
//     it. A ray goes through a pixel and meets the boxes that hold it, roughly front to back; the caller says
//     at which depth there was a hit, and boxes that begin behind it are left out.
//  2. Depths are rounded to float32 towards the eye for boxes and away from it for limits: a box is never
//     left out for rounding.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "render/base/result.h"

namespace facetless {

struct ScreenBox {
  std::int32_t col_begin, col_end, row_begin, row_end;
  double near_depth;
};

class BoxTree {
 public:
  // Looks at box `box`; returns the depth of the nearest hit so far, infinite if there is none.
  using Meet = double (*)(void* context, std::uint32_t box);

  // Columns and rows below 2^16, depths finite. Errors: kNothingUsable (no box), kLimitExceeded, kBadUsage,
  // as BaselineScene::Build.
  static Result<BoxTree> Build(std::span<const ScreenBox> boxes);
  ~BoxTree();
  BoxTree(BoxTree&&) noexcept;
  BoxTree& operator=(BoxTree&&) noexcept;

  // The ray through the middle of a pixel.
  void Visit(int column, int row, Meet meet, void* context) const;
  std::uint64_t bytes() const;  // what Embree holds

  struct Data;

 private:
  explicit BoxTree(std::unique_ptr<Data> data);
  std::unique_ptr<Data> data_;
};

}  // namespace facetless

// An Embree tree over screen boxes. The bench compares the bitmaps of render/accel with it.
//
//  1. A box is a half-open range of pixel columns and rows, with the depth at which its content may begin. A
//     ray passes through a pixel and visits the boxes that contain the pixel, roughly from front to back. The
//     caller reports the depth of its nearest hit, and boxes that begin behind the hit are skipped.
//  2. Depths are rounded to float32: towards the eye for boxes, and away from it for limits. Rounding
//     therefore never causes a box to be skipped.
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
  // Processes box `box`. Returns the depth of the nearest hit so far; infinite if there is none.
  using VisitBox = double (*)(void* context, std::uint32_t box);

  // Builds the tree. Requires columns and rows below 2^16, and finite depths. Errors: kNothingUsable (there
  // is no box); kLimitExceeded and kBadUsage as for BaselineScene::Build.
  static Result<BoxTree> Build(std::span<const ScreenBox> boxes);
  ~BoxTree();
  BoxTree(BoxTree&&) noexcept;
  BoxTree& operator=(BoxTree&&) noexcept;

  // Visits the boxes on the ray through the centre of a pixel.
  void Visit(int column, int row, VisitBox meet, void* context) const;
  std::uint64_t bytes() const;  // memory that Embree has allocated

  struct Data;

 private:
  explicit BoxTree(std::unique_ptr<Data> data);
  std::unique_ptr<Data> data_;
};

}  // namespace facetless

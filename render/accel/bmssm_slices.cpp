#include "render/accel/bmssm_slices.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "render/accel/curve_order.h"

namespace facetless {
std::array<std::uint32_t, 3> SliceCounts(std::size_t objects, std::uint32_t slices) {
  // Twice as many supervoxels on each axis as groups of 64 objects, if they were spread evenly.
  constexpr double kSlicesPerGroup = 2, kFewest = 4, kMost = 64;
  if (slices == 0)
    slices = static_cast<std::uint32_t>(std::clamp(
        std::round(kSlicesPerGroup * std::cbrt(static_cast<double>(objects) / BmssmSlices::kGroup)), kFewest,
        kMost));
  return {slices, slices, slices};
}

SliceMaps::SliceMaps(std::span<const SlabBox> boxes, VoxelPlanes planes)
    : planes_(std::move(planes)), words_((boxes.size() + 63) / 64), summaries_((words_ + 63) / 64) {
  first_[1] = planes_.count(0);
  first_[2] = first_[1] + planes_.count(1);
  const std::size_t slices = first_[2] + planes_.count(2);
  bits_.assign(slices * words_, 0);
  summary_.assign(slices * summaries_, 0);
  for (std::size_t number = 0; number < boxes.size(); ++number)
    for (int axis = 0; axis < 3; ++axis) {
      const VoxelPlanes::Range range = planes_.Reach(boxes[number], axis);
      const std::size_t word = number / 64;
      for (std::uint32_t slice = range.first; slice <= range.last; ++slice) {
        bits_[(first_[axis] + slice) * words_ + word] |= std::uint64_t{1} << (number % 64);
        summary_[(first_[axis] + slice) * summaries_ + word / 64] |= std::uint64_t{1} << (word % 64);
      }
    }
}

BmssmSlices::BmssmSlices(std::span<const Box3> boxes, SliceForm form, std::uint32_t slices)
    : boxes_(boxes), form_(form) {
  order_.resize(boxes_.size());
  std::iota(order_.begin(), order_.end(), 0u);
  if (form != SliceForm::kPlain) order_ = CurveOrder(boxes_.boxes());
  std::vector<SlabBox> sliced;
  if (form == SliceForm::kTwoLevels) {
    MakeGroups();
    for (const Group& group : groups_) sliced.push_back(group.box);
  } else {
    for (const std::uint32_t id : order_) sliced.push_back(boxes_[id]);
  }
  VoxelPlanes planes = EvenPlanes(boxes_.bounds(), SliceCounts(boxes_.size(), slices));
  references_ = CountReferences(boxes_, planes);
  maps_ = SliceMaps(sliced, std::move(planes));
}

void BmssmSlices::MakeGroups() {
  for (std::size_t first = 0; first < order_.size(); first += kGroup) {
    const std::size_t last = std::min<std::size_t>(first + kGroup, order_.size());
    std::vector<SlabBox> members;
    for (std::size_t i = first; i < last; ++i) members.push_back(boxes_[order_[i]]);
    Group& group = groups_.emplace_back();
    group.box = members.front();
    for (const SlabBox& box : members) group.box = UnionOf(group.box, box);
    const SliceMaps maps(members, EvenPlanes(group.box, {kGroupSlices, kGroupSlices, kGroupSlices}));
    for (int axis = 0; axis < 3; ++axis)
      for (std::uint32_t slice = 0; slice < kGroupSlices; ++slice)
        group.slices[axis][slice] = *maps.Slice(axis, slice);
    group.planes = maps.planes();
  }
}

std::size_t BmssmSlices::bytes() const {
  std::size_t bytes = boxes_.bytes() + order_.capacity() * sizeof(std::uint32_t) + maps_.bytes() +
                      groups_.capacity() * sizeof(Group);
  for (const Group& group : groups_) bytes += group.planes.bytes();
  return bytes;
}

}  // namespace facetless

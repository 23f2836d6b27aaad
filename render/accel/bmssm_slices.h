// BMSSM for rays in any direction (V. Skala, "Memory saving technique for space subdivision technique",
// section 5). Slices across the three axes have bitmaps R_i, S_j and T_k with a bit for each object, which is
// set if the object reaches into the slice. The objects of the supervoxel (i, j, k) are the set bits of
// R_i & S_j & T_k, and a ray goes from supervoxel to supervoxel by a 3D-DDA.
//
//     const BmssmSlices slices(boxes);
//     QueryState state(slices.state_size());
//     slices.Visit({origin, direction}, state, visit);
//
//  1. The set bits of R_i & S_j & T_k are exactly the objects whose boxes reach into the supervoxel
//     (SliceMaps). The bitmaps of N slices on each axis take 3·N·p bits for p objects, whatever the objects'
//     sizes.
//  2. Candidates that the ray has asked are masked out by a bitmap of the ray, so each is asked once. Only
//     the words that a ray has changed are cleared after it.
//  3. The source's form evaluates p/64 words in each supervoxel, which is hopeless for tens of thousands of
//     objects. SliceForm names what is done about it, and all forms visit the same objects:
//       kPlain      all words, objects numbered as given (the source's form);
//       kSummary    objects are numbered along a space-filling curve, so that the set bits of a slice lie
//                   in few words, and a summary bitmap, with one bit for each word that is not zero, is
//                   evaluated first: only the words that all three summaries name are read;
//       kTwoLevels  the 64 objects of a word of that numbering form a group. The slices of the scene have
//                   a bit for each group, and each group has slices of its own box, whose bitmaps are one
//                   word each. A ray walks through the supervoxels of the scene, and within those of each
//                   group that it meets.
//     `facetless bench --structures` measures them. Over the 6,424 boxes of nist_ctc_02, a random ray visits
//     3.1 supervoxels and tests 28 boxes with kSummary, and visits 24 and tests 5.3 with kTwoLevels, which
//     took 2.5 times as long. kTwoLevels won only where objects lie in clusters.
//  4. Within a supervoxel, objects come in the order of their numbers. The visit ends before the first
//     supervoxel that begins behind the nearest hit (law 4 of structure.h).
//  5. Rays from so far away that rounding exceeds the boxes' margin (BoxSet::TooFar) are answered by a scan.
#pragma once

#include <bit>
#include <span>
#include <vector>

#include "render/accel/structure.h"
#include "render/accel/voxels.h"

namespace facetless {

enum class SliceForm : std::uint8_t { kPlain, kSummary, kTwoLevels };

// The numbers of slices on the three axes: `slices`, or a number that suits `objects` if that is 0.
std::array<std::uint32_t, 3> SliceCounts(std::size_t objects, std::uint32_t slices);

// The bitmaps of all slices, with a summary of each.
class SliceMaps {
 public:
  SliceMaps() = default;
  SliceMaps(std::span<const SlabBox> boxes, VoxelPlanes planes);

  const VoxelPlanes& planes() const { return planes_; }
  std::size_t words() const { return words_; }
  std::size_t summary_words() const { return summaries_; }
  // The bitmap of slice `slice` across an axis: R, S and T.
  const std::uint64_t* Slice(int axis, std::uint32_t slice) const {
    return bits_.data() + (first_[axis] + slice) * words_;
  }
  // A bit for each word of the slice, which is set if the word is not zero.
  const std::uint64_t* Summary(int axis, std::uint32_t slice) const {
    return summary_.data() + (first_[axis] + slice) * summaries_;
  }
  std::size_t bytes() const {
    return planes_.bytes() + (bits_.capacity() + summary_.capacity()) * sizeof(std::uint64_t);
  }

 private:
  VoxelPlanes planes_;
  std::size_t words_ = 0, summaries_ = 0;
  std::size_t first_[3] = {0, 0, 0};
  std::vector<std::uint64_t> bits_, summary_;
};

class BmssmSlices {
 public:
  static constexpr bool kOnce = true;
  static constexpr std::uint32_t kGroup = 64;       // objects of a group
  static constexpr std::uint32_t kGroupSlices = 8;  // of a group, on each axis

  // `slices` on each axis of the scene; 0: by the number of objects.
  explicit BmssmSlices(std::span<const Box3> boxes, SliceForm form = SliceForm::kSummary,
                       std::uint32_t slices = 0);

  template <typename Visitor>
  void Visit(const RaySegment& segment, QueryState& state, Visitor&& visit) const {
    SlabRay ray;
    if (!boxes_.Enter(segment, ray)) return;
    state.NextRay();
    if (boxes_.TooFar(ray)) return boxes_.Scan(ray, state, visit);
    Walk(ray, state, visit);
    for (const std::uint32_t word : state.touched()) state.words()[word] = 0;
    state.touched().clear();
  }
  SliceForm form() const { return form_; }
  // Those of the objects, or of the groups.
  const SliceMaps& maps() const { return maps_; }
  // The id of the object that bit `number` stands for. Of kTwoLevels, object `number` is in group number /
  // 64.
  std::uint32_t IdOf(std::size_t number) const { return order_[number]; }
  StateSize state_size() const { return {.words = maps_.words()}; }
  std::size_t bytes() const;
  std::size_t map_bytes() const { return maps_.bytes(); }
  StructureFigures figures() const {
    return {static_cast<double>(maps_.planes().voxels()), static_cast<double>(references_), 1};
  }

 private:
  struct Group {
    SlabBox box;
    VoxelPlanes planes;
    std::uint64_t slices[3][kGroupSlices];
  };

  template <typename Visitor>
  void Walk(SlabRay& ray, QueryState& state, Visitor& visit) const {
    VoxelWalk walk(ray, maps_.planes(), ray.t_first);
    do {
      ++state.counters.regions;
      const std::uint32_t i = walk.cell(0), j = walk.cell(1), k = walk.cell(2);
      const std::uint64_t *r = maps_.Slice(0, i), *s = maps_.Slice(1, j), *t = maps_.Slice(2, k);
      if (form_ == SliceForm::kPlain) {
        for (std::size_t word = 0; word < maps_.words() && !ray.ended(); ++word)
          if (const std::uint64_t bits = r[word] & s[word] & t[word]; bits != 0)
            AskWord(word, bits, ray, state, visit);
      } else {
        const std::uint64_t *sum_r = maps_.Summary(0, i), *sum_s = maps_.Summary(1, j),
                            *sum_t = maps_.Summary(2, k);
        for (std::size_t block = 0; block < maps_.summary_words() && !ray.ended(); ++block)
          for (std::uint64_t named = sum_r[block] & sum_s[block] & sum_t[block]; named != 0 && !ray.ended();
               named &= named - 1) {
            const std::size_t word = 64 * block + static_cast<std::size_t>(std::countr_zero(named));
            if (const std::uint64_t bits = r[word] & s[word] & t[word]; bits != 0)
              AskWord(word, bits, ray, state, visit);
          }
      }
      if (ray.ended()) return;
    } while (walk.Next(ray.t_last));
  }

  // Asks the bits of a word of the scene's bitmaps that the ray has not asked before.
  template <typename Visitor>
  void AskWord(std::size_t word, std::uint64_t bits, SlabRay& ray, QueryState& state, Visitor& visit) const {
    std::uint64_t& asked = state.words()[word];
    state.counters.repeats += static_cast<std::uint64_t>(std::popcount(bits & asked));
    bits &= ~asked;
    if (bits == 0) return;
    if (asked == 0) state.touched().push_back(static_cast<std::uint32_t>(word));
    asked |= bits;
    for (; bits != 0 && !ray.ended(); bits &= bits - 1) {
      const std::size_t number = 64 * word + static_cast<std::size_t>(std::countr_zero(bits));
      if (form_ == SliceForm::kTwoLevels)
        WalkGroup(number, ray, state, visit);
      else
        AskObject(number, ray, state, visit);
    }
  }
  template <typename Visitor>
  void AskObject(std::size_t number, SlabRay& ray, QueryState& state, Visitor& visit) const {
    ++state.counters.tests;
    if (Meets(ray, boxes_[order_[number]])) Report(ray, state, order_[number], visit);
  }
  template <typename Visitor>
  void WalkGroup(std::size_t number, SlabRay& ray, QueryState& state, Visitor& visit) const {
    const Group& group = groups_[number];
    double t_in, t_out;
    if (!Meets(ray, group.box, t_in, t_out)) return;
    VoxelWalk walk(ray, group.planes, t_in);
    std::uint64_t asked = 0;
    do {
      ++state.counters.regions;
      std::uint64_t bits =
          group.slices[0][walk.cell(0)] & group.slices[1][walk.cell(1)] & group.slices[2][walk.cell(2)];
      state.counters.repeats += static_cast<std::uint64_t>(std::popcount(bits & asked));
      bits &= ~asked;
      asked |= bits;
      for (; bits != 0; bits &= bits - 1) {
        AskObject(kGroup * number + static_cast<std::size_t>(std::countr_zero(bits)), ray, state, visit);
        if (ray.ended()) return;
      }
    } while (walk.Next(ray.t_last));
  }
  void MakeGroups();

  BoxSet boxes_;
  SliceForm form_;
  std::vector<std::uint32_t> order_;  // ids by number
  std::vector<Group> groups_;
  SliceMaps maps_;
  std::uint64_t references_ = 0;
};

}  // namespace facetless

// Rows of rays that run in a section plane, and the lengths that they spend inside closed solids. Private to
// trace/.
//
//  1. The scan axis lies in the plane, at a right angle to the rays; a row's place on it is its distance from
//     the scan's origin. Both directions are fixed in the plane by its normal alone, turned away from the
//     model's axes.
//  2. A row is a ray of an orthographic view one pixel wide, with its centre in the plane: everything that
//     holds for views holds for it.
#pragma once

#include <atomic>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "render/trace/section_area.h"
#include "render/trace/tile_tracer.h"

namespace facetless {

inline constexpr int kBlockRows = 8;

struct SectionScan {
  SectionPlane plane;
  Vec3 origin, along, axis;   // along: of the rays; along, axis and the plane's normal are orthonormal
  double begin = 0, end = 0;  // of what the plane meets of the bounds; begin >= end: nothing

  SectionScan(const SectionPlane& plane, const Box3& bounds);
  // What a coordinate's rounding is relative to, mm.
  double size() const { return size_; }
  // What the plane meets of a placed box, on the axis.
  std::optional<std::pair<double, double>> RangeOf(const Box3& box, const Placement& placement) const;

 private:
  double size_ = 0;
};

struct SectionRow {
  double length = 0;  // inside any solid, mm
  double error = 0;   // of the ends of its chords
  double unsure =
      // its way through the model's box where a solid is crossed an odd number of times or a crossing may be
      // missing
      0;
  bool odd = false, undecided = false;       // why `unsure` is not 0; undecided: the fallback solver gave up
  std::vector<SectionArea::OfSolid> solids;  // lengths, here
};

class SectionRows {
 public:
  SectionRows(const Scene::Data& scene, std::span<const SectionPlane> planes, std::size_t index,
              const SectionSolids& solids, std::uint64_t max_bytes, const Execution& execution,
              TileKernel kernel);

  const SectionScan& scan() const { return scan_; }

  struct Answer {
    std::vector<SectionRow> rows;
    std::uint64_t doubtful_rows = 0, odd_rows = 0, undecided_rows = 0;
    std::vector<std::uint32_t> open_faces;  // ascending
  };
  // The centres of `count` equal strips of [begin, end]. Errors: those of PrepareView.
  Result<Answer> Trace(double begin, double end, int count) const;

 private:
  SectionRow Measure(const Ray& ray, std::span<const SolidCrossing> crossings) const;
  // How much of the ray lies within the model's box and what the other planes keep.
  double WayThroughModel(const Ray& ray) const;

  const Scene::Data& scene_;
  const SectionSolids& solids_;
  const SectionScan scan_;
  std::vector<SectionPlane> others_;
  DirectOptions options_;
  TileKernel kernel_;
};

}  // namespace facetless

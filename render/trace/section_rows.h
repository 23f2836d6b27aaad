// Rows of rays that run in a section plane, and their lengths inside closed solids. Private to render/trace.
//
//  1. The scan axis lies in the plane, perpendicular to the rays. The position of a row is its distance from
//     the origin of the scan along the axis. The normal of the plane alone determines both directions; they
//     are rotated away from the model's axes.
//  2. A row is a ray of an orthographic view that is one pixel wide and whose centre lies in the plane.
//     Everything that is true of views is therefore true of rows.
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
  Vec3 origin, along,
      axis;  // along: direction of the rays; along, axis and the plane's normal are orthonormal
  double begin = 0, end = 0;  // positions between which the plane meets the bounds; empty if begin >= end

  SectionScan(const SectionPlane& plane, const Box3& bounds);
  // The size to which rounding errors of coordinates are relative, mm.
  double size() const { return size_; }
  // The interval of the axis in which the plane meets a placed box; nothing if it does not meet the box.
  std::optional<std::pair<double, double>> ProjectOntoAxis(const Box3& box, const Placement& placement) const;

 private:
  double size_ = 0;
};

struct SectionRow {
  double length = 0;  // length inside any solid, mm
  double error = 0;   // sum of the errors of the ends of its chords, mm
  double unsure =
      // its length inside the model's box, if a solid is crossed an odd number of times or a crossing may be
      // missing, mm
      0;
  bool odd = false,
       undecided = false;  // the reason if `unsure` is not 0; undecided: the fallback solver gave up
  std::vector<SectionArea::OfSolid> solids;  // area_mm2 holds lengths here, mm
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
  // Traces the rows at the centres of `count` equal strips of [begin, end]. Errors: the errors of
  // PrepareView.
  Result<Answer> Trace(double begin, double end, int count) const;

 private:
  SectionRow Measure(const Ray& ray, std::span<const SolidCrossing> crossings) const;
  // The length of the ray inside the model's box and inside what the other planes keep, mm.
  double LengthInsideModel(const Ray& ray) const;

  const Scene::Data& scene_;
  const SectionSolids& solids_;
  const SectionScan scan_;
  std::vector<SectionPlane> others_;
  DirectOptions options_;
  TileKernel kernel_;
};

}  // namespace facetless

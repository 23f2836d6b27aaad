// Scenes of many small boxes, and three ways to find the boxes that a primary ray may hit. V. Skala compares
// them in "Memory saving technique for space subdivision technique", sections 2 to 4: a scan over min-max
// boxes, a scan over bounding circles or spheres, and bitmaps per pixel row and column (BMSSM) for the whole
// image.
//
//  1. Object k covers size + 1 pixels per side, and its centre lies on a random pixel of the image. Parts
//     beyond the image are cut off. The paper's numbers of intersections per ray (its table 6) follow from
//     this rule.
//  2. Perspective scenes have boxes that look the same from the eye: each is at a random depth and scaled
//     accordingly.
//  3. Visit() calls back for each candidate, in the order of objects. A scan of boxes finds exactly the
//     objects whose box the ray meets; so do the bitmaps in parallel views. The other methods find a few
//     more, never fewer.
//  4. A seed gives the same scene on every machine.
#pragma once

#include <cstdint>
#include <vector>

#include "render/base/vec.h"

namespace facetless {

inline constexpr int kSceneSize = 256;  // pixels per side
// Distance of the eye from the image plane z = 0. The eye is in front of the image's centre.
inline constexpr double kEyeDistance = kSceneSize;

struct SceneBox {
  Vec3 low, high;
};

std::vector<SceneBox> RandomBoxes(int objects, int size, bool perspective, std::uint64_t seed);

// The ray through pixel (x, y): from the eye through (x, y, 0) in perspective views, along z in parallel
// views.
struct SceneRay {
  double x, y;
  Vec3 direction;  // unit length; perspective only
};
SceneRay ScenePixelRay(int x, int y, bool perspective);

// Scans all min-max boxes in order.
class BoxScan {
 public:
  BoxScan(const std::vector<SceneBox>& boxes, bool perspective);
  template <typename Visitor>
  void Visit(const SceneRay& ray, Visitor&& visit) const {
    if (perspective_)
      VisitPerspective(ray, visit);
    else
      VisitParallel(ray, visit);
  }
  std::size_t bytes() const { return boxes_.size() * (perspective_ ? sizeof(SceneBox) : sizeof(Rectangle)); }
  // Returns whether the ray meets box k.
  bool Meets(const SceneRay& ray, std::uint32_t k) const {
    return perspective_ ? MeetsBox(boxes_[k], ray) : MeetsRectangle(rectangles_[k], ray);
  }

 private:
  struct Rectangle {
    double x_low, x_high, y_low, y_high;
  };
  // Evaluates all comparisons without branches: four mispredicted branches cost more than four comparisons.
  static bool MeetsRectangle(const Rectangle& r, const SceneRay& ray) {
    return (r.x_low <= ray.x) & (ray.x <= r.x_high) & (r.y_low <= ray.y) & (ray.y <= r.y_high);
  }
  static bool MeetsBox(const SceneBox& box, const SceneRay& ray);
  template <typename Visitor>
  void VisitParallel(const SceneRay& ray, Visitor& visit) const {
    for (std::uint32_t k = 0; k < rectangles_.size(); ++k)
      if (MeetsRectangle(rectangles_[k], ray)) visit(k);
  }
  template <typename Visitor>
  void VisitPerspective(const SceneRay& ray, Visitor& visit) const {
    for (std::uint32_t k = 0; k < boxes_.size(); ++k)
      if (MeetsBox(boxes_[k], ray)) visit(k);
  }

  bool perspective_;
  std::vector<SceneBox> boxes_;
  std::vector<Rectangle> rectangles_;
};

// Scans bounding circles, or spheres with the test of section 4: (s1·s2)² − q >= 0, where q = s1·s1 − r² is
// precomputed.
class SphereScan {
 public:
  SphereScan(const std::vector<SceneBox>& boxes, bool perspective);
  template <typename Visitor>
  void Visit(const SceneRay& ray, Visitor&& visit) const {
    if (perspective_) {
      for (std::uint32_t k = 0; k < spheres_.size(); ++k) {
        const double along = Dot(spheres_[k].from_eye, ray.direction);
        if (along * along - spheres_[k].q >= 0) visit(k);
      }
    } else {
      for (std::uint32_t k = 0; k < circles_.size(); ++k) {
        const double dx = ray.x - circles_[k].x, dy = ray.y - circles_[k].y;
        if (dx * dx + dy * dy <= circles_[k].radius2) visit(k);
      }
    }
  }
  std::size_t bytes() const { return spheres_.size() * sizeof(Sphere) + circles_.size() * sizeof(Circle); }

 private:
  struct Circle {
    double x, y, radius2;
  };
  struct Sphere {
    Vec3 from_eye;
    double q;
  };
  bool perspective_;
  std::vector<Circle> circles_;
  std::vector<Sphere> spheres_;
};

// BMSSM: bit k of row i is set if the plane of row i meets object k; the same holds for columns. The
// candidates of pixel (j, i) are R_i & S_j.
class RowColumnBitmaps {
 public:
  RowColumnBitmaps(const std::vector<SceneBox>& boxes, bool perspective);
  template <typename Visitor>
  void Visit(const SceneRay& ray, Visitor&& visit) const {
    const std::uint64_t* row = Row(static_cast<int>(ray.y));
    const std::uint64_t* column = Column(static_cast<int>(ray.x));
    for (std::uint32_t word = 0; word < words_; ++word)
      for (std::uint64_t bits = row[word] & column[word]; bits != 0; bits &= bits - 1)
        visit(64 * word + static_cast<std::uint32_t>(__builtin_ctzll(bits)));
  }
  std::size_t bytes() const { return bits_.size() * sizeof(std::uint64_t); }

 private:
  const std::uint64_t* Row(int i) const { return bits_.data() + static_cast<std::size_t>(i) * words_; }
  const std::uint64_t* Column(int j) const { return Row(kSceneSize + j); }
  std::size_t words_;
  std::vector<std::uint64_t> bits_;  // rows, then columns
};

}  // namespace facetless

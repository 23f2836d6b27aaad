// Walking a model: the elements that belong to another element, as ranges for range-based for loops.
//
//     for (const Coedge& coedge : CoedgesOf(model, face))
//       for (const TrimSegment& segment : SegmentsOf(model, coedge))
//         for (const Vec3& point : PointsOf(model, segment)) box.Add(point);
//
//     for (const PlacedFace placed : WalkPlacedFaces(model, instance))
//       if (model.faces[placed.face].name == name) return placed.id;
//
//  1. A range refers to the model: it copies nothing, allocates nothing, and must not outlive the model's
//     vectors. EdgeUses is a separate table; it stays valid until the topology of the model changes.
//  2. Elements come in the order of the model: loop by loop, and within each loop coedge by coedge.
//  3. The functions require a model that Validate() accepts, or at least one whose walked ranges lie within
//     its vectors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <vector>

#include "render/model/model.h"

namespace facetless {

// The indices of a range, for code that needs the index as well as the element.
class Indices {
 public:
  class Iterator {
   public:
    explicit Iterator(std::uint32_t at) : at_(at) {}
    std::uint32_t operator*() const { return at_; }
    Iterator& operator++() {
      ++at_;
      return *this;
    }
    bool operator==(const Iterator& other) const = default;

   private:
    std::uint32_t at_;
  };

  explicit Indices(Range range) : range_(range) {}
  Iterator begin() const { return Iterator(range_.first); }
  Iterator end() const { return Iterator(range_.end()); }

 private:
  Range range_;
};

// The elements of a range of one of the model's vectors.
template <typename T>
std::span<const T> Elements(const std::vector<T>& vector, Range range) {
  return {vector.data() + range.first, range.count};
}

// The index of an element that belongs to `vector`.
template <typename T>
std::uint32_t IndexWithin(const std::vector<T>& vector, const T& element) {
  return static_cast<std::uint32_t>(&element - vector.data());
}

inline std::span<const Face> FacesOf(const Model& model, const Part& part) {
  return Elements(model.faces, part.faces);
}

inline std::span<const Solid> SolidsOf(const Model& model, const Part& part) {
  return Elements(model.solids, part.solids);
}

inline std::span<const Loop> LoopsOf(const Model& model, const Face& face) {
  return Elements(model.loops, face.loops);
}

inline std::span<const Coedge> CoedgesOf(const Model& model, const Loop& loop) {
  return Elements(model.coedges, loop.coedges);
}

inline std::span<const TrimSegment> SegmentsOf(const Model& model, const Coedge& coedge) {
  return Elements(model.trim_segments, coedge.segments);
}

inline std::span<const EdgeSegment> SegmentsOf(const Model& model, const Edge& edge) {
  return Elements(model.edge_segments, edge.segments);
}

// The degree + 1 control points (w·u, w·v, w) of a segment.
inline std::span<const Vec3> PointsOf(const Model& model, const TrimSegment& segment) {
  return Elements(model.trim_points, {segment.first_point, segment.degree + 1u});
}

// The degree + 1 control points of a segment.
inline std::span<const Vec4> PointsOf(const Model& model, const EdgeSegment& segment) {
  return Elements(model.edge_points, {segment.first_point, segment.degree + 1u});
}

// The control points of all patches of a surface.
inline std::span<const Vec4> PointsOf(const Model& model, const Surface& surface) {
  return {model.control_points.data() + surface.first_control_point,
          std::size_t{surface.PatchCount()} * surface.PointsPerPatch()};
}

// The control points of patch number i · v_spans.count + j of a surface; points along v are contiguous.
inline std::span<const Vec4> PatchPoints(const Model& model, const Surface& surface, std::uint32_t patch) {
  const std::size_t count = surface.PointsPerPatch();
  return {model.control_points.data() + surface.first_control_point + patch * count, count};
}

inline std::span<const Span> USpansOf(const Model& model, const Surface& surface) {
  return Elements(model.spans, surface.u_spans);
}

inline std::span<const Span> VSpansOf(const Model& model, const Surface& surface) {
  return Elements(model.spans, surface.v_spans);
}

// The coedges of all loops of a face, as one range.
class FaceCoedges {
 public:
  class Iterator {
   public:
    Iterator(const Model& model, std::span<const Loop> loops)
        : coedges_(model.coedges.data()), loop_(loops.data()), last_loop_(loops.data() + loops.size()) {
      EnterLoop();
    }
    const Coedge& operator*() const { return *at_; }
    Iterator& operator++() {
      if (++at_ == end_) {
        ++loop_;
        EnterLoop();
      }
      return *this;
    }
    bool operator==(std::default_sentinel_t) const { return loop_ == last_loop_; }

   private:
    // Moves to the first coedge of this loop, or of the next loop that is not empty.
    void EnterLoop() {
      while (loop_ != last_loop_ && loop_->coedges.count == 0) ++loop_;
      if (loop_ == last_loop_) return;
      at_ = coedges_ + loop_->coedges.first;
      end_ = at_ + loop_->coedges.count;
    }

    const Coedge* coedges_;
    const Loop *loop_, *last_loop_;
    const Coedge *at_ = nullptr, *end_ = nullptr;
  };

  FaceCoedges(const Model& model, const Face& face) : model_(model), loops_(LoopsOf(model, face)) {}
  Iterator begin() const { return {model_, loops_}; }
  std::default_sentinel_t end() const { return {}; }

 private:
  const Model& model_;
  std::span<const Loop> loops_;
};

inline FaceCoedges CoedgesOf(const Model& model, const Face& face) {
  return {model, face};
}

// The largest gap between the p-curves of a face and their edges, in millimetres; 0 for a face without loops.
inline double LargestGap(const Model& model, const Face& face) {
  double gap = 0;
  for (const Coedge& coedge : CoedgesOf(model, face)) gap = gap < coedge.gap_mm ? coedge.gap_mm : gap;
  return gap;
}

// The total length of the control polygons of an edge's segments, in millimetres; 0 for a degenerate edge.
double PolygonLength(const Model& model, const Edge& edge);

// The faces of the instance's part.
inline Range FacesOf(const Model& model, const Instance& instance) {
  return model.parts[instance.part].faces;
}

// The placed-face id of a face of the instance's part, as placed by the instance.
inline std::uint32_t PlacedFaceId(const Model& model, const Instance& instance, std::uint32_t face) {
  return instance.first_placed_face + (face - FacesOf(model, instance).first);
}

struct PlacedFace {
  std::uint32_t id;    // placed-face id
  std::uint32_t face;  // index into Model::faces
};

// The placed faces of one instance.
class PlacedFaceRange {
 public:
  class Iterator {
   public:
    explicit Iterator(PlacedFace at) : at_(at) {}
    PlacedFace operator*() const { return at_; }
    Iterator& operator++() {
      ++at_.id;
      ++at_.face;
      return *this;
    }
    bool operator==(const Iterator& other) const { return at_.face == other.at_.face; }

   private:
    PlacedFace at_;
  };

  PlacedFaceRange(std::uint32_t first_id, Range faces) : first_id_(first_id), faces_(faces) {}
  Iterator begin() const { return Iterator({first_id_, faces_.first}); }
  Iterator end() const { return Iterator({first_id_ + faces_.count, faces_.end()}); }

 private:
  std::uint32_t first_id_;
  Range faces_;
};

inline PlacedFaceRange WalkPlacedFaces(const Model& model, const Instance& instance) {
  return {instance.first_placed_face, FacesOf(model, instance)};
}

// One use of an edge: the coedge, and the face whose loop contains it.
struct EdgeUse {
  std::uint32_t face, coedge;
};

// The faces that use each edge:
//
//     const EdgeUses uses(model);
//     for (const EdgeUse& use : uses[edge]) faces.push_back(use.face);
//
// The uses of an edge are ordered by face, and within a face by their position in its loops.
class EdgeUses {
 public:
  explicit EdgeUses(const Model& model);
  std::span<const EdgeUse> operator[](std::size_t edge) const {
    return {uses_.data() + first_[edge], first_[edge + 1] - first_[edge]};
  }

 private:
  std::vector<EdgeUse> uses_;
  std::vector<std::size_t> first_;  // index of the first use of each edge, and the end of the last
};

}  // namespace facetless

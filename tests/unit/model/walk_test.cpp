// The ranges give the same elements in the same order as loops over indices.
#include "render/model/walk.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "tests/support/shapes.h"
#include "tests/unit/model/random_structure.h"

namespace facetless {
namespace {

using testing::RandomStructure;

template <typename T>
std::uintptr_t AddressOf(const T& element) {
  return reinterpret_cast<std::uintptr_t>(&element);
}

RC_GTEST_PROP(Walk, FacesLoopsAndCoedgesComeInOrder, (std::uint64_t seed)) {
  const Model model = RandomStructure(seed);
  std::vector<std::uintptr_t> spelled_out, walked;
  std::vector<std::uintptr_t> spelled_faces, walked_faces;
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const Range faces = model.parts[p].faces;
    for (std::uint32_t f = faces.first; f < faces.end(); ++f) {
      spelled_faces.push_back(AddressOf(model.faces[f]));
      const Range loops = model.faces[f].loops;
      for (std::uint32_t l = loops.first; l < loops.end(); ++l) {
        spelled_faces.push_back(AddressOf(model.loops[l]));
        const Range coedges = model.loops[l].coedges;
        for (std::uint32_t c = coedges.first; c < coedges.end(); ++c)
          spelled_out.push_back(AddressOf(model.coedges[c]));
      }
    }
  }
  std::vector<std::uintptr_t> by_loop;
  for (const Part& part : model.parts) {
    for (const Face& face : FacesOf(model, part)) {
      walked_faces.push_back(AddressOf(face));
      for (const Loop& loop : LoopsOf(model, face)) {
        walked_faces.push_back(AddressOf(loop));
        for (const Coedge& coedge : CoedgesOf(model, loop)) by_loop.push_back(AddressOf(coedge));
      }
      for (const Coedge& coedge : CoedgesOf(model, face)) walked.push_back(AddressOf(coedge));
    }
  }
  RC_ASSERT(walked_faces == spelled_faces);
  RC_ASSERT(by_loop == spelled_out);
  RC_ASSERT(walked == spelled_out);
}

RC_GTEST_PROP(Walk, SegmentsAndTheirPointsComeInOrder, (std::uint64_t seed)) {
  const Model model = RandomStructure(seed);
  std::vector<std::uintptr_t> spelled_out, walked;
  for (const Coedge& coedge : model.coedges) {
    for (std::uint32_t s = coedge.segments.first; s < coedge.segments.end(); ++s) {
      const TrimSegment& segment = model.trim_segments[s];
      for (std::uint32_t i = 0; i <= segment.degree; ++i)
        spelled_out.push_back(AddressOf(model.trim_points[segment.first_point + i]));
    }
    for (const TrimSegment& segment : SegmentsOf(model, coedge))
      for (const Vec3& point : PointsOf(model, segment)) walked.push_back(AddressOf(point));
  }
  for (const Edge& edge : model.edges) {
    for (std::uint32_t s = edge.segments.first; s < edge.segments.end(); ++s) {
      const EdgeSegment& segment = model.edge_segments[s];
      for (std::uint32_t i = 0; i <= segment.degree; ++i)
        spelled_out.push_back(AddressOf(model.edge_points[segment.first_point + i]));
    }
    for (const EdgeSegment& segment : SegmentsOf(model, edge))
      for (const Vec4& point : PointsOf(model, segment)) walked.push_back(AddressOf(point));
  }
  RC_ASSERT(walked == spelled_out);
}

RC_GTEST_PROP(Walk, PatchesTakeASurfacesPointsInTurn, (std::uint64_t seed)) {
  const Model model = RandomStructure(seed);
  for (const Surface& surface : model.surfaces) {
    std::vector<std::uintptr_t> patch_by_patch, all;
    for (std::uint32_t patch = 0; patch < surface.PatchCount(); ++patch) {
      RC_ASSERT(PatchPoints(model, surface, patch).size() == surface.PointsPerPatch());
      for (const Vec4& point : PatchPoints(model, surface, patch)) patch_by_patch.push_back(AddressOf(point));
    }
    for (const Vec4& point : PointsOf(model, surface)) all.push_back(AddressOf(point));
    RC_ASSERT(patch_by_patch == all);
    RC_ASSERT(all.front() == AddressOf(model.control_points[surface.first_control_point]));
    RC_ASSERT(USpansOf(model, surface).size() * VSpansOf(model, surface).size() == surface.PatchCount());
    RC_ASSERT(IndexWithin(model.spans, USpansOf(model, surface)[0]) == surface.u_spans.first);
    RC_ASSERT(IndexWithin(model.spans, VSpansOf(model, surface)[0]) == surface.v_spans.first);
  }
}

RC_GTEST_PROP(Walk, PlacedFacesCountThroughTheInstances, (std::uint64_t seed)) {
  const Model model = RandomStructure(seed);
  std::uint32_t next = 0;
  for (std::uint32_t i = 0; i < model.instances.size(); ++i) {
    const Instance& instance = model.instances[i];
    std::uint32_t face = model.parts[instance.part].faces.first;
    for (const PlacedFace placed : WalkPlacedFaces(model, instance)) {
      RC_ASSERT(placed.id == next++);
      RC_ASSERT(placed.face == face++);
      RC_ASSERT(placed.face == model.FaceOfPlacedFace(placed.id));
      RC_ASSERT(model.InstanceOfPlacedFace(placed.id) == i);
      RC_ASSERT(PlacedFaceId(model, instance, placed.face) == placed.id);
    }
    RC_ASSERT(face == model.parts[instance.part].faces.end());
  }
  RC_ASSERT(next == model.PlacedFaceCount());
}

RC_GTEST_PROP(Walk, IndicesAndElementsAreTheSamePlaces, (std::uint64_t seed)) {
  const Model model = RandomStructure(seed);
  for (const Part& part : model.parts) {
    std::vector<std::uint32_t> by_index, by_element;
    for (const std::uint32_t s : Indices(part.solids)) by_index.push_back(s);
    for (const Solid& solid : SolidsOf(model, part)) by_element.push_back(IndexWithin(model.solids, solid));
    RC_ASSERT(by_index == by_element);
    RC_ASSERT(by_index.size() == part.solids.count);
  }
}

RC_GTEST_PROP(Walk, EveryUseOfAnEdgeIsFoundOnce, (std::uint64_t seed)) {
  const Model model = RandomStructure(seed);
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> spelled_out(model.edges.size());
  for (std::uint32_t f = 0; f < model.faces.size(); ++f) {
    const Range loops = model.faces[f].loops;
    for (std::uint32_t l = loops.first; l < loops.end(); ++l) {
      const Range coedges = model.loops[l].coedges;
      for (std::uint32_t c = coedges.first; c < coedges.end(); ++c)
        if (model.coedges[c].edge != kNoIndex) spelled_out[model.coedges[c].edge].emplace_back(f, c);
    }
  }
  const EdgeUses uses(model);
  for (std::size_t e = 0; e < model.edges.size(); ++e) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
    for (const EdgeUse& use : uses[e]) found.emplace_back(use.face, use.coedge);
    RC_ASSERT(found == spelled_out[e]);
    RC_ASSERT(model.edges[e].coedge_count == found.size());
  }
}

TEST(Walk, OfAModelWithoutAnythingEndsAtOnce) {
  const Model model;
  const EdgeUses uses(model);
  for (const std::uint32_t index : Indices({0, 0})) FAIL() << index;
  for (const Coedge& coedge : CoedgesOf(model, Face{})) FAIL() << coedge.edge;
  EXPECT_EQ(LargestGap(model, Face{}), 0);
}

TEST(Walk, LoopsWithoutCoedgesArePassedOver) {
  // No valid model has such an element, but unfinished models do.
  Model model;
  model.coedges.resize(2);
  model.loops = {{{0, 0}}, {{0, 1}}, {{1, 0}}, {{1, 1}}, {{2, 0}}};
  Face face;
  face.loops = {0, 5};
  std::vector<std::uint32_t> found;
  for (const Coedge& coedge : CoedgesOf(model, face)) found.push_back(IndexWithin(model.coedges, coedge));
  EXPECT_EQ(found, (std::vector<std::uint32_t>{0, 1}));
}

TEST(Walk, GapsAndLengthsAreMeasuredOverAllOfThem) {
  const Model box = testing::LooseBox({3, 4, 12}, 0, 1);
  double sum = 0;
  for (const Edge& edge : box.edges) sum += PolygonLength(box, edge);
  EXPECT_DOUBLE_EQ(sum, 4 * (3 + 4 + 12));
  Model loose = testing::LooseBox({3, 4, 12}, 0.5, 1);
  loose.coedges[6].gap_mm = 0.75;  // a coedge of the second face
  EXPECT_EQ(LargestGap(loose, loose.faces[0]), 0.5);
  EXPECT_EQ(LargestGap(loose, loose.faces[1]), 0.75);
}

}  // namespace
}  // namespace facetless

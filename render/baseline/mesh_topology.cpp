#include "render/baseline/mesh_topology.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <unordered_map>

#include "render/model/walk.h"

namespace facetless {
namespace {

// A position of a solid. −0 and +0 are the same.
struct SolidPosition {
  std::array<std::uint32_t, 3> bits;
  std::uint32_t solid;

  bool operator==(const SolidPosition&) const = default;
};

struct PlaceHash {
  std::size_t operator()(const SolidPosition& place) const {
    // Multiply by an odd constant to spread similar bit patterns.
    std::uint64_t hash = place.solid;
    for (std::uint32_t word : place.bits) hash = (hash ^ word) * 0x9e3779b97f4a7c15u, hash ^= hash >> 29;
    return hash;
  }
};

SolidPosition MakeSolidPosition(const std::array<float, 3>& position, std::uint32_t solid) {
  SolidPosition place{{}, solid};
  for (int k = 0; k < 3; ++k) place.bits[k] = std::bit_cast<std::uint32_t>(position[k] + 0.0f);
  return place;
}

// One triangle's use of an edge between corners low < high.
struct EdgeUse {
  std::uint32_t low, high;
  bool upwards;

  bool SameEdge(const EdgeUse& other) const { return low == other.low && high == other.high; }
};

MeshTopology CountSharedEdges(const WeldedPart& part, std::size_t all_triangles) {
  MeshTopology topology;
  topology.triangles = part.triangles.size();
  topology.collapsed = all_triangles - part.triangles.size();
  std::vector<EdgeUse> uses;
  uses.reserve(3 * part.triangles.size());
  for (const auto& triangle : part.triangles)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t from = triangle[k], to = triangle[(k + 1) % 3];
      uses.push_back({std::min(from, to), std::max(from, to), from < to});
    }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return a.low != b.low ? a.low < b.low : a.high < b.high;
  });
  for (std::size_t i = 0, end = 0; i < uses.size(); i = end) {
    while (end < uses.size() && uses[end].SameEdge(uses[i])) ++end;
    topology.open_edges += end - i == 1;
    topology.flipped_edges += end - i == 2 && uses[i].upwards == uses[i + 1].upwards;
    topology.non_manifold_edges += end - i > 2;
  }
  return topology;
}

std::string Counted(std::uint64_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

}  // namespace

WeldedPart Weld(const MeshPart& part, const std::vector<std::uint32_t>& solid_of_face) {
  WeldedPart welded;
  std::unordered_map<SolidPosition, std::uint32_t, PlaceHash> index_of;
  index_of.reserve(part.positions.size());
  for (std::size_t t = 0; t < part.triangles.size(); ++t) {
    const std::uint32_t face = part.face_of_triangle[t];
    const std::uint32_t solid = face < solid_of_face.size() ? solid_of_face[face] : kNoIndex;
    std::array<std::uint32_t, 3> corners;
    for (int k = 0; k < 3; ++k) {
      const auto& position = part.positions[part.triangles[t][k]];
      const auto [found, fresh] = index_of.try_emplace(MakeSolidPosition(position, solid),
                                                       static_cast<std::uint32_t>(welded.positions.size()));
      if (fresh) welded.positions.push_back(position);
      corners[k] = found->second;
    }
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    welded.triangles.push_back(corners);
    welded.source.push_back(static_cast<std::uint32_t>(t));
  }
  return welded;
}

std::vector<std::uint32_t> SolidsOfFaces(const MeshNode& node, const Model& model) {
  const Instance& instance = model.instances[model.InstanceOfPlacedFace(node.first_placed_face)];
  std::vector<std::uint32_t> solids;
  for (const Face& face : FacesOf(model, model.parts[instance.part])) solids.push_back(face.solid);
  return solids;
}

MeshTopology MeasureTopology(const Mesh& mesh, const Model& model) {
  MeshTopology sum;
  std::vector<std::optional<MeshTopology>> of_part(mesh.parts.size());
  for (const MeshNode& node : mesh.nodes) {
    const MeshPart& part = mesh.parts[node.part];
    if (part.triangles.empty()) continue;
    std::optional<MeshTopology>& one = of_part[node.part];
    if (!one) one = CountSharedEdges(Weld(part, SolidsOfFaces(node, model)), part.triangles.size());
    sum.triangles += one->triangles;
    sum.collapsed += one->collapsed;
    sum.open_edges += one->open_edges;
    sum.flipped_edges += one->flipped_edges;
    sum.non_manifold_edges += one->non_manifold_edges;
  }
  return sum;
}

std::string TopologySentence(const MeshTopology& topology) {
  std::string text = Counted(topology.triangles, "triangle");
  if (topology.collapsed > 0) text += " (and " + std::to_string(topology.collapsed) + " without any area)";
  text += topology.IsWatertight() ? "; watertight" : "; not watertight";
  std::string faults;
  const auto add = [&](std::uint64_t count, const std::string& what) {
    if (count > 0) faults += (faults.empty() ? ": " : ", ") + Counted(count, what);
  };
  add(topology.open_edges, "open edge");
  add(topology.non_manifold_edges, "non-manifold edge");
  add(topology.flipped_edges, "flipped edge");
  return text + faults;
}

}  // namespace facetless

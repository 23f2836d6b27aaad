#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <new>
#include <string>

#include "render/base/parallel.h"
#include "render/base/stopwatch.h"
#include "render/baseline/mesh_file.h"
#include "render/baseline/scene_data.h"

namespace facetless {

bool CountBytes(void* user, ssize_t bytes, bool post) {
  EmbreeMemory& memory = *static_cast<EmbreeMemory*>(user);
  const std::int64_t now = memory.now.fetch_add(bytes) + bytes;
  // An allocation that is reported afterwards cannot be refused; the next one will be.
  const bool stopped = memory.building != nullptr && memory.building->cancelled();
  if (bytes > 0 && !post && (stopped || (memory.most > 0 && now > memory.most))) {
    memory.now.fetch_sub(bytes);
    memory.refused = true;
    return false;
  }
  std::int64_t peak = memory.peak.load();
  while (now > peak && !memory.peak.compare_exchange_weak(peak, now)) {
  }
  return true;
}

Result<void> CheckEmbree(RTCDevice device) {
  const RTCError code = rtcGetDeviceError(device);
  if (code == RTC_ERROR_NONE && device != nullptr) return {};
  if (code == RTC_ERROR_OUT_OF_MEMORY)
    return Error{ErrorCode::kLimitExceeded, "the mesh's search tree does not fit into memory"};
  if (code == RTC_ERROR_UNSUPPORTED_CPU)
    return Error{ErrorCode::kBadUsage,
                 "the baseline needs a processor with SSE2, which Embree does not find"};
  return Error{ErrorCode::kInternal, "Embree reports error " + std::to_string(static_cast<int>(code))};
}

namespace {

// An entry of an instance's matrix that is smaller than this share of the largest entry is set to 0, because
// it is below the float32 resolution of the sums in which it occurs. See kLeastCoordinate in tracer.cpp.
constexpr double kLeastEntry = 1e-8;

// Rays start near the mesh. A ray whose start is farther away than this many diagonals misses the mesh.
constexpr double kReachShare = 1e6;
// The largest scale of an instance. From 1e13 on, Embree finds no hits in an instance.
constexpr double kGreatestScale = 1e9;
// The largest number of triangles of parts that cannot be instanced, in all copies together.
constexpr std::uint64_t kMostCopied = 4'000'000;

float Entry(double entry, double largest) {
  return std::fabs(entry) >= kLeastEntry * largest ? static_cast<float>(entry) : 0.0f;
}

PlacedNode MakePlacedNode(const Placement& placement) {
  // Transform normals by the cofactors of the placement's linear part, which need no division.
  const auto& m = placement.m;
  PlacedNode node;
  node.placement = placement;
  node.side = placement.Determinant() < 0 ? -1 : 1;
  const Vec3 row[3] = {{m[0][0], m[0][1], m[0][2]}, {m[1][0], m[1][1], m[1][2]}, {m[2][0], m[2][1], m[2][2]}};
  for (int r = 0; r < 3; ++r) node.normal_rows[r] = node.side * Cross(row[(r + 1) % 3], row[(r + 2) % 3]);
  return node;
}

float LargestCoordinate(const MeshPart& part) {
  float largest = 0;
  for (const auto& p : part.positions)
    for (const float x : p) largest = std::max(largest, std::fabs(x));
  return largest;
}

// Returns whether the inverse of the placement keeps rays that start within `reach` of the origin in the
// valid range: the inverse must not enlarge them beyond the range or reduce them to nothing.
bool IsInvertibleInRange(const Placement& placement, double reach) {
  const auto& m = placement.m;
  const Vec3 row[3] = {{m[0][0], m[0][1], m[0][2]}, {m[1][0], m[1][1], m[1][2]}, {m[2][0], m[2][1], m[2][2]}};
  const auto largest = [](Vec3 v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); };
  double entry = 0, cofactor = 0;
  for (int r = 0; r < 3; ++r) {
    entry = std::max(entry, largest(row[r]));
    cofactor = std::max(cofactor, largest(Cross(row[(r + 1) % 3], row[(r + 2) % 3])));
  }
  const double farthest = 3 * cofactor * std::max(reach, kSteepestRay);
  return entry <= kGreatestScale && farthest <= kGreatestCoordinate * std::fabs(placement.Determinant());
}

// Makes a triangle geometry of the part. `map` is applied to its positions.
template <typename Map>
RTCGeometry MakeTriangles(RTCDevice device, const MeshPart& part, const Map& map) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), part.positions.size()));
  auto* indices = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t),
                              part.triangles.size()));
  if (vertices == nullptr || indices == nullptr) {
    rtcReleaseGeometry(geometry);
    return nullptr;
  }
  for (const auto& position : part.positions) {
    const Vec3 p = map(Vec3{position[0], position[1], position[2]});
    *vertices++ = static_cast<float>(p.x);
    *vertices++ = static_cast<float>(p.y);
    *vertices++ = static_cast<float>(p.z);
  }
  for (const auto& triangle : part.triangles)
    for (std::uint32_t vertex : triangle) *indices++ = vertex;
  rtcCommitGeometry(geometry);
  return geometry;
}

RTCScene NewScene(RTCDevice device, bool to_be_cut) {
  const RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, to_be_cut ? RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION
                                    : RTC_SCENE_FLAG_ROBUST);
  return scene;
}

// Attaches the geometry and releases the caller's reference to it.
unsigned Attach(RTCScene scene, RTCGeometry geometry) {
  const unsigned id = rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  return id;
}

class Builder {
 public:
  explicit Builder(BaselineScene::Data& data) : data_(data), mesh_(*data.mesh) {}

  // Builds the trees. Errors: kLimitExceeded (too many triangles would have to be copied), and the errors of
  // Embree.
  Result<void> Build() {
    std::vector<std::uint32_t> uses(mesh_.parts.size(), 0);
    for (const MeshNode& node : mesh_.nodes) ++uses[node.part];
    std::vector<bool> shared(mesh_.parts.size());
    for (std::size_t i = 0; i < shared.size(); ++i)
      shared[i] = uses[i] > 1 && LargestCoordinate(mesh_.parts[i]) <= kLargestMesh;
    std::uint64_t copied = 0;
    data_.part_scenes.assign(mesh_.parts.size(), nullptr);
    data_.scene = NewScene(data_.device, data_.to_be_cut);
    for (std::size_t i = 0; i < mesh_.nodes.size(); ++i) {
      const MeshNode& node = mesh_.nodes[i];
      data_.nodes.push_back(MakePlacedNode(node.placement));
      const MeshPart& part = mesh_.parts[node.part];
      if (part.triangles.empty()) continue;
      const bool instanced = shared[node.part] && IsInvertibleInRange(node.placement, data_.reach);
      if (uses[node.part] > 1 && !instanced) copied += part.triangles.size();
      if (copied > kMostCopied)
        return Error{ErrorCode::kLimitExceeded,
                     "the transformation of a node is singular, or scales by more than single precision can "
                     "invert; apply their "
                     "transformations to the triangles"};
      if (!(instanced ? AddInstance(i) : AddPlaced(i))) {
        const Result<void> why = CheckEmbree(data_.device);
        return why.ok() ? Error{ErrorCode::kInternal, "Embree cannot hold the whole mesh"} : why.error();
      }
    }
    rtcCommitScene(data_.scene);
    return CheckEmbree(data_.device);
  }

 private:
  bool AddPlaced(std::size_t node_index) {
    const MeshNode& node = mesh_.nodes[node_index];
    const RTCGeometry geometry = MakeTriangles(
        data_.device, mesh_.parts[node.part], [&](Vec3 p) { return node.placement.Point(p) - data_.center; });
    return geometry != nullptr && Remember(Attach(data_.scene, geometry), node_index);
  }

  bool AddInstance(std::size_t node_index) {
    const MeshNode& node = mesh_.nodes[node_index];
    RTCScene& part_scene = data_.part_scenes[node.part];
    if (part_scene == nullptr) {
      const RTCGeometry triangles =
          MakeTriangles(data_.device, mesh_.parts[node.part], [](Vec3 p) { return p; });
      if (triangles == nullptr) return false;
      part_scene = NewScene(data_.device, data_.to_be_cut);
      Attach(part_scene, triangles);
      rtcCommitScene(part_scene);
    }
    const RTCGeometry instance = rtcNewGeometry(data_.device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, part_scene);
    const auto& m = node.placement.m;
    double norm = 0;
    for (const auto& row : m)
      for (int c = 0; c < 3; ++c) norm = std::max(norm, std::fabs(row[c]));
    float columns[12];
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) columns[3 * c + r] = Entry(m[r][c], norm);
    }
    columns[9] = static_cast<float>(m[0][3] - data_.center.x);
    columns[10] = static_cast<float>(m[1][3] - data_.center.y);
    columns[11] = static_cast<float>(m[2][3] - data_.center.z);
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
    rtcCommitGeometry(instance);
    return Remember(Attach(data_.scene, instance), node_index);
  }

  bool Remember(unsigned geometry_id, std::size_t node_index) {
    if (geometry_id == RTC_INVALID_GEOMETRY_ID) return false;
    if (data_.node_of_geometry.size() <= geometry_id) data_.node_of_geometry.resize(geometry_id + 1, 0);
    data_.node_of_geometry[geometry_id] = static_cast<std::uint32_t>(node_index);
    return true;
  }

  BaselineScene::Data& data_;
  const Mesh& mesh_;
};

std::uint64_t MeshBytes(const Mesh& mesh) {
  std::uint64_t bytes = mesh.nodes.size() * sizeof(MeshNode);
  for (const MeshPart& part : mesh.parts)
    bytes += part.positions.size() * sizeof(part.positions[0]) +
             part.normals.size() * sizeof(part.normals[0]) +
             part.triangles.size() * sizeof(part.triangles[0]) +
             part.face_of_triangle.size() * sizeof(part.face_of_triangle[0]);
  return bytes;
}

Error TooLarge(std::uint64_t max_bytes) {
  constexpr double kMegabyte = 1 << 20;
  char text[160];
  std::snprintf(text, sizeof text,
                "the mesh's search tree needs more than the %.4g MB of memory that it may take; "
                "use --max-view-memory to allow more, and a coarser mesh needs less",
                static_cast<double>(max_bytes) / kMegabyte);
  return {ErrorCode::kLimitExceeded, text};
}

}  // namespace

BaselineScene::Data::~Data() {
  if (scene != nullptr) rtcReleaseScene(scene);
  for (RTCScene part : part_scenes)
    if (part != nullptr) rtcReleaseScene(part);
  if (device != nullptr) rtcReleaseDevice(device);
}

BaselineScene::BaselineScene(std::unique_ptr<Data> data) : data_(std::move(data)) {}
BaselineScene::~BaselineScene() = default;
BaselineScene::BaselineScene(BaselineScene&&) noexcept = default;
BaselineScene& BaselineScene::operator=(BaselineScene&&) noexcept = default;

const Mesh& BaselineScene::mesh() const {
  return *data_->mesh;
}
const Box3& BaselineScene::bounds() const {
  return data_->bounds;
}
std::uint64_t BaselineScene::triangles() const {
  return data_->triangles;
}
double BaselineScene::build_ms() const {
  return data_->build_ms;
}
std::uint64_t BaselineScene::bvh_bytes() const {
  return data_->memory.now.load();
}
std::uint64_t BaselineScene::bvh_peak_bytes() const {
  return data_->memory.peak.load();
}
std::uint64_t BaselineScene::mesh_bytes() const {
  return data_->mesh_bytes;
}
double BaselineScene::noise_mm() const {
  return data_->noise_mm;
}

Result<BaselineScene> BaselineScene::Build(const Mesh& mesh, const Execution& execution, bool to_be_cut,
                                           std::uint64_t max_bytes) {
  auto data = std::make_unique<Data>();
  data->mesh = &mesh;
  data->to_be_cut = to_be_cut;
  data->bounds = MeshBounds(mesh);
  data->center = data->bounds.center();
  data->triangles = PlacedTriangleCount(mesh);
  data->mesh_bytes = MeshBytes(mesh);
  data->noise_mm = PositionNoise(mesh);
  if (data->triangles == 0) return Error{ErrorCode::kNothingUsable, "the mesh has no visible triangle"};
  if (const double size = data->bounds.diagonal(); !(size <= kLargestMesh)) {
    char text[100];
    std::snprintf(
        text, sizeof text,
        "the mesh is %.3g mm large, and the mesh tracer accepts at most %.0e mm; scale the mesh down", size,
        kLargestMesh);
    return Error{ErrorCode::kLimitExceeded, text};
  }
  data->reach = std::min(kReachShare * data->bounds.diagonal(), kGreatestCoordinate);

  const Stopwatch stopwatch;
  // Embree uses the threads of the arena that commits. A number of threads given to the device would apply to
  // the whole process.
  data->device = rtcNewDevice(nullptr);
  if (data->device == nullptr) return CheckEmbree(nullptr).error();
  constexpr std::uint64_t kAny = std::numeric_limits<std::int64_t>::max();
  data->memory.most = static_cast<std::int64_t>(std::min(max_bytes, kAny));
  rtcSetDeviceMemoryMonitorFunction(data->device, CountBytes, &data->memory);
  Result<void> built;
  data->memory.building = &execution;
  try {
    RunWithThreads(execution.threads, [&] { built = Builder(*data).Build(); });
  } catch (const std::bad_alloc&) {
    if (execution.cancelled()) return Error{ErrorCode::kCancelled, "stopped"};
    if (data->memory.refused) return TooLarge(max_bytes);
    return Error{ErrorCode::kLimitExceeded, "the mesh's search tree does not fit into memory"};
  }
  data->memory.building = nullptr;
  if (execution.cancelled()) return Error{ErrorCode::kCancelled, "stopped"};
  if (data->memory.refused) return TooLarge(max_bytes);
  if (!built.ok()) return built.error();
  data->build_ms = stopwatch.Milliseconds();
  return BaselineScene(std::move(data));
}

}  // namespace facetless

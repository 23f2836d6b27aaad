#include "import/exact_intersector.h"

#include <BRepBndLib.hxx>
#include <Bnd_Box.hxx>
#include <IntCurvesFace_Intersector.hxx>
#include <Precision.hxx>
#include <Standard_ErrorHandler.hxx>
#include <Standard_Failure.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <gp_Lin.hxx>
#include <utility>

#include "render/base/stopwatch.h"

namespace facetless {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct BoxedFace {
  TopoDS_Face face;
  Box3 box;
  std::unique_ptr<IntCurvesFace_Intersector> intersector;  // created when first needed
};

struct FileRay {
  double origin[3], direction[3];
};

Box3 BoxOf(const TopoDS_Face& face) {
  Bnd_Box bound;
  BRepBndLib::Add(face, bound, false);
  Box3 box;
  if (bound.IsVoid()) return box;
  double x0, y0, z0, x1, y1, z1;
  bound.Get(x0, y0, z0, x1, y1, z1);
  const double slack = 0.01 * std::hypot(x1 - x0, y1 - y0, z1 - z0);
  box.Add({x0 - slack, y0 - slack, z0 - slack});
  box.Add({x1 + slack, y1 + slack, z1 + slack});
  return box;
}

// Returns the depths between which the ray is inside the box; first > second if it misses the box.
std::pair<double, double> DepthsInside(const Box3& box, Vec3 ray_origin, Vec3 ray_direction) {
  const double origin[3] = {ray_origin.x, ray_origin.y, ray_origin.z};
  const double direction[3] = {ray_direction.x, ray_direction.y, ray_direction.z};
  const double low[3] = {box.low.x, box.low.y, box.low.z};
  const double high[3] = {box.high.x, box.high.y, box.high.z};
  double enter = -kInfinity, leave = kInfinity;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0) {
      if (origin[axis] < low[axis] || origin[axis] > high[axis]) return {kInfinity, -kInfinity};
      continue;
    }
    const double a = (low[axis] - origin[axis]) / direction[axis];
    const double b = (high[axis] - origin[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return {enter, leave};
}

Result<std::vector<FileRay>> ReadRays(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::vector<FileRay> rays;
  for (FileRay ray; in.read(reinterpret_cast<char*>(&ray), sizeof ray);) rays.push_back(ray);
  if (rays.empty()) return Error{ErrorCode::kFileUnreadable, path + " holds no ray."};
  return rays;
}

}  // namespace

struct ExactIntersector::Data {
  std::vector<BoxedFace> faces;
  std::vector<std::pair<double, int>> queue;  // for one ray: depth at which it enters the box, face
};

ExactIntersector::ExactIntersector(const std::vector<TopoDS_Face>& faces) : data_(std::make_unique<Data>()) {
  data_->faces.reserve(faces.size());
  for (const TopoDS_Face& face : faces) data_->faces.push_back({face, BoxOf(face), nullptr});
}
ExactIntersector::~ExactIntersector() = default;
ExactIntersector::ExactIntersector(ExactIntersector&&) noexcept = default;
ExactIntersector& ExactIntersector::operator=(ExactIntersector&&) noexcept = default;

const Box3& ExactIntersector::box(int face) const {
  return data_->faces[static_cast<std::size_t>(face)].box;
}

ExactHit ExactIntersector::Nearest(Vec3 origin, Vec3 direction, double near) {
  // Queue the faces whose boxes the ray meets.
  data_->queue.clear();
  for (std::size_t i = 0; i < data_->faces.size(); ++i) {
    if (data_->faces[i].box.empty()) continue;
    const auto [enter, leave] = DepthsInside(data_->faces[i].box, origin, direction);
    if (enter <= leave && leave >= near) data_->queue.emplace_back(enter, static_cast<int>(i));
  }
  std::sort(data_->queue.begin(), data_->queue.end());
  // Ask each face, until the next box begins behind the hit. The line's parameter is a length; the depth is
  // that length divided by the length of the direction.
  const double length = Length(direction);
  const gp_Lin line(gp_Pnt(origin.x, origin.y, origin.z), gp_Dir(direction.x, direction.y, direction.z));
  const double from = near == -kInfinity ? -RealLast() : near * length;
  ExactHit best;
  for (const auto& [enter, index] : data_->queue) {
    if (enter > best.depth) break;
    BoxedFace& face = data_->faces[static_cast<std::size_t>(index)];
    try {
      OCC_CATCH_SIGNALS
      if (!face.intersector)
        face.intersector = std::make_unique<IntCurvesFace_Intersector>(face.face, Precision::Confusion());
      face.intersector->Perform(line, from, RealLast());
      if (!face.intersector->IsDone()) continue;
      for (int i = 1; i <= face.intersector->NbPnt(); ++i) {
        const double depth = face.intersector->WParameter(i) / length;
        if (depth < near || !(depth < best.depth)) continue;
        best.depth = depth;
        best.face = index;
      }
    } catch (const Standard_Failure&) {
      best.failed = true;
    }
  }
  return best;
}

Result<ExactTiming> TimeExactIntersector(const std::vector<TopoDS_Face>& faces, const std::string& rays_path,
                                         const std::string& depths_path, double near, double seconds) {
  const auto rays = ReadRays(rays_path);
  if (!rays.ok()) return rays.error();
  ExactIntersector intersector(faces);
  const auto ask = [&](const FileRay& ray) {
    return intersector
        .Nearest({ray.origin[0], ray.origin[1], ray.origin[2]},
                 {ray.direction[0], ray.direction[1], ray.direction[2]}, near)
        .depth;
  };
  // Trace once to prepare the faces.
  std::vector<double> depths;
  const Stopwatch preparation;
  for (const FileRay& ray : rays.value()) {
    if (preparation.Milliseconds() > 500 * seconds) break;
    depths.push_back(ask(ray));
  }
  // Trace the same rays again to measure.
  const Stopwatch stopwatch;
  for (std::size_t i = 0; i < depths.size(); ++i) depths[i] = ask(rays.value()[i]);
  const ExactTiming timing{depths.size(), stopwatch.Milliseconds()};
  std::ofstream out(depths_path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(depths.data()),
            static_cast<std::streamsize>(depths.size() * sizeof(double)));
  out.close();
  if (!out) return Error{ErrorCode::kWriteFailed, "The depths cannot be written to " + depths_path + "."};
  return timing;
}

}  // namespace facetless

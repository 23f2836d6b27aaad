#include "tests/verify/seams/sweep.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "import/convert.h"
#include "import/readers.h"
#include "import/source_file.h"
#include "render/kernels/dispatch.h"
#include "render/model/walk.h"
#include "render/trace/audit.h"
#include "render/trace/projected_edges.h"
#include "render/trace/scene.h"
#include "tests/support/temporary_folder.h"

namespace facetless {
namespace {

std::vector<Vec3> CubeDirections() {
  std::vector<Vec3> directions;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if (x != 0 || y != 0 || z != 0) directions.push_back({double(x), double(y), double(z)});
  return directions;
}

// Looks at `target` from `toward_eye`, through an orthographic window of `height` mm.
Camera LookAt(Vec3 target, Vec3 toward_eye, double distance, double height, int size) {
  const Vec3 direction = Normalized(toward_eye);
  Camera camera;
  camera.target = target;
  camera.eye = target + distance * direction;
  camera.up = std::fabs(direction.z) > 0.9 ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  camera.height = height;
  camera.width_px = camera.height_px = size;
  return camera;
}

std::string Text(const char* format, Vec3 v) {
  char text[120];
  std::snprintf(text, sizeof(text), format, v.x, v.y, v.z);
  return text;
}

// Returns a point of an edge's curve, at a share of its parameter range.
Vec3 PointOf(const Model& model, const Edge& edge, double share) {
  const double scaled = share * edge.segments.count;
  const auto k = std::min(static_cast<std::uint32_t>(scaled), edge.segments.count - 1);
  const EdgeSegment& segment = SegmentsOf(model, edge)[k];
  const double t = std::min(scaled - k, 1.0);
  const auto points = PointsOf(model, segment);
  std::vector<Vec4> p(points.begin(), points.end());
  for (int level = segment.degree; level > 0; --level)
    for (int i = 0; i < level; ++i) p[i] = (1 - t) * p[i] + t * p[i + 1];
  return {p[0].x / p[0].w, p[0].y / p[0].w, p[0].z / p[0].w};
}

void Describe(const Scene::Data& scene, const CameraFrame& frame, const AuditResult& audit,
              std::uint32_t sample, LeakingRay* ray) {
  const Model& model = *scene.model;
  std::uint32_t instance = kNoIndex;
  for (const bool back : {false, true}) {
    ray->crossings += back ? "; backwards" : "forwards";
    for (const AuditHit& hit : back ? audit.backward : audit.forward) {
      if (hit.sample != sample) continue;
      if (instance == kNoIndex) instance = model.InstanceOfPlacedFace(hit.placed_face);
      char depth[40];
      std::snprintf(depth, sizeof(depth), " at %.12g", hit.root.depth);
      ray->crossings += ' ' + model.PlacedFaceName(hit.placed_face) + depth;
    }
  }
  if (instance == kNoIndex) instance = 0;
  const ProjectedEdges edges(model, model.instances[instance].placement, frame);
  ray->edge_px = INFINITY;
  for (const Face& face : FacesOf(model, model.parts[model.instances[instance].part])) {
    for (const Coedge& coedge : CoedgesOf(model, face)) {
      const std::uint32_t e = coedge.edge;
      if (e == kNoIndex) continue;
      for (const EdgeSegment& segment : SegmentsOf(model, model.edges[e])) {
        const EdgeSide side =
            edges.SideOf(e, 0.5 * (segment.begin + segment.end), ray->column + 0.5, ray->row + 0.5);
        if (side.side == Side::kUnknown || side.distance_px > ray->edge_px) continue;
        ray->gap_mm = e == ray->edge ? std::max(ray->gap_mm, coedge.gap_mm) : coedge.gap_mm;
        ray->edge = e;
        ray->edge_px = side.distance_px;
      }
    }
  }
}

}  // namespace

std::vector<SweepView> Around(const Model& model, int size) {
  std::vector<SweepView> views;
  const Vec3 center = model.bounds.center();
  const double diagonal = model.Diagonal();
  for (const Vec3 direction : CubeDirections()) {
    Camera camera = LookAt(center, direction, diagonal, diagonal, size);
    const CameraFrame frame = MakeFrame(camera, diagonal).value();
    // Fit the corners of the box, with the margin of the named views.
    double height = 0;
    for (int i = 0; i < 8; ++i) {
      const Box3& box = model.bounds;
      const Vec3 corner{i & 1 ? box.high.x : box.low.x, i & 2 ? box.high.y : box.low.y,
                        i & 4 ? box.high.z : box.low.z};
      height = std::max({height, std::fabs(Dot(corner - center, frame.right)),
                         std::fabs(Dot(corner - center, frame.down))});
    }
    camera.height = 2 * height / 0.9;
    views.push_back({Text("from %g %g %g", direction), camera});
  }
  return views;
}

std::vector<SweepView> AtEdges(const Model& model, int count, int size, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  const auto number = [&] { return double(engine() >> 11) * 0x1p-53; };
  const auto below = [&](std::size_t n) { return static_cast<std::uint32_t>(engine() % n); };
  const auto any = [&] { return Vec3{2 * number() - 1, 2 * number() - 1, 2 * number() - 1}; };
  std::vector<double> gaps(model.edges.size(), 0);
  for (const Coedge& coedge : model.coedges)
    if (coedge.edge != kNoIndex) gaps[coedge.edge] = std::max(gaps[coedge.edge], coedge.gap_mm);
  const std::vector<Vec3> cube = CubeDirections();
  const double diagonal = model.Diagonal();
  std::vector<SweepView> views;
  for (int n = 0; n < count; ++n) {
    // Choose an edge of a placed part.
    const Instance& instance = model.instances[below(model.instances.size())];
    const auto faces = FacesOf(model, model.parts[instance.part]);
    const auto loops = LoopsOf(model, faces[below(faces.size())]);
    if (loops.empty()) continue;
    const auto coedges = CoedgesOf(model, loops[below(loops.size())]);
    const std::uint32_t e = coedges[below(coedges.size())].edge;
    if (e == kNoIndex || model.edges[e].segments.count == 0) continue;
    // Choose a point on it; half of the time, an end.
    const std::uint32_t where = below(4);
    const double share = where == 0 ? 0 : where == 1 ? 1 : number();
    const Vec3 at = instance.placement.Point(PointOf(model, model.edges[e], share));
    const Vec3 beside =
        instance.placement.Point(PointOf(model, model.edges[e], share < 0.5 ? share + 1e-5 : share - 1e-5));
    const Vec3 along = Normalized(beside - at);
    // Choose a direction: one of the cube's, a random one, along the edge, or across it.
    const std::uint32_t kind = below(5);
    Vec3 direction = kind <= 1 ? cube[below(cube.size())] : any();
    if (kind == 3) direction = along + 0.05 * direction;
    if (kind == 4) direction = direction - Dot(direction, along) * along;
    // Choose a size: a third of the gap, or a share of the model.
    const double shares[] = {1e-3, 1e-5, 1e-7};
    const double share_of = shares[below(3)] * diagonal;
    const double pixel = std::max(below(2) == 0 ? gaps[e] / 3 : share_of, 1e-7 * diagonal);
    const Vec3 off = pixel * any();
    if (!(Length(direction) > 0)) continue;
    char what[160];
    std::snprintf(what, sizeof(what), "edge %u at %.3g, %s, pixel %.3g mm, gap %.3g mm", e, share,
                  Text("from %.3g %.3g %.3g", direction).c_str(), pixel, gaps[e]);
    views.push_back({what, LookAt(at + off, direction, diagonal, pixel * size, size)});
  }
  return views;
}

Result<SweepResult> Sweep(const Scene& scene, const std::vector<SweepView>& views) {
  const Result<Kernels>& kernels = ActiveKernels();
  if (!kernels.ok()) return kernels.error();
  const DirectOptions options;
  SweepResult result;
  for (const SweepView& sweep : views) {
    const Result<CameraFrame> frame = MakeFrame(sweep.camera, scene.model().Diagonal());
    if (!frame.ok()) return frame.error();
    const Result<PreparedView> view = PrepareView(scene.data(), sweep.camera, frame.value(), options);
    if (!view.ok()) return view.error();
    const Result<AuditResult> audited =
        Audit(scene.data(), view.value(), sweep.camera, frame.value(), kernels.value().trace_tile, options);
    if (!audited.ok()) return audited.error();
    const AuditResult& audit = audited.value();
    ++result.views;
    result.rays += std::uint64_t(sweep.camera.width_px) * sweep.camera.height_px;
    result.crossings += audit.crossings;
    result.odd += audit.odd_samples.size();
    result.mismatched += audit.mismatched_samples.size();
    result.seam_samples += view.value().tiles->leaves().seams.size();
    // Report the place of each leaking ray.
    std::vector<std::uint32_t> leaking = audit.odd_samples;
    leaking.insert(leaking.end(), audit.mismatched_samples.begin(), audit.mismatched_samples.end());
    std::sort(leaking.begin(), leaking.end());
    leaking.erase(std::unique(leaking.begin(), leaking.end()), leaking.end());
    for (const std::uint32_t sample : leaking) {
      if (result.leaking.size() >= kMostLeaking) break;
      LeakingRay ray;
      ray.view = sweep.what;
      ray.column = static_cast<int>(sample % sweep.camera.width_px);
      ray.row = static_cast<int>(sample / sweep.camera.width_px);
      ray.odd = std::binary_search(audit.odd_samples.begin(), audit.odd_samples.end(), sample);
      ray.mismatched =
          std::binary_search(audit.mismatched_samples.begin(), audit.mismatched_samples.end(), sample);
      Describe(scene.data(), frame.value(), audit, sample, &ray);
      result.leaking.push_back(std::move(ray));
    }
  }
  return result;
}

Result<Model> ImportedModel(const std::string& path) {
  const TemporaryFolder scratch;
  PrepareOpenCascade(scratch.path());
  const auto ignore = [](const char*, double) {};
  Result<SourceFile> source = OpenSource(path, scratch.path());
  if (!source.ok()) return source.error();
  Result<CadDocument> document = ReadDocument(source.value(), ignore);
  if (!document.ok()) return document.error();
  Result<Conversion> conversion = Convert(std::move(document.value()), [](double) {});
  if (!conversion.ok()) return conversion.error();
  return std::move(conversion.value().model);
}

}  // namespace facetless

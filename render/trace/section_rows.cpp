#include "render/trace/section_rows.h"

#include <algorithm>
#include <cmath>

#include "render/trace/crossings.h"
#include "render/trace/section_tracer.h"

namespace facetless {
namespace {

// The slope of the rays relative to the axes of the plane that follow from the model's axes. It is derived
// from the golden ratio, which real models hardly ever contain, so a face perpendicular to the plane is
// hardly ever parallel to the rays.
constexpr double kSlope = 0.38196601125010515;

// The direction of the rays: the model axis that is farthest from the normal, projected onto the plane and
// rotated.
Vec3 DirectionIn(Vec3 normal) {
  const Vec3 size{std::fabs(normal.x), std::fabs(normal.y), std::fabs(normal.z)};
  Vec3 axis{1, 0, 0};
  if (size.y <= size.x && size.y <= size.z) axis = {0, 1, 0};
  if (size.z <= size.x && size.z <= size.y) axis = {0, 0, 1};
  const Vec3 first = Normalized(Cross(normal, axis)), second = Cross(normal, first);
  return Normalized(first + kSlope * second);
}

}  // namespace

SectionScan::SectionScan(const SectionPlane& section, const Box3& bounds) : plane(section) {
  along = DirectionIn(plane.normal);
  axis = Normalized(Cross(along, plane.normal));
  // The origin is the foot of the model's centre, so that coordinates stay small.
  origin = bounds.center() - Dot(bounds.center() - plane.point, plane.normal) * plane.normal;
  if (const auto range = bounds.empty() ? std::nullopt : ProjectOntoAxis(bounds, {})) {
    // Rounding must not remove the ends of a plane that touches a side of the bounds.
    const double margin = 1e-6 * bounds.diagonal();
    begin = range->first - margin;
    end = range->second + margin;
    size_ = bounds.diagonal() + Length(origin);
  }
}

std::optional<std::pair<double, double>> SectionScan::ProjectOntoAxis(const Box3& box,
                                                                      const Placement& placement) const {
  struct Corner {
    double height, place;
  } corners[8];
  for (int i = 0; i < 8; ++i) {
    const Vec3 p = placement.Point(
        {i & 1 ? box.high.x : box.low.x, i & 2 ? box.high.y : box.low.y, i & 4 ? box.high.z : box.low.z});
    corners[i] = {Dot(plane.normal, p - plane.point), Dot(axis, p - origin)};
  }
  // Find the points where the edges of the box meet the plane.
  double low = INFINITY, high = -INFINITY;
  const auto add = [&](double place) { low = std::min(low, place), high = std::max(high, place); };
  for (int i = 0; i < 8; ++i) {
    for (int bit = 1; bit < 8; bit *= 2) {
      const Corner &a = corners[i], &b = corners[i ^ bit];
      if (a.height == 0) add(a.place);
      if ((a.height < 0) == (b.height < 0)) continue;
      add(a.place + (b.place - a.place) * (a.height / (a.height - b.height)));
    }
  }
  if (!(low <= high)) return {};
  return std::pair{low, high};
}

SectionRows::SectionRows(const Scene::Data& scene, std::span<const SectionPlane> planes, std::size_t index,
                         const SectionSolids& solids, std::uint64_t max_bytes, const Execution& execution,
                         TileKernel kernel)
    : scene_(scene), solids_(solids), scan_(planes[index], scene.model->bounds), kernel_(kernel) {
  for (std::size_t i = 0; i < planes.size(); ++i)
    if (i != index) others_.push_back(planes[i]);
  options_.accuracy.max_bytes = max_bytes;
  options_.execution = execution;
}

SectionRow SectionRows::Measure(const Ray& ray, std::span<const SolidCrossing> crossings) const {
  SectionRow row;
  if (crossings.empty()) return row;
  const KeptInterval kept = ClipRayToSections(ray, others_, -INFINITY);
  const auto clipped = [&](double depth) { return std::clamp(depth, kept.begin, kept.end); };
  if (!(kept.begin < kept.end)) return row;

  // Walk along the row. `entered` holds the solids that the row is currently inside of, and the depths at
  // which it entered them.
  std::vector<SectionArea::OfSolid> entered;
  double since = 0;  // where the row entered the first of them
  for (const SolidCrossing& crossing : crossings) {
    if (crossing.solid == kNoIndex) continue;
    const auto inside = std::find_if(entered.begin(), entered.end(),
                                     [&](const auto& e) { return e.solid == crossing.solid; });
    const double depth = clipped(crossing.depth);
    if (inside == entered.end()) {
      if (entered.empty()) since = depth;
      entered.push_back({crossing.solid, depth});
      continue;
    }
    auto sum = std::find_if(row.solids.begin(), row.solids.end(),
                            [&](const auto& s) { return s.solid == crossing.solid; });
    if (sum == row.solids.end()) sum = row.solids.insert(sum, {crossing.solid, 0});
    sum->area_mm2 += depth - inside->area_mm2;
    entered.erase(inside);
    if (entered.empty()) row.length += depth - since;
  }
  for (const SolidCrossing& crossing : crossings)
    if (crossing.solid != kNoIndex) row.error += crossing.error;
  row.odd = !entered.empty();
  return row;
}

double SectionRows::LengthInsideModel(const Ray& ray) const {
  const KeptInterval kept = ClipRayToSections(ray, others_, -INFINITY);
  double begin = kept.begin, end = kept.end;
  const Box3& box = scene_.model->bounds;
  const double origin[3] = {ray.origin.x, ray.origin.y, ray.origin.z},
               direction[3] = {ray.direction.x, ray.direction.y, ray.direction.z},
               low[3] = {box.low.x, box.low.y, box.low.z}, high[3] = {box.high.x, box.high.y, box.high.z};
  for (int k = 0; k < 3; ++k) {
    if (direction[k] == 0) continue;
    const double a = (low[k] - origin[k]) / direction[k], b = (high[k] - origin[k]) / direction[k];
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  return std::max(end - begin, 0.0);
}

Result<SectionRows::Answer> SectionRows::Trace(double begin, double end, int count) const {
  // Make a view along the plane that is one pixel wide. Its right axis is the normal, and its column of pixel
  // centres lies on the scan axis.
  Camera camera;
  camera.name = "section";
  camera.width_px = 1;
  camera.height_px = count;
  CameraFrame frame;
  frame.forward = scan_.along;
  frame.right = scan_.plane.normal;
  frame.down = Cross(frame.forward, frame.right);
  frame.eye = scan_.origin + (0.5 * (begin + end)) * scan_.axis;
  frame.pixel_x = frame.pixel_y = (end - begin) / count;
  frame.center_x = 0.5;
  frame.center_y = 0.5 * count;
  const Result<PreparedView> prepared = PrepareView(scene_, camera, frame, options_);
  if (!prepared.ok()) return prepared.error();
  const PreparedView& view = prepared.value();
  const TraceShared shared(scene_, view, camera, frame);
  TileTracer tracer(shared, kernel_, /*certify=*/false);

  Answer answer;
  answer.rows.resize(count);
  std::vector<Crossing> crossings;
  std::vector<SolidCrossing> row;
  for (int tile = 0; tile < view.tiles->tiles_x() * view.tiles->tiles_y(); ++tile) {
    crossings.clear();
    tracer.Trace(tile, &crossings);
    SortCrossings(view, &crossings);
    for (auto next = crossings.begin(); next != crossings.end();) {
      const std::uint32_t sample = next->sample;
      std::uint8_t doubt = tracer.doubt[(static_cast<int>(sample) - tracer.row()) * kTileSize];
      row.clear();
      for (; next != crossings.end() && next->sample == sample; ++next) {
        const std::uint32_t face = view.tiles->leaves().Header(next->leaf).placed_face,
                            solid = solids_.ClosedSolidOfFace(face);
        doubt |= next->doubt;
        row.push_back({next->hit.depth, ErrorOf(*next), solid});
        if (solid == kNoIndex) answer.open_faces.push_back(face);
      }
      answer.rows[sample] = Measure(PixelRay(frame, 0.5, sample + 0.5), row);
      answer.doubtful_rows += doubt != 0;
      answer.odd_rows += answer.rows[sample].odd;
    }
    if (tracer.empty()) continue;
    for (int i = 0; i < tracer.rows(); ++i) {
      SectionRow& measured = answer.rows[tracer.row() + i];
      measured.undecided = (tracer.doubt[i * kTileSize] & kDoubtUnresolved) != 0;
      answer.undecided_rows += measured.undecided;
      if (measured.odd || measured.undecided)
        measured.unsure = LengthInsideModel(PixelRay(frame, 0.5, tracer.row() + i + 0.5));
    }
  }
  std::sort(answer.open_faces.begin(), answer.open_faces.end());
  answer.open_faces.erase(std::unique(answer.open_faces.begin(), answer.open_faces.end()),
                          answer.open_faces.end());
  return answer;
}

}  // namespace facetless

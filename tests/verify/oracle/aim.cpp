#include "tests/verify/oracle/aim.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "render/model/walk.h"

namespace facetless::oracle {
namespace {

// Returns `count` random pixels.
std::vector<std::uint32_t> Some(const std::set<std::uint32_t>& pixels, std::size_t count, Random& random) {
  std::vector<std::uint32_t> all(pixels.begin(), pixels.end());
  const std::size_t taken = std::min(count, all.size());
  for (std::size_t i = 0; i < taken; ++i)
    std::swap(all[i], all[i + random.Below(static_cast<std::uint32_t>(all.size() - i))]);
  all.resize(taken);
  std::sort(all.begin(), all.end());
  return all;
}

Vec3 Divided(Vec4 p) {
  return {p.x / p.w, p.y / p.w, p.z / p.w};
}

// Returns a corner of a patch of the placed face, a vertex, or a point on one of its edges.
Vec3 FeatureOf(const Model& model, const Instance& instance, const Face& face, Random& random) {
  const Surface& surface = model.surfaces[face.surface];
  if (face.loops.count > 0 && random.Below(3) > 0) {
    const auto any_of = [&](auto range) -> const auto& {
      return range[random.Below(static_cast<std::uint32_t>(range.size()))];
    };
    const Coedge& coedge = any_of(CoedgesOf(model, any_of(LoopsOf(model, face))));
    if (coedge.edge != kNoIndex && model.edges[coedge.edge].segments.count > 0) {
      const auto points = PointsOf(model, any_of(SegmentsOf(model, model.edges[coedge.edge])));
      std::vector<Vec4> p(points.begin(), points.end());
      const double t = random.Below(2) == 0 ? 0 : random.Uniform(0, 1);
      for (std::size_t last = p.size() - 1; last > 0; --last)
        for (std::size_t i = 0; i < last; ++i) p[i] = (1 - t) * p[i] + t * p[i + 1];
      return instance.placement.Point(Divided(p[0]));
    }
  }
  const std::uint32_t patch = random.Below(surface.PatchCount());
  const std::uint32_t k = random.Below(2) * surface.degree_u, l = random.Below(2) * surface.degree_v;
  return instance.placement.Point(
      Divided(PatchPoints(model, surface, patch)[k * (surface.degree_v + 1u) + l]));
}

}  // namespace

std::vector<Vec3> Features(const Model& model, std::size_t most, Random& random) {
  std::vector<Vec3> features;
  const std::uint32_t faces = model.PlacedFaceCount();
  for (std::size_t i = 0; i < most && faces > 0; ++i) {
    const std::uint32_t id = random.Below(faces);
    features.push_back(FeatureOf(model, model.instances[model.InstanceOfPlacedFace(id)],
                                 model.faces[model.FaceOfPlacedFace(id)], random));
  }
  return features;
}

std::vector<std::uint32_t> RandomPixels(const SampleBuffer& samples, std::size_t count, Random& random) {
  std::set<std::uint32_t> pixels;
  const std::size_t taken = std::min(count, samples.size());
  while (pixels.size() < taken) pixels.insert(random.Below(static_cast<std::uint32_t>(samples.size())));
  return {pixels.begin(), pixels.end()};
}

std::vector<std::uint32_t> HardPixels(const DirectResult& direct, const std::vector<Vec3>& features,
                                      std::size_t count, Random& random) {
  const SampleBuffer& samples = direct.samples;
  std::set<std::uint32_t> borders, doubtful, aimed;
  const auto at = [&](int column, int row) {
    return static_cast<std::uint32_t>(row * samples.width + column);
  };
  for (int row = 0; row < samples.height; ++row) {
    for (int column = 0; column < samples.width; ++column) {
      const std::uint32_t here = at(column, row);
      if (samples.certificate[here] != Certificate::kCertified) doubtful.insert(here);
      const auto compare = [&](std::uint32_t there) {
        if (samples.face[here] != samples.face[there]) borders.insert({here, there});
      };
      if (column + 1 < samples.width) compare(at(column + 1, row));
      if (row + 1 < samples.height) compare(at(column, row + 1));
    }
  }
  for (const Vec3 feature : features) {
    const PixelPoint point = Project(direct.frame, feature);
    if (!(point.x >= 0 && point.x < samples.width && point.y >= 0 && point.y < samples.height)) continue;
    const int column = static_cast<int>(point.x), row = static_cast<int>(point.y);
    for (int j = std::max(row - 1, 0); j <= std::min(row + 1, samples.height - 1); ++j)
      for (int i = std::max(column - 1, 0); i <= std::min(column + 1, samples.width - 1); ++i)
        aimed.insert(at(i, j));
  }
  std::set<std::uint32_t> chosen;
  for (const auto& [pixels, share] :
       {std::pair{&borders, count / 2}, {&doubtful, count / 4}, {&aimed, count / 4}})
    for (const std::uint32_t pixel : Some(*pixels, share, random)) chosen.insert(pixel);
  return {chosen.begin(), chosen.end()};
}

Camera CloseUp(const Camera& camera, const CameraFrame& frame, Vec3 point, double window, int size) {
  Camera close = camera;
  close.width_px = close.height_px = size;
  close.target = point;
  if (camera.projection == Projection::kOrthographic) {
    close.eye = point - Length(camera.target - camera.eye) * frame.forward;
    close.height = window;
  } else {
    const double distance = Length(point - camera.eye);
    close.fov_y_deg = 2 * std::atan(0.5 * window / distance) * 180 / std::numbers::pi;
  }
  return close;
}

}  // namespace facetless::oracle

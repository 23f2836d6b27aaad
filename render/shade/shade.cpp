#include "render/shade/shade.h"

#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "render/base/parallel.h"
#include "render/shade/edges.h"
#include "render/shade/hatch.h"
#include "render/shade/studio.h"

namespace facetless {
namespace {

// The light of a hatching line on a cap of the mean light `light`. It is darker than the cap, unless the cap
// is nearly black.
float HatchLight(float light) {
  constexpr float kDark = 0.04f, kShare = 0.18f, kAgainstDark = 0.30f;
  return light < kDark ? kAgainstDark : kShare * light;
}

constexpr std::size_t kNoPixel = std::numeric_limits<std::size_t>::max();

Vec3 Linear(const Color& color) {
  return {SrgbToLinear(color.r), SrgbToLinear(color.g), SrgbToLinear(color.b)};
}

bool Same(const Color& a, const Color& b) {
  return a.r == b.r && a.g == b.g && a.b == b.b;
}

Result<void> CheckLight(const SampleBuffer& samples, const ShadeOptions& options) {
  if (options.light == nullptr) return {};
  for (const std::size_t size :
       {options.light->key.size(), options.light->open.size(), options.light->ground.size(),
        options.light->seen.size(), options.light->shows.size()})
    if (size != 0 && size != samples.size())
      return Error{ErrorCode::kSizeMismatch, "the light does not belong to the samples"};
  return {};
}

Result<void> CheckInput(const SampleBuffer& samples, const ShadeOptions& options) {
  const std::size_t count =
      static_cast<std::size_t>(samples.width) * static_cast<std::size_t>(samples.height);
  if (samples.width < 1 || samples.height < 1 || samples.depth.size() != count ||
      samples.normal.size() != count || samples.face.size() != count)
    return Error{ErrorCode::kSizeMismatch, "depth, normal and face of the samples have different sizes"};
  if (!(options.edge_angle_deg >= 0 && options.edge_angle_deg <= 180))
    return Error{ErrorCode::kBadUsage, "the edge angle must lie between 0 and 180 degrees"};
  if (options.samples_x < 1 || options.samples_y < 1)
    return Error{ErrorCode::kBadUsage, "the number of samples per pixel must be at least 1"};
  return CheckLight(samples, options);
}

// Converts a vector from model axes to viewer axes: right, up, towards the viewer. Lengths are preserved up
// to rounding.
Vec3 ToViewer(const CameraFrame& frame, Vec3 v) {
  return {Dot(v, frame.right), -Dot(v, frame.down), -Dot(v, frame.forward)};
}

// What the samples of one view are shaded with.
struct Shading {
  Shading(const CameraFrame& view_frame, std::span<const Color> colors, const ShadeOptions& shade)
      : frame(view_frame),
        options(shade),
        fallback(Linear(shade.fallback)),
        background(BackgroundLight(shade.background)) {
    // Consecutive faces mostly share their colour, so convert it only once.
    albedo.reserve(colors.size());
    for (std::size_t i = 0; i < colors.size(); ++i)
      albedo.push_back(i > 0 && Same(colors[i], colors[i - 1]) ? albedo.back() : Linear(colors[i]));
  }
  LightShare ShareAt(std::size_t i) const {
    LightShare share;
    share.shadows = !options.light->key.empty();
    if (share.shadows) share.key = options.light->key[i];
    if (!options.light->open.empty()) share.open = options.light->open[i];
    return share;
  }
  // The background, darkened where the sample sees the ground.
  std::array<float, 4> BackgroundAt(std::size_t i) const {
    if (options.light->ground.empty() || options.light->ground[i] == 0) return background;
    const auto left =
        static_cast<float>(FloorLight(Dot(options.ground_up, TowardKeyLight(frame)), ShareAt(i)));
    if (options.background == Background::kTransparent) return {0, 0, 0, 1 - left};
    return {left * background[0], left * background[1], left * background[2], 1};
  }

  const CameraFrame& frame;
  const ShadeOptions& options;
  std::vector<Vec3> albedo;  // linear, by placed face, then by cap
  const Vec3 fallback;
  const std::array<float, 4> background;
};

// Shades the samples [first, last). place(i) returns the pixel coordinates of sample `i`; `pixels` receives the
// colour of sample `first` first. Returns the first sample that is not finite, or kNoPixel.
template <bool kLit, typename PlaceOf>
std::size_t ShadeRun(const Shading& shading, const SampleBuffer& samples, std::size_t first, std::size_t last,
                     const PlaceOf& place, std::array<float, 4>* pixels) {
  const CameraFrame& frame = shading.frame;
  const bool perspective = frame.projection == Projection::kPerspective;
  StudioView view(Normalized(ToViewer(frame, -frame.forward)));
  std::size_t alike = kNoPixel;  // the last pixel whose light can be reused for the next one
  for (std::size_t i = first; i < last; ++i) {
    std::array<float, 4>& pixel = pixels[i - first];
    // A miss shows the background. NaN and −inf are not misses.
    if (samples.depth[i] == INFINITY) {
      pixel = kLit ? shading.BackgroundAt(i) : shading.background;
      continue;
    }
    const auto& n = samples.normal[i];
    if (!std::isfinite(samples.depth[i]) || !std::isfinite(n[0]) || !std::isfinite(n[1]) ||
        !std::isfinite(n[2]))
      return i;

    // In an orthographic view, a plane has the same light everywhere.
    const std::uint32_t face = samples.face[i];
    if (!kLit && alike != kNoPixel && samples.normal[alike] == n && samples.face[alike] == face) {
      pixel = pixels[alike - first];
      continue;
    }
    if (kLit && shading.options.light->Shows(i)) {
      const auto& seen = shading.options.light->seen[i];
      pixel = {seen[0], seen[1], seen[2], 1.0f};
      continue;
    }
    const Vec2 at = place(i);
    if (perspective) {
      const Ray ray = PixelRay(frame, at.x, at.y);
      view = StudioView(Normalized(ToViewer(frame, -ray.direction)));
    }
    // Flip the normal towards the viewer. A normal that the tracer could not find is zero.
    Vec3 normal = ToViewer(frame, {n[0], n[1], n[2]});
    if (!(Dot(normal, normal) > 0)) normal = view.toward();
    if (Dot(normal, view.toward()) < 0) normal = -normal;

    const Vec3 albedo = face < shading.albedo.size() ? shading.albedo[face] : shading.fallback;
    const Vec3 light = kLit ? view.Light(normal, albedo, shading.ShareAt(i)) : view.Light(normal, albedo);
    pixel = {static_cast<float>(light.x), static_cast<float>(light.y), static_cast<float>(light.z), 1.0f};
    const bool cap = face >= shading.options.first_cap;
    if (cap) HatchCap(shading.options, face, at.x, at.y, &pixel);
    alike = perspective || cap ? kNoPixel : i;
  }
  return kNoPixel;
}

template <typename PlaceOf>
std::size_t ShadeOf(const Shading& shading, const SampleBuffer& samples, std::size_t first, std::size_t last,
                    const PlaceOf& place, std::array<float, 4>* pixels) {
  return shading.options.light != nullptr ? ShadeRun<true>(shading, samples, first, last, place, pixels)
                                          : ShadeRun<false>(shading, samples, first, last, place, pixels);
}

// Lowers `bad` to `found`, if that is less.
void KeepFirst(std::size_t found, std::atomic<std::size_t>* bad) {
  std::size_t known = bad->load();
  while (found < known && !bad->compare_exchange_weak(known, found)) {
  }
}

Error NotFinite(std::size_t column, std::size_t row) {
  return {ErrorCode::kNotFinite, "the hit at pixel (" + std::to_string(column) + ", " + std::to_string(row) +
                                     ") has a depth or a normal that is not a number"};
}

}  // namespace

Result<Film> Shade(const SampleBuffer& samples, const CameraFrame& frame, std::span<const Color> colors,
                   const ShadeOptions& options) {
  if (Result<void> sound = CheckInput(samples, options); !sound.ok()) return sound.error();
  const Shading shading(frame, colors, options);
  Film film;
  film.width = samples.width;
  film.height = samples.height;
  film.pixels.resize(samples.size());
  const std::size_t width = static_cast<std::size_t>(samples.width);
  std::atomic<std::size_t> bad{kNoPixel};
  RunWithThreads(options.execution.threads, [&] {
    ParallelFor(0, samples.height, [&](int y) {
      const std::size_t first = static_cast<std::size_t>(y) * width;
      const auto place = [&](std::size_t i) { return Vec2{static_cast<double>(i - first) + 0.5, y + 0.5}; };
      KeepFirst(ShadeOf(shading, samples, first, first + width, place, &film.pixels[first]), &bad);
    });
    if (bad.load() == kNoPixel && options.edges) DrawEdges(samples, frame, options, film);
  });
  if (bad.load() != kNoPixel) return NotFinite(bad.load() % width, bad.load() / width);
  return film;
}

Result<void> ShadeRefinement(const Refinement& refinement, std::span<const Color> colors,
                             const ShadeOptions& options, Film* film) {
  const PixelSet& set = refinement.pixels;
  const int count = refinement.grid.count();
  if (film->width != set.width() || film->height != set.height() || count < 1 ||
      refinement.samples.size() != set.size() * static_cast<std::size_t>(count))
    return Error{ErrorCode::kSizeMismatch, "the refined samples do not belong to the film"};
  if (Result<void> light = CheckLight(refinement.samples, options); !light.ok()) return light.error();
  const Shading shading(refinement.frame, colors, options);
  const float share = 1.0f / static_cast<float>(count);
  std::atomic<std::size_t> bad{kNoPixel};
  constexpr std::size_t kBlock = 256;  // pixels
  RunWithThreads(options.execution.threads, [&] {
    ParallelForBlocks(0, set.size(), kBlock, [&](std::size_t first, std::size_t last) {
      const std::size_t first_sample = first * static_cast<std::size_t>(count),
                        last_sample = last * static_cast<std::size_t>(count);
      std::vector<std::array<float, 4>> light(last_sample - first_sample);
      const auto place = [&](std::size_t i) {
        const SamplePlace at =
            PlaceOfSample(set.pixels()[i / static_cast<std::size_t>(count)], set.width(), refinement.grid,
                          static_cast<int>(i % static_cast<std::size_t>(count)));
        return Vec2{at.column + 0.5, at.row + 0.5};
      };
      KeepFirst(ShadeOf(shading, refinement.samples, first_sample, last_sample, place, light.data()), &bad);
      for (std::size_t k = first; k < last; ++k) {
        // As Resolve does: the sum of a pixel's samples, row by row, times their share.
        std::array<float, 4> sum = {0, 0, 0, 0};
        for (int j = 0; j < count; ++j) {
          const auto& sample =
              light[(k - first) * static_cast<std::size_t>(count) + static_cast<std::size_t>(j)];
          for (int c = 0; c < 4; ++c) sum[c] += sample[c];
        }
        for (float& c : sum) c *= share;
        film->pixels[set.pixels()[k]] = sum;
      }
    });
  });
  if (bad.load() == kNoPixel) return {};
  const std::uint32_t pixel = set.pixels()[bad.load() / static_cast<std::size_t>(count)];
  const auto width = static_cast<std::uint32_t>(set.width());
  return NotFinite(pixel % width, pixel / width);
}

std::array<float, 4> BackgroundLight(Background background) {
  if (background == Background::kTransparent) return {0, 0, 0, 0};
  const Vec3 room = StudioBackground();
  return {static_cast<float>(room.x), static_cast<float>(room.y), static_cast<float>(room.z), 1.0f};
}

void HatchCap(const ShadeOptions& options, std::uint32_t face, double x, double y,
              std::array<float, 4>* pixel) {
  if (face < options.first_cap || face == kNoIndex) return;
  const std::uint32_t solid = (face - options.first_cap) % options.cap_stride;
  const float cover = HatchCover(x / options.samples_x, y / options.samples_y, solid);
  const float line = HatchLight(((*pixel)[0] + (*pixel)[1] + (*pixel)[2]) / 3);
  for (int c = 0; c < 3; ++c) (*pixel)[c] += cover * (line - (*pixel)[c]);
}

void DrawFeatureEdges(const SampleBuffer& samples, const CameraFrame& frame, const ShadeOptions& options,
                      Film& film) {
  RunWithThreads(options.execution.threads, [&] { DrawEdges(samples, frame, options, film); });
}

}  // namespace facetless

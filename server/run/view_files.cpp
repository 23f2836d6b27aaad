#include "server/run/view_files.h"

#include <utility>

#include "render/base/parallel.h"
#include "render/base/stopwatch.h"
#include "render/image/io.h"
#include "render/shade/certificate_map.h"
#include "server/base/files.h"

namespace facetless {

void ViewFiles::Png(const std::string& role, const Image8& image) {
  Add(role, ".png", [&image](const std::string& path) { return WritePng(path, image); });
}

void ViewFiles::Depth(const std::string& role, const SampleBuffer& samples) {
  Add(role, ".tif", [&samples](const std::string& path) {
    return WriteDepth(path, samples.width, samples.height, samples.depth);
  });
}

void ViewFiles::Inspection(const std::optional<InspectionView>& inspection, const SampleBuffer& samples) {
  if (!inspection) return;
  if (Image8 legend = DrawLegend(*inspection, samples.width); legend.width > 0)
    Add("legend", ".png",
        [legend = std::move(legend)](const std::string& path) { return WritePng(path, legend); });
  if (!inspection->values.empty())
    Add("inspection", ".tif", [&inspection, &samples](const std::string& path) {
      return WriteDepth(path, samples.width, samples.height, inspection->values);
    });
}

void ViewFiles::Svg(const std::string& role, std::string svg) {
  Add(role, ".svg",
      [svg = std::move(svg)](const std::string& path) { return WriteFileAtomically(path, svg); });
}

void ViewFiles::Pixels(const PixelData& data, const std::string& candidate) {
  for (std::size_t i = 0; i < kPixelPlanes; ++i) {
    const PixelPlane which{static_cast<std::uint8_t>(i)};
    if (!candidate.empty() && !IsOfCandidate(which)) continue;
    Add((candidate.empty() ? "" : candidate + "-") + PixelPlaneName(which), ".png",
        [&plane = data.planes[i]](const std::string& path) { return WriteDataPng(path, plane); });
  }
}

void ViewFiles::Aovs(const SampleBuffer& samples, const RunOptions& options) {
  AovSelection wanted;
  wanted.depth = options.WantsAov("depth");
  wanted.normal = options.WantsAov("normal");
  wanted.face = options.WantsAov("face");
  wanted.uv = options.WantsAov("uv");
  wanted.certificate = options.WantsAov("certificate");
  if (!options.aovs.empty())
    Add("aov", ".exr",
        [&samples, wanted](const std::string& path) { return WriteAovs(path, samples, wanted); });
  if (wanted.certificate)
    Add("certificate", ".png",
        [&samples](const std::string& path) { return WritePng(path, DrawCertificates(samples).image); });
}

Result<void> ViewFiles::Write(nlohmann::json& view, int threads, RunFiles& left) const {
  const Stopwatch stopwatch;
  std::vector<Result<void>> written(files_.size());
  RunWithThreads(threads, [&] {
    ParallelFor(std::size_t{0}, files_.size(),
                [&](std::size_t i) { written[i] = files_[i].write(directory_ + "/" + files_[i].name); });
  });
  for (const Result<void>& result : written)
    if (!result) return result.error();
  for (const File& file : files_) left.Add(view_, file.role, file.name);
  view["files"] = left.Json(view_);
  view["timing_ms"]["files"] = stopwatch.Milliseconds();
  return {};
}

void ViewFiles::Add(const std::string& role, const char* extension,
                    std::function<Result<void>(const std::string& path)> write) {
  files_.push_back({role, view_ + "." + role + extension, std::move(write)});
}

}  // namespace facetless

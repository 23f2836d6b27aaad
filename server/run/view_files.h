// Writes the files of one view, all together and in parallel.
//
//  1. Data that is passed by reference must exist until Write returns.
//  2. A file's name is VIEW.ROLE.EXTENSION; each is replaced as a whole, or not at all.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "render/compare/pixel_data.h"
#include "render/image/film.h"
#include "render/inspect/picture.h"
#include "render/view/samples.h"
#include "server/options/options.h"
#include "server/run/run_result.h"

namespace facetless {

class ViewFiles {
 public:
  ViewFiles(const std::string& directory, const std::string& view) : directory_(directory), view_(view) {}

  void Png(const std::string& role, const Image8& image);
  void Depth(const std::string& role, const SampleBuffer& samples);
  // Adds the legend and the numbers.
  void Inspection(const std::optional<InspectionView>& inspection, const SampleBuffer& samples);
  void Svg(const std::string& role, std::string svg);
  // Adds one file for each plane. For further candidates, only the planes that depend on the candidate are
  // added, under its name.
  void Pixels(const PixelData& data, const std::string& candidate);
  // Adds the requested AOVs as one EXR file, and a picture of the certificates if they are requested. Depth()
  // adds the depth in double precision.
  void Aovs(const SampleBuffer& samples, const RunOptions& options);

  // Adds the files to `left`, and "files", a name by role, and timing_ms.files to the view's entry of the
  // report. Errors: those of the writers.
  Result<void> Write(nlohmann::json& view, int threads, RunFiles& left) const;

 private:
  struct File {
    std::string role, name;
    std::function<Result<void>(const std::string& path)> write;
  };
  void Add(const std::string& role, const char* extension,
           std::function<Result<void>(const std::string& path)> write);

  std::string directory_, view_;
  std::vector<File> files_;
};

}  // namespace facetless

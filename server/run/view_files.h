// One view's files, written all at once and in parallel.
//
//  1. What is handed over by reference must live until Write returns.
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
  // The legend, and the numbers as they are.
  void Inspection(const std::optional<InspectionView>& inspection, const SampleBuffer& samples);
  void Svg(const std::string& role, std::string svg);
  // One file for each plane; of a further candidate those planes that are its own, under its name.
  void Pixels(const PixelData& data, const std::string& candidate);
  // The AOVs that are asked for. The depth is a file of its own already, in double.
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

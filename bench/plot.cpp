#include "bench/plot.h"

#include <algorithm>
#include <cmath>

#include "bench/svg.h"
#include "bench/table.h"

namespace facetless {
namespace {

constexpr double kWidth = 960, kLeft = 250, kRight = 110, kTop = 86, kRow = 56, kBar = 14, kFoot = 40;
constexpr const char* kColors[] = {"#126690", "#cc5c0d", "#e9a873"};
constexpr const char* kNames[] = {"direct, exact", "mesh at 1e-3", "mesh at 1e-5"};

struct Bars {
  std::string name;
  double ms[3] = {0, 0, 0};  // 0: not measured
  bool at_limit = false;     // the mesher of the last bar was stopped at the time limit
};

std::vector<Bars> Collect(const std::vector<BenchValue>& values, int threads) {
  std::vector<Bars> all;
  for (const BenchValue& value : values) {
    const bool coarse = value.aim == "first_image_default_mesh", fine = value.aim == "first_image_fine_mesh";
    if ((!coarse && !fine) || value.threads != threads || !value.skipped.empty()) continue;
    const std::string name = value.file + " " + value.view;
    auto bars = std::find_if(all.begin(), all.end(), [&](const Bars& b) { return b.name == name; });
    if (bars == all.end()) {
      all.emplace_back();
      bars = all.end() - 1;
      bars->name = name;
    }
    bars->ms[0] = value.direct;
    bars->ms[coarse ? 1 : 2] = value.other;
    if (fine) bars->at_limit = value.at_limit;
  }
  return all;
}

}  // namespace

std::string FirstImagePlot(const std::vector<BenchValue>& values, int threads) {
  const std::vector<Bars> all = Collect(values, threads);
  double low = INFINITY, high = 0;
  for (const Bars& bars : all)
    for (const double ms : bars.ms)
      if (ms > 0) low = std::min(low, ms), high = std::max(high, ms);
  const double first = all.empty() ? 0 : std::floor(std::log10(low) - 0.01),
               last = all.empty() ? 1 : std::ceil(std::log10(high));
  const double height = kTop + kRow * static_cast<double>(std::max<std::size_t>(all.size(), 1)) + kFoot;
  const auto at = [&](double ms) {
    return kLeft + (std::log10(ms) - first) / (last - first) * (kWidth - kLeft - kRight);
  };

  std::string svg;
  double x = 24;
  for (int i = 0; i < 3; ++i, x += 150)
    svg += SvgBox(x, 50, 12, 12, kColors[i]) + SvgText(x + 18, 61, "start", 13, kNames[i]);
  if (all.empty()) svg += SvgText(24, kTop + 24, "start", 13, "No file was measured.");
  for (double power = first; !all.empty() && power <= last; ++power) {
    const double line = at(std::pow(10, power));
    svg += SvgBox(line, kTop, 1, height - kTop - kFoot, "#dddddb") +
           SvgText(line, height - kFoot + 18, "middle", 12, MillisecondsText(std::pow(10, power)));
  }
  for (std::size_t k = 0; k < all.size(); ++k) {
    const double y = kTop + kRow * static_cast<double>(k) + 6;
    svg += SvgText(kLeft - 10, y + 27, "end", 12, all[k].name);
    for (int i = 0; i < 3; ++i) {
      if (!(all[k].ms[i] > 0)) continue;
      const double end = at(all[k].ms[i]), top = y + kBar * i;
      svg += SvgBox(kLeft, top, end - kLeft, kBar - 2, kColors[i]) +
             SvgText(end + 5, top + 10, "start", 11,
                     (i == 2 && all[k].at_limit ? "> " : "") + MillisecondsText(all[k].ms[i]));
    }
  }
  return SvgPicture(
      kWidth, height,
      "Time to the first image, " + std::to_string(threads) + (threads == 1 ? " thread" : " threads"), svg);
}

}  // namespace facetless

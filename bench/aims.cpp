#include "bench/aims.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "bench/statistics.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

// The error of a measured exponent. Times of a few milliseconds differ by a few per cent from run to run.
constexpr double kSlopeError = 0.05;

std::string ValueText(double value, ValueUnit unit) {
  switch (unit) {
    case ValueUnit::kMilliseconds:
      return MillisecondsText(value);
    case ValueUnit::kRaysPerSecond:
      return RateText(value);
    case ValueUnit::kBytes:
      return BytesText(value);
    case ValueUnit::kNone:
      break;
  }
  return ThreeDigits(value);
}

const char* UnitName(ValueUnit unit) {
  switch (unit) {
    case ValueUnit::kMilliseconds:
      return "ms";
    case ValueUnit::kRaysPerSecond:
      return "rays/s";
    case ValueUnit::kBytes:
      return "bytes";
    case ValueUnit::kNone:
      break;
  }
  return "";
}

std::string RatioText(const Aim& aim, double ratio) {
  return aim.kind == AimKind::kAtLeast ? TimesText(ratio) : ThreeDigits(ratio);
}

bool Meets(const Aim& aim, double mean, double worst) {
  if (aim.kind == AimKind::kAtLeast)
    return mean >= aim.mean.value_or(-INFINITY) && worst >= aim.each.value_or(-INFINITY);
  return mean <= aim.mean.value_or(INFINITY) && worst <= aim.each.value_or(INFINITY);
}

using enum AimKind;

constexpr Aim kAims[] = {
    {"first_image_default_mesh", "1", "first exact image: prepare, trace, shade",
     "mesh at 1e-3 of the diagonal: mesh, tree, trace, shade", "2× on average, never below 0.67×", kAtLeast,
     2.0, 1 / 1.5},
    {"first_image_fine_mesh", "2", "first exact image", "mesh at 1e-5, the same",
     "50× on average, never below 8×", kAtLeast, 50.0, 8.0},
    {"trace_fine_mesh",
     "3",
     "tracing alone, standard",
     "Embree, packets of 16, on the mesh at 1e-5",
     "1.5×",
     kAtLeast,
     1.5,
     {}},
    {"trace_default_mesh",
     "4",
     "tracing alone, standard",
     "Embree on the mesh at 1e-3",
     "0.7×",
     kAtLeast,
     0.7,
     {}},
    {"trace_fine_mesh_raw",
     "3 raw",
     "tracing alone, standard",
     "Embree on the mesh at 1e-5, float32 distance and triangle only",
     "1.5×",
     kAtLeast,
     1.5,
     {}},
    {"trace_default_mesh_raw",
     "4 raw",
     "tracing alone, standard",
     "Embree on the mesh at 1e-3, float32 distance and triangle only",
     "1×",
     kAtLeast,
     1.0,
     {}},
    {"trace_default_mesh_fast",
     "4 fast",
     "tracing alone, fast",
     "Embree on the mesh at 1e-3",
     "1.2×",
     kAtLeast,
     1.2,
     {}},
    {"trace_exact_intersector",
     "5",
     "tracing alone, standard",
     "OpenCASCADE's exact intersector",
     "500×",
     kAtLeast,
     500.0,
     {}},
    {"next_view", "6", "next view of a prepared model", "its first view", "at most 0.5", kAtMost, 0.5, {}},
    {"memory",
     "7",
     "peak memory of the image, its buffers included",
     "the same of the mesh at 1e-5 and its tree",
     "at most 0.2",
     kAtMost,
     0.2,
     {}},
    {"memory_structures",
     "7 alone",
     "leaves, bitmaps and trimming, without buffers",
     "mesh at 1e-5 and its tree",
     "at most 0.2",
     kAtMost,
     0.2,
     {}},
    {"two_cores", "8", "first exact image on two cores", "on one", "1.9×", kAtLeast, 1.9, {}},
    {"growth_image",
     "9 image",
     "time from 256² to 4096² pixels",
     "power of the number of rays",
     "at most 1",
     kAtMost,
     {},
     1 + kSlopeError},
    {"growth_faces",
     "9 faces",
     "time from 10² to 10⁵ faces",
     "power of the number of leaves",
     "at most 1",
     kAtMost,
     {},
     1 + kSlopeError},
    {"import",
     "10",
     "import into a model, without a mesh, CPU time",
     "OpenCASCADE's read and transfer with its default healing, CPU time",
     "none",
     kAtLeast,
     {},
     {}},
    {"import_unhealed",
     "10 unhealed",
     "import into a model, without a mesh, CPU time",
     "OpenCASCADE's read and transfer without healing, CPU time",
     "none",
     kAtLeast,
     {},
     {}},
    {"samples",
     "11",
     "exact picture with the default number of samples per pixel",
     "the same with one sample per pixel",
     "at most 1.3",
     kAtMost,
     1.3,
     {}},
};

}  // namespace

const std::vector<Aim>& Aims() {
  static const std::vector<Aim> aims(std::begin(kAims), std::end(kAims));
  return aims;
}

const Aim& FindAim(const std::string& id) {
  return *std::find_if(Aims().begin(), Aims().end(), [&](const Aim& aim) { return id == aim.id; });
}

std::vector<AimSummary> Summarise(const std::vector<BenchValue>& values) {
  std::vector<AimSummary> summaries;
  for (const Aim& aim : Aims()) {
    std::set<int> threads;
    for (const BenchValue& value : values)
      if (value.aim == aim.id && value.skipped.empty()) threads.insert(value.threads);
    for (const int count : threads) {
      AimSummary summary;
      summary.aim = &aim;
      summary.threads = count;
      std::vector<double> ratios;
      for (const BenchValue& value : values) {
        if (value.aim != aim.id || value.threads != count || !value.skipped.empty()) continue;
        const bool worse = ratios.empty() || (aim.kind == AimKind::kAtLeast ? value.ratio < summary.worst
                                                                            : value.ratio > summary.worst);
        if (worse) {
          summary.worst = value.ratio;
          summary.worst_file = value.file;
        }
        ratios.push_back(value.ratio);
      }
      summary.values = static_cast<int>(ratios.size());
      summary.mean = GeometricMean(ratios);
      summary.met = Meets(aim, summary.mean, summary.worst);
      summaries.push_back(summary);
    }
  }
  return summaries;
}

Table AimTable(const std::vector<BenchValue>& values) {
  Table table;
  table.title = "Aims";
  table.columns = {"row", "what", "against", "aim", "threads", "geometric mean", "worst", "of", "met"};
  for (const AimSummary& summary : Summarise(values)) {
    const Aim& aim = *summary.aim;
    table.rows.push_back({aim.number, aim.what, aim.against, aim.text, std::to_string(summary.threads),
                          RatioText(aim, summary.mean), RatioText(aim, summary.worst), summary.worst_file,
                          aim.IsComparisonAlone() ? "-"
                          : summary.met           ? "yes"
                                                  : "no"});
  }
  return table;
}

Table ValueTable(const std::vector<BenchValue>& values) {
  Table table;
  table.title = "Each file";
  table.columns = {"row", "file", "view", "threads", "direct", "other", "ratio", "runs"};
  bool limited = false;
  for (const Aim& aim : Aims()) {
    for (const BenchValue& value : values) {
      if (value.aim != aim.id) continue;
      if (!value.skipped.empty()) {
        table.rows.push_back(
            {aim.number, value.file, value.view, std::to_string(value.threads), "-", "-", "-", "-"});
        table.notes.push_back(std::string("Row ") + aim.number + ", " + value.file + ": " + value.skipped +
                              ".");
        continue;
      }
      limited = limited || value.at_limit;
      table.rows.push_back({aim.number, value.file, value.view, std::to_string(value.threads),
                            ValueText(value.direct, value.unit),
                            (value.at_limit ? "> " : "") + ValueText(value.other, value.unit),
                            (value.at_limit ? "> " : "") + RatioText(aim, value.ratio),
                            std::to_string(value.repetitions)});
    }
  }
  if (limited)
    table.notes.push_back(
        "\">\": the mesher was stopped at the time limit, and the mesh counts at that limit.");
  return table;
}

Json ValueJson(const BenchValue& value) {
  Json json = {{"row", value.aim}, {"file", value.file}, {"view", value.view}, {"threads", value.threads}};
  if (!value.skipped.empty()) {
    json["skipped"] = value.skipped;
    return json;
  }
  json.update({{"direct", value.direct},
               {"other", value.other},
               {"unit", UnitName(value.unit)},
               {"ratio", value.ratio},
               {"repetitions", value.repetitions},
               {"at_limit", value.at_limit}});
  return json;
}

Json SummaryJson(const AimSummary& summary) {
  const Aim& aim = *summary.aim;
  const auto number = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  return {{"row", aim.id},
          {"number", aim.number},
          {"what", aim.what},
          {"against", aim.against},
          {"aim",
           {{"text", aim.text},
            {"at_most", aim.kind == AimKind::kAtMost},
            {"mean", number(aim.mean)},
            {"each", number(aim.each)}}},
          {"threads", summary.threads},
          {"values", summary.values},
          {"geometric_mean", summary.mean},
          {"worst", summary.worst},
          {"worst_file", summary.worst_file},
          {"met", aim.IsComparisonAlone() ? Json(nullptr) : Json(summary.met)}};
}

}  // namespace facetless

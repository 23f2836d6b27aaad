#include "server/run/bench_import.h"

#include <sys/resource.h>

#include <utility>

#include "bench/statistics.h"
#include "server/importer/plain_read.h"

namespace facetless {
namespace {

// Returns the processor time that all children of this process took that have ended, in ms.
double ChildrenCpuMs() {
  rusage usage = {};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto ms = [](const timeval& time) {
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-3 * static_cast<double>(time.tv_usec);
  };
  return ms(usage.ru_utime) + ms(usage.ru_stime);
}

// OpenCASCADE's reader in one configuration.
struct PlainReader {
  const char* aim;
  PlainHealing healing;
  std::vector<double> cpu_ms;
  std::string failure;  // empty: it can read the file
};

}  // namespace

Result<std::vector<BenchValue>> MeasureImport(const std::string& name, const ImportRequest& request,
                                              int repeats) {
  std::vector<double> ours;
  std::vector<PlainReader> readers = {{"import", PlainHealing::kDefault, {}, {}},
                                      {"import_unhealed", PlainHealing::kNone, {}, {}}};
  for (int round = 0; round <= repeats; ++round) {
    const double before_ms = ChildrenCpuMs();
    const auto files = RunImporter(request);
    if (!files) return files.error();
    if (round > 0) ours.push_back(ChildrenCpuMs() - before_ms);
    for (PlainReader& reader : readers) {
      if (!reader.failure.empty()) continue;
      const double reader_before_ms = ChildrenCpuMs();
      const auto read = ReadPlainly(request, reader.healing);
      if (!read && read.error().code == ErrorCode::kCancelled) return read.error();
      if (!read) {
        reader.failure = read.error().message;
      } else if (round > 0) {
        reader.cpu_ms.push_back(ChildrenCpuMs() - reader_before_ms);
      }
    }
  }

  std::vector<BenchValue> values;
  for (const PlainReader& reader : readers) {
    BenchValue value;
    value.aim = reader.aim;
    value.file = name;
    value.view = "-";
    value.unit = ValueUnit::kMilliseconds;
    value.skipped = reader.failure;
    if (reader.failure.empty()) {
      value.direct = Median(ours);
      value.other = Median(reader.cpu_ms);
      value.ratio = MedianRatio(reader.cpu_ms, ours);
      value.repetitions = repeats;
    }
    values.push_back(std::move(value));
  }
  return values;
}

}  // namespace facetless

#include "server/service/http/metrics.h"

#include <prometheus/counter.h>
#include <prometheus/family.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <algorithm>
#include <iterator>
#include <string_view>

#include "server/base/version.h"

namespace facetless {
namespace {

using prometheus::BuildCounter;
using prometheus::BuildGauge;
using prometheus::BuildHistogram;
using prometheus::Counter;
using prometheus::Family;
using prometheus::Gauge;
using prometheus::Histogram;

// Buckets from a millisecond, for a look-up, to the longest time that a request may wait for a job.
const Histogram::BucketBoundaries kRequestSeconds = {0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25,
                                                     0.5,   1,      2.5,   5,    10,    30,   100, 300};
const Histogram::BucketBoundaries kWorkSeconds = {0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30, 100, 300, 1000};
// Buckets from the speed of an exact intersector on one core to that of a large machine with a small model.
const Histogram::BucketBoundaries kRaysPerSecond = {1e4, 3e4, 1e5, 3e5, 1e6, 3e6, 1e7, 3e7, 1e8, 3e8};

template <std::size_t N>
std::string KnownOr(const char* other, const std::string_view (&known)[N], const std::string& word) {
  return std::find(std::begin(known), std::end(known), word) == std::end(known) ? other : word;
}

std::string MethodLabel(const std::string& method) {
  static constexpr std::string_view kKnown[] = {"GET", "HEAD", "POST", "DELETE", "PUT", "PATCH", "OPTIONS"};
  return KnownOr("other", kKnown, method);
}

// The label of a stage: a stage of the importer, of a run or of a job.
std::string StageLabel(const std::string& stage) {
  static constexpr std::string_view kKnown[] = {"starting",  "read",      "transfer", "convert",
                                                "mesh",      "intersect", "render",   "compare",
                                                "reference", "direct",    "meshes",   "publish"};
  return KnownOr("other", kKnown, stage);
}

}  // namespace

struct Metrics::Families {
  Family<Counter>& AddCounter(const char* name, const char* help) {
    return BuildCounter().Name(name).Help(help).Register(registry);
  }
  Family<Gauge>& AddGauge(const char* name, const char* help) {
    return BuildGauge().Name(name).Help(help).Register(registry);
  }
  Family<Histogram>& AddHistogram(const char* name, const char* help) {
    return BuildHistogram().Name(name).Help(help).Register(registry);
  }

  prometheus::Registry registry;
  Family<Counter>& requests =
      AddCounter("facetless_http_requests_total", "Requests by route, method and status");
  Family<Histogram>& request_seconds =
      AddHistogram("facetless_http_request_duration_seconds",
                   "Seconds from a request's head to its response, waiting for a job included");
  Family<Counter>& jobs = AddCounter("facetless_jobs_ended_total", "Jobs that ended, by kind and state");
  Family<Histogram>& job_seconds =
      AddHistogram("facetless_job_duration_seconds", "Seconds that jobs ran, by kind");
  Family<Histogram>& stage_seconds =
      AddHistogram("facetless_job_stage_duration_seconds", "Seconds of each stage of jobs");
  Family<Counter>& rays = AddCounter("facetless_rays_total", "Rays that the direct renderer traced for jobs");
  Family<Counter>& trace_seconds =
      AddCounter("facetless_trace_seconds_total", "Seconds that the direct renderer took for them");
  Family<Histogram>& rays_per_second =
      AddHistogram("facetless_rays_per_second", "Rays per second of each view of the direct renderer");
  Family<Histogram>& model_seconds = AddHistogram(
      "facetless_model_read_duration_seconds", "Seconds of reading a model's file, at most once for a job");
  Family<Counter>& importers = AddCounter(
      "facetless_importers_total", "Importers that ended, by start: forked by the loaded one, or executed");
  Family<Counter>& deaths =
      AddCounter("facetless_importer_deaths_total", "Importers that did not end by themselves, by cause");
  Family<Counter>& look_ups =
      AddCounter("facetless_cache_lookups_total", "Questions by kind, and whether the answer was there");
  Family<Gauge>& ready = AddGauge("facetless_ready", "1 if /readyz says so");
  Family<Gauge>& waiting = AddGauge("facetless_jobs_waiting", "Jobs in the queue");
  Family<Gauge>& running = AddGauge("facetless_jobs_running", "Jobs that run");
  Family<Gauge>& store_bytes = AddGauge("facetless_store_bytes", "Bytes of all files that are kept");
};

Metrics::Metrics() : families_(std::make_unique<Families>()) {
  families_->AddGauge("facetless_build_info", "1; the version is a label")
      .Add({{"version", Version()}})
      .Set(1);
  // Create these series at the start, so that a rate includes the first event.
  for (const char* start : {"forked", "executed"}) families_->importers.Add({{"start", start}});
  for (const char* cause : {"crash", "timeout", "memory", "output", "threads", "answer"})
    families_->deaths.Add({{"cause", cause}});
  for (const JobKindRow& kind : JobKinds()) {
    for (const char* result : {"hit", "miss"})
      families_->look_ups.Add({{"kind", kind.name}, {"result", result}});
    for (const char* state : {"done", "failed", "cancelled"})
      families_->jobs.Add({{"kind", kind.name}, {"state", state}});
  }
  families_->rays.Add({});
  families_->trace_seconds.Add({});
  families_->model_seconds.Add({}, kWorkSeconds);
}

Metrics::~Metrics() = default;

void Metrics::RequestServed(const std::string& route, const std::string& method, int status, double seconds) {
  const std::string known = MethodLabel(method);
  families_->requests.Add({{"route", route}, {"method", known}, {"status", std::to_string(status)}})
      .Increment();
  families_->request_seconds.Add({{"route", route}, {"method", known}}, kRequestSeconds).Observe(seconds);
}

void Metrics::JobEnded(JobKind kind, const std::string& state, double seconds) {
  families_->jobs.Add({{"kind", JobKindName(kind)}, {"state", state}}).Increment();
  if (seconds > 0) families_->job_seconds.Add({{"kind", JobKindName(kind)}}, kWorkSeconds).Observe(seconds);
}

void Metrics::StageEnded(const std::string& stage, double seconds) {
  families_->stage_seconds.Add({{"stage", StageLabel(stage)}}, kWorkSeconds).Observe(seconds);
}

void Metrics::Traced(double rays, double seconds) {
  families_->rays.Add({}).Increment(rays);
  families_->trace_seconds.Add({}).Increment(seconds);
  if (seconds > 0) families_->rays_per_second.Add({}, kRaysPerSecond).Observe(rays / seconds);
}

void Metrics::ModelRead(double seconds) {
  families_->model_seconds.Add({}, kWorkSeconds).Observe(seconds);
}

void Metrics::ImporterEnded(bool forked) {
  families_->importers.Add({{"start", forked ? "forked" : "executed"}}).Increment();
}

void Metrics::ImporterDied(const std::string& cause) {
  families_->deaths.Add({{"cause", cause}}).Increment();
}

void Metrics::LookedUp(JobKind kind, bool found) {
  families_->look_ups.Add({{"kind", JobKindName(kind)}, {"result", found ? "hit" : "miss"}}).Increment();
}

std::string Metrics::Text(const MetricsNow& now) {
  families_->ready.Add({}).Set(now.ready ? 1 : 0);
  families_->waiting.Add({}).Set(now.jobs_waiting);
  families_->running.Add({}).Set(now.jobs_running);
  families_->store_bytes.Add({}).Set(static_cast<double>(now.store_bytes));
  return prometheus::TextSerializer().Serialize(families_->registry.Collect());
}

}  // namespace facetless

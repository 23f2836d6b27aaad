// The responses of the service, as JSON and as event streams. docs/api.md is the contract.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "server/service/jobs/jobs.h"
#include "server/service/protocol/message.h"
#include "server/service/store/store.h"

namespace facetless {

// The time as text, such as "2026-11-22T11:43:19.123Z", from seconds since 1970; null for 0.
nlohmann::json TimeJson(double seconds);

HttpResponse JsonResponse(int status, const nlohmann::json& json);
// A response whose text is JSON already.
HttpResponse JsonTextResponse(int status, std::string text);

nlohmann::json ModelJson(const StoredModel& model);

// A job in a list: JobJson without the result.
nlohmann::json ListedJobJson(const JobView& view);

// A job for its caller. "result" is the answer in `store`, or null if the store has deleted it.
nlohmann::json JobJson(const JobView& view, Store& store);

// The answer of a job that is done, as text; nothing if the store has deleted it.
std::optional<std::string> AnswerText(const Job& job, Store& store);

// The response 202 for a job that is not done yet, with the address of the job.
HttpResponse AcceptedResponse(const JobView& view, Store& store);

// An event stream (text/event-stream) of a job until its end. `jobs` and `store` must outlive the response.
HttpResponse EventsResponse(Jobs& jobs, Store& store, const std::string& id);

}  // namespace facetless

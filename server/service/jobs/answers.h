// What the service says, as JSON and as events: docs/api.md is the contract.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "server/service/jobs/jobs.h"
#include "server/service/protocol/message.h"
#include "server/service/store/store.h"

namespace facetless {

// "2026-11-22T11:43:19.123Z" of seconds since 1970; null for 0.
nlohmann::json TimeJson(double seconds);

HttpResponse JsonResponse(int status, const nlohmann::json& json);
// Of a text that is JSON already.
HttpResponse JsonTextResponse(int status, std::string text);

nlohmann::json ModelJson(const StoredModel& model);

// A job of a list: JobJson without its result.
nlohmann::json ListedJobJson(const JobView& view);

// A job for its caller; "result" is what `store` has for it, null if that was given up.
nlohmann::json JobJson(const JobView& view, Store& store);

// The answer of a job that is done, as text; nothing if it was given up.
std::optional<std::string> AnswerText(const Job& job, Store& store);

// 202: it is not done yet, and here is where to look.
HttpResponse AcceptedResponse(const JobView& view, Store& store);

// text/event-stream of a job until its end. `jobs` and `store` must outlive the response.
HttpResponse EventsResponse(Jobs& jobs, Store& store, const std::string& id);

}  // namespace facetless

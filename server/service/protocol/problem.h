// Errors over HTTP: RFC 9457 `application/problem+json`.
//
// {"type": "urn:facetless:problem:<code>", "title", "status", "detail"}: type and status are stable, title
// and detail are for people. The codes are those of ErrorCodeName, and for what concerns HTTP itself
// not-found, method-not-allowed, payload-too-large, unauthorized, forbidden, rate-limited,
// unsupported-media-type, malformed-request, cross-site, request-timeout, busy, not-ready, timeout,
// cancelled, gave-up, key-reused and shutting-down; docs/api.md lists them. That of a job that failed has
// job_id, request_id and, if there was one, trace_id too: they are in the log.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "server/service/protocol/message.h"

namespace facetless {

HttpResponse Problem(int status, const std::string& code, const std::string& title,
                     const std::string& detail);

// A problem document that was kept, as a response again.
HttpResponse ProblemResponse(const nlohmann::json& document);

// For an error of a run: 422 where the input or the options are to blame, 507 where something cannot be
// stored, else 500.
HttpResponse ProblemOf(const Error& error);

// For a status that the transport itself answers with.
HttpResponse ProblemOfStatus(int status);

}  // namespace facetless

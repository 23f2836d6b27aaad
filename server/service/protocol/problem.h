// Errors in HTTP responses, as problem documents (RFC 9457, `application/problem+json`).
//
//     return Problem(404, "not-found", "Not found", "There is nothing at this address.");
//
// A problem document is {"type": "urn:facetless:problem:<code>", "title", "status", "detail"}. "type" and
// "status" are stable; "title" and "detail" are for users. The codes are those of ErrorCodeName, and for
// errors of HTTP itself not-found, method-not-allowed, payload-too-large, unauthorized, forbidden,
// rate-limited, unsupported-media-type, malformed-request, cross-site, request-timeout, busy, not-ready,
// timeout, cancelled, gave-up, key-reused and shutting-down; docs/api.md lists them. The document of a failed
// job also has job_id, request_id and, if there was one, trace_id, which are in the log, too.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "server/service/protocol/message.h"

namespace facetless {

HttpResponse Problem(int status, const std::string& code, const std::string& title,
                     const std::string& detail);

// The response for a stored problem document.
HttpResponse ProblemResponse(const nlohmann::json& document);

// The response for an error of a run: 422 if the input or the options caused it, 507 if something cannot be
// stored, and 500 otherwise.
HttpResponse ProblemForError(const Error& error);

// The response for a status that the transport itself reports.
HttpResponse ProblemForStatus(int status);

}  // namespace facetless

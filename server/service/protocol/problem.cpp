#include "server/service/protocol/problem.h"

#include <nlohmann/json.hpp>

#include "server/base/files.h"
#include "server/service/protocol/http_terms.h"

namespace facetless {
namespace {

const char* ErrorTitle(ErrorCode code) {
  switch (code) {
    case ErrorCode::kBadUsage:
      return "The options are wrong";
    case ErrorCode::kFileUnreadable:
      return "The file cannot be read";
    case ErrorCode::kFormatUnknown:
      return "The file is of no format that is read here";
    case ErrorCode::kFormatBroken:
      return "The file violates its own format";
    case ErrorCode::kNothingUsable:
      return "Nothing in the file can be rendered";
    case ErrorCode::kUnitMismatch:
      return "The mesh is of another size than the model";
    case ErrorCode::kLimitExceeded:
      return "A limit was exceeded";
    case ErrorCode::kImporterCrashed:
      return "The importer crashed on this file";
    case ErrorCode::kSizeMismatch:
      return "The images are of different sizes";
    case ErrorCode::kNotFinite:
      return "A number is not finite";
    case ErrorCode::kWriteFailed:
      return "The result cannot be stored";
    case ErrorCode::kCancelled:
      return "The request was stopped";
    case ErrorCode::kInternal:
      return "Internal error of the service";
  }
  return "Internal error of the service";
}

bool CallerIsToBlame(ErrorCode code) {
  switch (code) {
    case ErrorCode::kWriteFailed:
    case ErrorCode::kCancelled:
    case ErrorCode::kInternal:
      return false;
    default:
      return true;
  }
}

}  // namespace

HttpResponse Problem(int status, const std::string& code, const std::string& title,
                     const std::string& detail) {
  return ProblemResponse(
      {{"type", "urn:facetless:problem:" + code}, {"title", title}, {"status", status}, {"detail", detail}});
}

HttpResponse ProblemResponse(const nlohmann::json& document) {
  HttpResponse response;
  response.status = document.value("status", 500);
  response.content_type = "application/problem+json";
  response.body = JsonText(document) + "\n";
  return response;
}

HttpResponse ProblemForError(const Error& error) {
  const int status = error.code == ErrorCode::kWriteFailed ? 507 : CallerIsToBlame(error.code) ? 422 : 500;
  return Problem(status, ErrorCodeName(error.code), ErrorTitle(error.code),
                 TranslateToHttpTerms(error.message));
}

HttpResponse ProblemForStatus(int status) {
  switch (status) {
    case 404:
      return Problem(404, "not-found", "Not found", "There is nothing at this address.");
    case 405:
      return Problem(405, "method-not-allowed", "Method not allowed",
                     "This address does not support the method; see the Allow header.");
    case 408:
      return Problem(408, "request-timeout", "Request timeout", "The request took too long to arrive.");
    case 413:
      return Problem(413, "payload-too-large", "Payload too large", "The request's body is too large.");
    case 414:
      return Problem(414, "malformed-request", "URI too long", "The address is too long.");
    default:
      break;
  }
  if (status >= 500)
    return Problem(status, "internal", "Internal error of the service",
                   "The log of the service states the cause.");
  return Problem(status, "malformed-request", "Malformed request", "The request is not well-formed.");
}

}  // namespace facetless

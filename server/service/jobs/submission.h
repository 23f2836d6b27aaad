// Submissions: parsing a POST request, and computing its question.
//
//     Result<Submission> submission = ParseSubmission(request, "render", limits.max_samples);
//     if (!submission) return ProblemForError(submission.error());
//     job.question = submission.value().question;
//
//  1. The question is a digest of everything that determines the answer: kind, model, mesh, options, and the
//     version of the program. Equal questions have equal answers, except for times.
//  2. The job's request contains everything that is needed for the answer, so the job can run in another
//     process.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "server/options/options.h"
#include "server/service/jobs/job_kinds.h"
#include "server/service/protocol/message.h"

namespace facetless {

struct Submission {
  JobKind kind = JobKind::kModel;
  const BodyPart* file = nullptr;  // the model, if it was uploaded with the request
  const BodyPart* mesh = nullptr;
  std::string model_id;                               // id of the uploaded model, or of a stored model
  nlohmann::json options = nlohmann::json::object();  // the options as given
  nlohmann::json asked;  // the options in canonical form, however they were written
  std::string question;
  std::string body;  // digest of the submission as received, for Idempotency-Key
};

// Parses a request, which must outlive the result. Everything that can be checked without the model is
// checked. Errors: kBadUsage, kLimitExceeded (more than `max_samples` samples).
Result<Submission> ParseSubmission(const HttpRequest& request, JobKind kind, std::uint64_t max_samples);

// Checks the number of samples. Error: kLimitExceeded (the options need more than `most` samples).
Result<void> CheckSamples(const RunOptions& options, std::uint64_t most);

// The request of the job, {"model", "name"?, "mesh"?, "mesh_name"?, "options"}, which ParseJobRequest reads.
nlohmann::json JobRequestJson(const Submission& submission);

struct JobRequest {
  std::string model_id;
  std::string file_name;  // empty: the model was already stored when the job was submitted
  std::string mesh_name;  // file name of the posted mesh, sanitized
  std::string mesh;       // SHA-256 of the posted mesh; empty if there is none
  RunOptions options;
  bool budget_given = false;  // budget_seconds of a trade was given
};

// Parses the request of a job. Error: kInternal, because this program only makes well-formed requests.
Result<JobRequest> ParseJobRequest(const nlohmann::json& request);

// The seconds that the caller wants to wait for the end of a job, from the Prefer header (RFC 7240): the
// value of `wait`, 0 for respond-async without `wait`, or else `usual`; at most `most`.
double WaitSeconds(const std::string& prefer, double usual, double most);

}  // namespace facetless

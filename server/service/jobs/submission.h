// What a POST asks for: the one way from a request to a question.
//
//  1. The question is a digest of what decides the answer: kind, model, mesh, options, and the program's
//     version. Equal questions have equal answers, but for times.
//  2. The job's request holds all that is needed to answer, so that it can run in another process.
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
  std::string model_id;                               // of the upload, or of the model that is here already
  nlohmann::json options = nlohmann::json::object();  // as given
  nlohmann::json asked;  // what they ask for, in one form however they are written
  std::string question;
  std::string body;  // digest of the submission as it came, for Idempotency-Key
};

// `request` must outlive the answer. Errors: kBadUsage, kLimitExceeded (more than `max_samples`): whatever
// can be known without the model.
Result<Submission> ParseSubmission(const HttpRequest& request, JobKind kind, std::uint64_t max_samples);

// kLimitExceeded if `options` ask for more than `most` samples.
Result<void> CheckSamples(const RunOptions& options, std::uint64_t most);

// {"model", "name"?, "mesh"?, "mesh_name"?, "options"}: what ParseJobRequest reads.
nlohmann::json JobRequestJson(const Submission& submission);

struct JobRequest {
  std::string model_id;
  std::string file_name;  // empty: the model was there when the job was submitted
  std::string mesh_name;  // as it was posted, made safe
  std::string mesh;       // SHA-256 of a mesh that was posted; else empty
  RunOptions options;
  bool budget_given = false;  // a trade's budget_seconds
};

// Error: kInternal; a request of this program's own making is well-formed.
Result<JobRequest> ParseJobRequest(const nlohmann::json& request);

// Seconds that the caller waits for the end of a job: RFC 7240's `wait`, 0 for a bare respond-async, else
// `usual`; at most `most`.
double WaitSeconds(const std::string& prefer, double usual, double most);

}  // namespace facetless

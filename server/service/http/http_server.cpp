#include "server/service/http/http_server.h"

#include <fcntl.h>
#include <httplib.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <exception>
#include <thread>
#include <utility>

#include "render/base/stopwatch.h"
#include "server/base/sha256.h"
#include "server/service/http/worker_pool.h"
#include "server/service/jobs/job_store.h"
#include "server/service/protocol/problem.h"
#include "server/service/protocol/trace_context.h"

namespace facetless {
namespace {

using Clock = std::chrono::steady_clock;

// The limits of text parts, which are options and identifiers.
constexpr std::size_t kMaxTextBytes = 1 << 20;
constexpr std::size_t kMaxParts = 16;
constexpr const char* kRequestIdHeader = "X-Request-Id";
// The number of threads for uploads, pages and pictures, in addition to those for waiting requests and event
// streams.
constexpr int kSpareThreads = 32;
// The number of connections that may wait for a thread.
constexpr int kBacklog = 512;
// The number of threads for health and metrics. The second thread answers while the first waits for a slow
// client, and the time for slow clients is short.
constexpr int kOperationsThreads = 2;
constexpr int kPatienceSeconds = 30, kOperationsPatienceSeconds = 2;

// The task queue of the HTTP library. Each connection is one task, from its first byte to its last.
class Workers : public httplib::TaskQueue {
 public:
  explicit Workers(int threads) : pool_(threads) {}
  void enqueue(std::function<void()> task) override { pool_.Run(std::move(task)); }
  void shutdown() override { pool_.Shutdown(); }

 private:
  WorkerPool pool_;
};

HttpRequest Translated(const httplib::Request& request) {
  HttpRequest translated;
  translated.method = request.method;
  translated.path = request.path;
  for (const auto& [name, value] : request.headers) {
    std::string lower = name;
    for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    translated.headers.emplace(lower, value);
  }
  for (const auto& [name, value] : request.params) translated.query.emplace(name, value);
  translated.id = RandomId();
  translated.trace_id = ParseTraceId(translated.Header("traceparent"));
  return translated;
}

// A file that is open for reading as long as a response needs it.
class OpenFile {
 public:
  explicit OpenFile(const std::string& path) : fd_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
  ~OpenFile() {
    if (fd_ >= 0) close(fd_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  bool ok() const { return fd_ >= 0; }
  std::size_t Size() const {
    const off_t end = fd_ < 0 ? -1 : lseek(fd_, 0, SEEK_END);
    return end < 0 ? 0 : static_cast<std::size_t>(end);
  }
  // Sends up to `length` bytes from `offset`.
  bool Send(std::size_t offset, std::size_t length, httplib::DataSink& sink) const {
    char buffer[1 << 16];
    const ssize_t got = pread(fd_, buffer, std::min(length, sizeof buffer), static_cast<off_t>(offset));
    return got > 0 && sink.write(buffer, static_cast<std::size_t>(got));
  }

 private:
  int fd_;
};

void Apply(const HttpResponse& from, httplib::Response& to) {
  to.status = from.status;
  for (const auto& [name, value] : from.headers) to.set_header(name, value);
  if (from.stream) {
    to.set_chunked_content_provider(from.content_type,
                                    [next = from.stream](std::size_t, httplib::DataSink& sink) {
                                      const auto piece = next();
                                      if (piece) return sink.write(piece->data(), piece->size());
                                      sink.done();
                                      return true;
                                    });
    return;
  }
  if (from.file_path.empty()) {
    if (!from.body.empty()) to.set_content(from.body, from.content_type);
    return;
  }
  auto file = std::make_shared<OpenFile>(from.file_path);
  // The store has deleted the file since it was looked up.
  if (!file->ok()) {
    to.headers.clear();
    Apply(ProblemForStatus(404), to);
    return;
  }
  to.set_content_provider(file->Size(), from.content_type,
                          [file](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
                            return file->Send(offset, length, sink);
                          });
}

// Reads a request body, part by part.
class BodyReader {
 public:
  BodyReader(Service& service, HttpRequest& request)
      : service_(service),
        request_(request),
        end_(Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                std::chrono::duration<double>(service.limits().timeout_s))) {}
  ~BodyReader() { CloseFile(); }

  // Refuses the request. The rest of its body is read and discarded within the time limit, so that the client
  // receives the response instead of a broken connection.
  void Refuse(HttpResponse response) { refusal_ = std::move(response); }

  bool Begin(const std::string& name, const std::string& file_name, const std::string& content_type) {
    FinishPart();
    if (refusal_) return true;
    if (request_.parts.size() >= kMaxParts) {
      Refuse(ProblemForStatus(413));
      return true;
    }
    BodyPart part;
    part.name = name;
    part.file_name = file_name;
    part.content_type = content_type;
    const bool json_body = name.empty() && content_type.starts_with("application/json");
    if (name == "file" || name == "mesh" || (name.empty() && !json_body)) OpenPart(part);
    request_.parts.push_back(std::move(part));
    return true;
  }

  bool AppendBytes(const char* data, std::size_t size) {
    total_ += size;
    if (Clock::now() > end_) {
      if (!refusal_) Refuse(ProblemForStatus(408));
      return false;
    }
    if (!refusal_ && total_ > service_.limits().max_upload_bytes) Refuse(ProblemForStatus(413));
    if (refusal_) return true;
    BodyPart& part = request_.parts.back();
    part.bytes += size;
    if (part.path.empty()) {
      part.text.append(data, size);
      if (part.text.size() > kMaxTextBytes) Refuse(ProblemForStatus(413));
      return true;
    }
    sha_.Add(data, size);
    for (std::size_t done = 0; done < size;) {
      const ssize_t written = write(fd_, data + done, size - done);
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) {
        Refuse(ProblemForError(
            {ErrorCode::kWriteFailed, std::string("cannot store the upload: ") + std::strerror(errno)}));
        return true;
      }
      done += static_cast<std::size_t>(written);
    }
    return true;
  }

  // Ends the body, and returns the response if the request was refused. `complete`: the whole body was read.
  std::optional<HttpResponse> Finish(bool complete) {
    FinishPart();
    if (!refusal_ && !complete) Refuse(ProblemForStatus(400));
    return refusal_;
  }

 private:
  void OpenPart(BodyPart& part) {
    if (request_.uploads.path().empty()) {
      auto scratch = service_.store().Scratch();
      if (!scratch) {
        Refuse(ProblemForError({ErrorCode::kWriteFailed, "cannot store the upload"}));
        return;
      }
      request_.uploads = std::move(scratch).value();
    }
    part.path = request_.uploads.File("part" + std::to_string(request_.parts.size()));
    fd_ = open(part.path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (fd_ < 0) Refuse(ProblemForError({ErrorCode::kWriteFailed, "cannot store the upload"}));
    sha_ = Sha256();
  }
  void FinishPart() {
    if (fd_ < 0) return;
    request_.parts.back().sha256 = sha_.Hex();
    CloseFile();
  }
  void CloseFile() {
    if (fd_ >= 0) close(std::exchange(fd_, -1));
  }

  Service& service_;
  HttpRequest& request_;
  const Clock::time_point end_;
  std::optional<HttpResponse> refusal_;
  Sha256 sha_;
  int fd_ = -1;
  std::uint64_t total_ = 0;
};

// A request that asked for permission to send its body (Expect: 100-continue) and got it. Its handler is the
// next one on this thread, because a connection carries one request.
std::optional<HttpRequest>& Admitted() {
  thread_local std::optional<HttpRequest> request;
  return request;
}

HttpRequest TakeAdmitted(const httplib::Request& request) {
  std::optional<HttpRequest> admitted;
  admitted.swap(Admitted());
  return admitted ? std::move(*admitted) : Translated(request);
}

HttpResponse HandlePost(Service& service, const httplib::Request& request, HttpRequest& translated,
                        const httplib::ContentReader& content) {
  BodyReader body(service, translated);
  if (auto refusal = service.Check(translated)) body.Refuse(std::move(*refusal));
  const auto take = [&](const char* data, std::size_t size) { return body.AppendBytes(data, size); };
  bool complete = false;
  if (request.is_multipart_form_data()) {
    complete = content(
        [&](const httplib::MultipartFormData& part) {
          return body.Begin(part.name, part.filename, part.content_type);
        },
        take);
  } else {
    const auto name = translated.query.find("name");
    body.Begin("", name == translated.query.end() ? "" : name->second, translated.Header("content-type"));
    complete = content(take);
  }
  if (auto refusal = body.Finish(complete)) return *refusal;
  return service.Handle(translated);
}

}  // namespace

struct HttpServer::State {
  State(Service& s, const Listener& l) : service(s), listener(l) {}

  void SetLimits();
  void SetHandlers();
  void SetErrorHandlers();
  // Returns false if the address is not available.
  bool Bind();

  // Sends the response of `respond` to the request, and reports both.
  template <typename Respond>
  void Answer(const httplib::Request& request, httplib::Response& response, Respond respond) const;
  httplib::Server::HandlerResponse AnswerWithoutBody(const httplib::Request& request,
                                                     httplib::Response& response);
  // Returns the status with which to continue: 100, or that of the refusal.
  int AdmitBody(const httplib::Request& request, httplib::Response& response);

  Service& service;
  httplib::Server server;
  Listener listener;
  const HttpServer* owner = nullptr;  // has on_request
  std::atomic<bool> stopping{false}, ended{false};
};

void HttpServer::State::SetLimits() {
  // The payload limit of the library is disabled, because it does not cover chunked and compressed bodies;
  // BodyReader enforces the limit.
  const ServiceLimits& limits = service.limits();
  const int threads =
      listener.operations ? kOperationsThreads : limits.waiters + limits.listeners + kSpareThreads;
  const int patience = listener.operations ? kOperationsPatienceSeconds : kPatienceSeconds;
  server.new_task_queue = [threads] { return new Workers(threads); };
  server.set_keep_alive_max_count(1);
  server.set_read_timeout(patience, 0);
  server.set_write_timeout(patience, 0);
  if (listener.operations)
    server.set_keep_alive_timeout(patience);  // applies to the first request of a connection, too
  server.set_default_headers({{"X-Content-Type-Options", "nosniff"}, {"Referrer-Policy", "no-referrer"}});
}

template <typename Respond>
void HttpServer::State::Answer(const httplib::Request& request, httplib::Response& response,
                               Respond respond) const {
  const Stopwatch stopwatch;
  HttpRequest translated = TakeAdmitted(request);
  translated.operations = listener.operations;
  HttpResponse answer = ProblemForStatus(500);
  try {
    answer = respond(translated);
  } catch (const std::exception&) {
    // The message of the exception is not sent, because it may contain internal information.
  }
  Apply(answer, response);
  response.set_header(kRequestIdHeader, translated.id);
  if (!owner->on_request) return;
  const double ms = stopwatch.Milliseconds();
  owner->on_request({translated.id, translated.trace_id, request.method, request.path,
                     translated.caller.owner, answer.job, response.status, ms});
}

httplib::Server::HandlerResponse HttpServer::State::AnswerWithoutBody(const httplib::Request& request,
                                                                      httplib::Response& response) {
  // Wait for a body only if the address accepts POST.
  if (request.method == "POST" && !listener.operations) return httplib::Server::HandlerResponse::Unhandled;
  Answer(request, response, [&](HttpRequest& translated) {
    // Ignore ranges, which HTTP allows: the library does not check them against the file, and many ranges
    // would turn a small request into a large response. The request is an object of the library; it is
    // const only for handlers.
    const_cast<httplib::Request&>(request).ranges.clear();
    if (auto refusal = service.Check(translated)) return *refusal;
    return service.Handle(translated);
  });
  return httplib::Server::HandlerResponse::Handled;
}

int HttpServer::State::AdmitBody(const httplib::Request& request, httplib::Response& response) {
  HttpRequest translated = Translated(request);
  translated.operations = listener.operations;
  if (const auto refusal = service.Check(translated)) {
    Apply(*refusal, response);
    return response.status;
  }
  translated.admitted = true;
  Admitted() = std::move(translated);
  return 100;
}

// Uses one handler for methods without a body (the body of a DELETE is ignored), and one for methods with a
// body.
void HttpServer::State::SetHandlers() {
  server.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
    return AnswerWithoutBody(request, response);
  });
  server.Post("/.*", [this](const httplib::Request& request, httplib::Response& response,
                            const httplib::ContentReader& content) {
    Answer(request, response,
           [&](HttpRequest& translated) { return HandlePost(service, request, translated, content); });
  });
  server.set_expect_100_continue_handler(
      [this](const httplib::Request& request, httplib::Response& response) {
        return AdmitBody(request, response);
      });
}

// Handles responses of the library itself, and exceptions.
void HttpServer::State::SetErrorHandlers() {
  server.set_error_handler([this](const httplib::Request& request, httplib::Response& response) {
    if (response.body.empty() && response.status != 304) Apply(ProblemForStatus(response.status), response);
    if (response.has_header(kRequestIdHeader)) return;
    const std::string id = RandomId();
    response.set_header(kRequestIdHeader, id);
    if (owner->on_request)
      owner->on_request({id, "", request.method, request.path, "", "", response.status, 0});
  });
  server.set_exception_handler([](const httplib::Request&, httplib::Response& response, std::exception_ptr) {
    Apply(ProblemForStatus(500), response);
  });
}

bool HttpServer::State::Bind() {
  // The default socket options of the library let several processes share a port, so two services would each
  // get half of the requests.
  int bound_socket = -1;
  server.set_socket_options([&bound_socket](int socket) {
    bound_socket = socket;
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  int& port = listener.port;
  const bool bound = port == 0 ? (port = server.bind_to_any_port(listener.host)) > 0
                               : server.bind_to_port(listener.host, port);
  server.set_socket_options(nullptr);
  // The library lets only five connections wait, so the sixth of a burst would retry a second later. A second
  // call of listen increases the limit of the same socket.
  if (bound) listen(bound_socket, kBacklog);
  return bound;
}

HttpServer::HttpServer(std::unique_ptr<State> state) : state_(std::move(state)) {
  state_->owner = this;
}
HttpServer::~HttpServer() = default;

Result<std::unique_ptr<HttpServer>> HttpServer::Bind(Service& service, const Listener& listener) {
  std::unique_ptr<HttpServer> self(new HttpServer(std::make_unique<State>(service, listener)));
  State& state = *self->state_;
  state.SetLimits();
  state.SetHandlers();
  state.SetErrorHandlers();
  if (!state.Bind())
    return Error{ErrorCode::kBadUsage, "cannot listen on " + listener.host + " port " +
                                           std::to_string(listener.port) +
                                           ": address in use, or not assigned to this host"};
  return self;
}

int HttpServer::port() const {
  return state_->listener.port;
}

bool HttpServer::Run() {
  state_->server.listen_after_bind();
  state_->ended = true;
  return state_->stopping;
}

void HttpServer::Stop() {
  state_->stopping = true;
  // The library ignores a stop before it listens, so wait until it does.
  while (!state_->server.is_running() && !state_->ended)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  state_->server.stop();
}

}  // namespace facetless

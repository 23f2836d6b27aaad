// The transport: an HTTP/1.1 server in front of a Service.
//
//     auto server = HttpServer::Bind(service, {.host = "127.0.0.1", .port = 8080});
//     if (!server) return server.error();
//     server.value()->Run();  // until Stop is called
//
//  1. Bodies are read in pieces, and their size is counted after decompression, so neither chunked nor
//     compressed bodies can exceed the limit. The parts "file" and "mesh" are written to files; all other
//     parts are small.
//  2. Each connection serves one request, so the unread rest of a refused request cannot be taken for the
//     next request.
//  3. Every response has the header nosniff and its own X-Request-Id. No response contains the message of an
//     exception.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "render/base/result.h"
#include "server/service/http/service.h"

namespace facetless {

struct Listener {
  std::string host;
  int port = 0;             // 0: a free port
  bool operations = false;  // only for health and metrics, with two threads (service.h, law 6)
};

// A request that was answered. Its path excludes the query, which may contain anything.
struct ServedRequest {
  std::string id, trace_id, method, path, key, job;  // "" if there is none
  int status = 0;
  double ms = 0;
};

class HttpServer {
 public:
  // Binds the address at once. Error: kBadUsage (the address is not available).
  static Result<std::unique_ptr<HttpServer>> Bind(Service& service, const Listener& listener);
  ~HttpServer();

  int port() const;
  // Serves requests until Stop is called and all requests are answered. Returns false if the socket failed
  // before.
  bool Run();
  // Stops the server. May be called from any thread, also before Run.
  void Stop();

  // Called after each request, from many threads; may be empty. It must be set before Run.
  std::function<void(const ServedRequest&)> on_request;

 private:
  struct State;
  explicit HttpServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace facetless

// The transport: HTTP/1.1 over TCP in front of a Service.
//
//  1. Bodies are read in pieces and counted after decompression, so that neither chunked nor compressed ones
//     pass the limit; parts "file" and "mesh" go straight to files, the rest is small.
//  2. One request per connection: what a refused request leaves unread can't be taken for the next one.
//  3. Every response carries nosniff and an X-Request-Id of its own, and never what an exception said.
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
  int port = 0;             // 0: a free one
  bool operations = false;  // for health and metrics alone (service.h, law 6): two threads
};

// A request that was answered. Its path has no query, which may hold anything.
struct ServedRequest {
  std::string id, trace_id, method, path, key, job;  // "" where there is none
  int status = 0;
  double ms = 0;
};

class HttpServer {
 public:
  // Binds at once. Error: kBadUsage (the address is not to be had).
  static Result<std::unique_ptr<HttpServer>> Bind(Service& service, const Listener& listener);
  ~HttpServer();

  int port() const;
  // Serves until Stop is called and every request has been answered. False if the socket failed before that.
  bool Run();
  // May be called from another thread, also before Run.
  void Stop();

  // Called after each request, from many threads; may be empty. To be set before Run.
  std::function<void(const ServedRequest&)> on_request;

 private:
  struct State;
  explicit HttpServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace facetless

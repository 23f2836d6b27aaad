// A running `facetless serve`, and a client that can also send requests that no well-behaved client would
// send.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "server/base/temp_dir.h"

namespace facetless {

struct Reply {
  int status = 0;                              // 0: the connection was closed before a status line
  std::map<std::string, std::string> headers;  // names in lower case
  std::string body;

  nlohmann::json Json() const { return nlohmann::json::parse(body, nullptr, false); }
  // Returns the problem's type without its prefix; "" if the body is no problem document.
  std::string Problem() const;
};

// One part of a multipart body.
struct FormPart {
  std::string name, file_name, content;
};

class LiveServer {
 public:
  // Starts the server on a free port with an empty data directory. If `importer` is not empty, it goes to
  // FACETLESS_IMPORTER.
  explicit LiveServer(const std::vector<std::string>& arguments = {}, const std::string& importer = "");
  ~LiveServer();  // sends SIGKILL if the server still runs
  LiveServer(const LiveServer&) = delete;
  LiveServer& operator=(const LiveServer&) = delete;

  using Headers = std::vector<std::pair<std::string, std::string>>;
  Reply Get(const std::string& path, const Headers& headers = {}) {
    return Request("GET", path, headers, "");
  }
  Reply Request(const std::string& method, const std::string& path, const Headers& headers,
                const std::string& body);
  // These two wait for the end of the job, unless `headers` contains a Prefer header.
  Reply PostJson(const std::string& path, const nlohmann::json& json, const Headers& headers = {});
  Reply PostForm(const std::string& path, const std::vector<FormPart>& parts, const Headers& headers = {});
  // Waits for the end of a job and returns the job; null after a minute.
  nlohmann::json JobAtItsEnd(const std::string& id);
  // Sends the bytes as they are, and reads until the server closes the connection. `port` selects another
  // port of the server.
  Reply Raw(const std::string& bytes, int port = 0) { return RawInPieces({bytes}, 0, port); }
  // The same with a pause before each piece except the first.
  Reply RawInPieces(const std::vector<std::string>& pieces, double pause_s, int port = 0);

  bool Running();
  // Starts the server again, on the same data and with additional arguments. It must have ended.
  void Start(const std::vector<std::string>& more = {});
  // From the next start on, standard error is written to this file.
  void LogTo(const std::string& path) { log_ = path; }
  // Sends the signal and waits. Returns the exit code, or −1 if the server had to be killed after ten
  // seconds.
  int Stop(int signal);

  pid_t pid() const { return pid_; }
  int port() const { return port_; }
  const std::string& data() const { return data_; }

 private:
  TempDir directory_;
  std::string data_, importer_, log_;
  std::vector<std::string> command_;
  pid_t pid_ = 0;
  std::atomic<int> port_{0};  // changes with each start; clients on other threads read it for each request
};

// Returns a port of 127.0.0.1 on which no process listens now.
int FreePort();

}  // namespace facetless

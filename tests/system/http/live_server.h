// A running `facetless serve`, and a client that can also send what no well-behaved client would.
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
  int status = 0;                              // 0: the connection broke before a status line
  std::map<std::string, std::string> headers;  // names in lower case
  std::string body;

  nlohmann::json Json() const { return nlohmann::json::parse(body, nullptr, false); }
  // The problem's type without its prefix; "" if this is no problem document.
  std::string Problem() const;
};

// One part of a multipart body.
struct FormPart {
  std::string name, file_name, content;
};

class LiveServer {
 public:
  // Starts it on a free port with an empty data directory. `importer` goes to FACETLESS_IMPORTER if not
  // empty.
  explicit LiveServer(const std::vector<std::string>& arguments = {}, const std::string& importer = "");
  ~LiveServer();  // SIGKILL if it still runs
  LiveServer(const LiveServer&) = delete;
  LiveServer& operator=(const LiveServer&) = delete;

  using Headers = std::vector<std::pair<std::string, std::string>>;
  Reply Get(const std::string& path, const Headers& headers = {}) {
    return Request("GET", path, headers, "");
  }
  Reply Request(const std::string& method, const std::string& path, const Headers& headers,
                const std::string& body);
  // These two wait for the end of the job, unless `headers` has a Prefer of its own.
  Reply PostJson(const std::string& path, const nlohmann::json& json, const Headers& headers = {});
  Reply PostForm(const std::string& path, const std::vector<FormPart>& parts, const Headers& headers = {});
  // The job as it is when it has ended, or null after a minute.
  nlohmann::json JobAtItsEnd(const std::string& id);
  // Sends the bytes as they are and reads until the server closes. `port`: another one of the server's.
  Reply Raw(const std::string& bytes, int port = 0) { return RawInPieces({bytes}, 0, port); }
  // The same with a pause before each piece but the first.
  Reply RawInPieces(const std::vector<std::string>& pieces, double pause_s, int port = 0);

  bool Running();
  // Starts it again, on the same data and with more arguments; it must have ended.
  void Start(const std::vector<std::string>& more = {});
  // From the next start on, standard error goes to this file.
  void LogTo(const std::string& path) { log_ = path; }
  // Sends the signal and waits; the exit code, or −1 if it had to be killed after ten seconds.
  int Stop(int signal);

  pid_t pid() const { return pid_; }
  int port() const { return port_; }
  const std::string& data() const { return data_; }

 private:
  TempDir directory_;
  std::string data_, importer_, log_;
  std::vector<std::string> command_;
  pid_t pid_ = 0;
  std::atomic<int> port_{0};  // changes with each start; clients of other threads ask anew
};

// A port of 127.0.0.1 that nobody listens on now.
int FreePort();

}  // namespace facetless

// Fuzz target: the bytes of a connection. Request line, headers, chunks, multipart and options all go through
// the real server, over a socket. There is no importer, so jobs fail at once.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>
#include <csignal>
#include <cstdio>
#include <thread>

#include "server/service/http/http_server.h"
#include "server/service/jobs/sql_job_store.h"
#include "server/service/store/data_directory.h"
#include "server/service/store/file_store.h"
#include "tests/verify/fuzz/target.h"

namespace {

using namespace facetless;

constexpr int kPatienceSeconds = 10;

class RunningServer {
 public:
  RunningServer()
      : directory_(DataDirectory::Open(folder_.path()).value()),
        store_(FileStore::Open(*directory_, {std::uint64_t{64} << 20, 0}).value()),
        queue_(*directory_, {4, 4, 1}),
        jobs_(queue_, *store_, Settings()),
        keys_(directory_->reader()),
        access_(keys_, /*anonymous=*/true),
        service_(*store_, jobs_, access_, Limits()),
        server_(HttpServer::Bind(service_, {"127.0.0.1", 0, false}).value()),
        thread_([this] { server_->Run(); }) {}
  ~RunningServer() {
    server_->Stop();
    thread_.join();
    jobs_.Stop(0);
  }
  int port() const { return server_->port(); }

 private:
  static JobSettings Settings() {
    JobSettings settings;
    settings.workers = 1;
    settings.run.timeout_s = 1;
    return settings;
  }
  static ServiceLimits Limits() {
    ServiceLimits limits;
    limits.queue = 4;
    limits.waiters = 1;
    limits.listeners = 1;
    limits.timeout_s = 0.05;
    limits.max_upload_bytes = 1 << 20;
    return limits;
  }

  TempDir folder_ = TempDir::Create("/dev/shm").value();
  std::unique_ptr<DataDirectory> directory_;
  std::unique_ptr<FileStore> store_;
  SqlJobStore queue_;
  Jobs jobs_;
  KeyStore keys_;
  AccessControl access_;
  Service service_;
  std::unique_ptr<HttpServer> server_;
  std::thread thread_;
};

// Sends everything, shuts down its side, and reads to the end.
std::string Exchange(int port, std::string_view request) {
  const int client = socket(AF_INET, SOCK_STREAM, 0);
  const timeval patience{kPatienceSeconds, 0};
  setsockopt(client, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  Require(client >= 0 && connect(client, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  while (!request.empty()) {
    const ssize_t sent = send(client, request.data(), request.size(), MSG_NOSIGNAL);
    if (sent <= 0) break;  // the server may refuse the request and close the connection
    request.remove_prefix(static_cast<std::size_t>(sent));
  }
  shutdown(client, SHUT_WR);
  std::string answer;
  char piece[4096];
  for (ssize_t got; (got = recv(client, piece, sizeof piece, 0)) != 0;) {
    if (got < 0 && errno == EINTR) continue;  // a signal of libFuzzer's timer
    if (got < 0) {
      Require(errno == ECONNRESET);  // a timeout is a failure
      break;
    }
    answer.append(piece, static_cast<std::size_t>(got));
  }
  close(client);
  return answer;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static RunningServer server;
  const std::string answer = Exchange(server.port(), Text(data, size));
  // The answer is empty if the request was incomplete. Otherwise it has a status, which must not report an
  // exception: the only internal error is that of a job that found no importer.
  if (answer.empty()) return 0;
  const auto has = [&](const char* text) { return answer.find(text) != std::string::npos; };
  const std::string status = answer.substr(answer.find(' ') + 1, 3);
  const bool refused = status[0] == '4' || status[0] == '5';
  const bool head = Text(data, size).starts_with("HEAD ");
  const bool good = answer.starts_with("HTTP/1.") && (status != "500" || has("cannot start ")) &&
                    (!refused || head || has("application/problem+json")) && !has("/dev/shm");
  if (!good) std::fprintf(stderr, "%s\n", answer.c_str());
  Require(good);
  return 0;
}

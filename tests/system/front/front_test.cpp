// Tests nginx with docker/nginx.conf in front of the service: which requests the front must not pass on.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <memory>
#include <thread>

#include "tests/system/http/live_server.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::HasSubstr;

const char* const kNginx = "/usr/sbin/nginx";

sockaddr_in Loopback(const std::string& host, int port) {
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  inet_pton(AF_INET, host.c_str(), &address.sin_addr);
  return address;
}

// A connection from one of the addresses of the loopback network. For nginx, each address is a different
// client.
class Client {
 public:
  Client(const std::string& from, int port) : fd_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const sockaddr_in own = Loopback(from, 0), other = Loopback("127.0.0.1", port);
    const timeval patience = {30, 0};
    setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    connected_ = bind(fd_, reinterpret_cast<const sockaddr*>(&own), sizeof own) == 0 &&
                 connect(fd_, reinterpret_cast<const sockaddr*>(&other), sizeof other) == 0;
  }
  ~Client() { close(fd_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  bool connected() const { return connected_; }
  void Send(const std::string& bytes) const {
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t sent = send(fd_, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
      if (sent <= 0) return;
      done += static_cast<std::size_t>(sent);
    }
  }
  std::string ReceiveWithin(const timeval& patience) const {
    setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    return Receive();
  }
  std::string Receive() const {
    std::string answer;
    char buffer[4096];
    for (ssize_t got = 0; (got = recv(fd_, buffer, sizeof buffer, 0)) > 0;)
      answer.append(buffer, static_cast<std::size_t>(got));
    return answer;
  }

 private:
  int fd_;
  bool connected_ = false;
};

std::string Head(const std::string& method, const std::string& path, std::size_t length = 0) {
  return method + " " + path + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" +
         (method == "POST"
              ? "Content-Type: application/octet-stream\r\nContent-Length: " + std::to_string(length) + "\r\n"
              : "") +
         "\r\n";
}

class Front : public ::testing::Test {
 protected:
  void SetUp() override {
    if (access(kNginx, X_OK) != 0) GTEST_SKIP() << "nginx (Debian package nginx-light) is not installed";
    server_ = std::make_unique<LiveServer>(std::vector<std::string>{"--jobs", "1", "--queue", "4"},
                                           Program("facetless-fake-importer"));
    // Use the file that is shipped, with this test's ports and folder.
    std::string conf = ReadText(Sample("../docker/nginx.conf"));
    ASSERT_FALSE(conf.empty());
    port_ = FreePort();
    Replace(conf, "listen 8080;", "listen 127.0.0.1:" + std::to_string(port_) + ";");
    Replace(conf, "server facetless:8080;", "server 127.0.0.1:" + std::to_string(server_->port()) + ";");
    Replace(conf, "client_max_body_size 256m;", "client_max_body_size 1m;");
    while (conf.find("/tmp/nginx") != std::string::npos) Replace(conf, "/tmp/nginx", directory_.path());
    // Workers that root starts would run as a user who cannot enter this test's folder.
    if (getuid() == 0) conf = "user root;\n" + conf;
    const std::string file = WriteText(directory_.File("nginx.conf"), "daemon off;\n" + conf);
    pid_ = fork();
    if (pid_ == 0) {
      execl(kNginx, kNginx, "-p", directory_.path().c_str(), "-c", file.c_str(), nullptr);
      _exit(127);
    }
    for (int i = 0; i < 500 && !Client("127.0.0.1", port_).connected(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_TRUE(Client("127.0.0.1", port_).connected()) << "nginx did not start";
  }
  void TearDown() override {
    if (pid_ <= 0) return;
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
  }
  static int FreePort() {
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address = Loopback("127.0.0.1", 0);
    socklen_t size = sizeof address;
    bind(fd, reinterpret_cast<sockaddr*>(&address), size);
    getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size);
    close(fd);
    return ntohs(address.sin_port);
  }
  static void Replace(std::string& text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  }
  std::string Ask(const std::string& from, const std::string& request) const {
    const Client client(from, port_);
    client.Send(request);
    return client.Receive();
  }
  // A complete upload by an ordinary client.
  std::string Upload(const std::string& from) const {
    const std::string content = "ok";
    return Ask(from, Head("POST", "/v1/models?name=square.step", content.size()) + content);
  }

  TempDir directory_ = TempDir::Create().value();
  std::unique_ptr<LiveServer> server_;
  int port_ = 0;
  pid_t pid_ = 0;
};

TEST_F(Front, FiftySlowSendersDoNotHoldUpAnOrdinaryClient) {
  // Each client begins an upload that it never ends, and each has an address of its own, so that no limit of
  // connections per address applies.
  std::vector<std::unique_ptr<Client>> slow;
  for (int i = 0; i < 50; ++i) {
    slow.push_back(std::make_unique<Client>("127.0.1." + std::to_string(i + 1), port_));
    slow.back()->Send(Head("POST", "/v1/models?name=slow.step", 100'000) + "ok");
  }
  const std::string answer = Upload("127.0.0.2");
  EXPECT_THAT(answer, HasSubstr("HTTP/1.1 20"));
  EXPECT_THAT(Ask("127.0.0.2", Head("GET", "/")), HasSubstr("HTTP/1.1 200"));
  // The clients are still connected, but the service has received nothing from them. Direct requests show
  // that all of its threads are free.
  EXPECT_EQ(server_->Get("/healthz").status, 200);
  for (const auto& client : slow) client->Send("x");
}

TEST_F(Front, TheSameSendersWithoutTheFrontDoHoldItUp) {
  // This shows why the front is needed: without it, each slow client occupies one of the service's few dozen
  // threads.
  std::vector<std::unique_ptr<Client>> slow;
  for (int i = 0; i < 400; ++i) {
    const std::string address = "127.0." + std::to_string(1 + i / 200) + "." + std::to_string(i % 200 + 1);
    slow.push_back(std::make_unique<Client>(address, server_->port()));
    slow.back()->Send(Head("POST", "/v1/models?name=slow.step", 100'000) + "ok");
  }
  const Client client("127.0.0.2", server_->port());
  const timeval patience = {1, 0};
  client.Send(Head("GET", "/healthz"));
  EXPECT_EQ(client.ReceiveWithin(patience), "");
}

TEST_F(Front, OneAddressHasSixteenConnections) {
  std::vector<std::unique_ptr<Client>> slow;
  const auto add = [&] {
    slow.push_back(std::make_unique<Client>("127.0.0.3", port_));
    slow.back()->Send(Head("POST", "/v1/models?name=slow.step", 100'000) + "ok");
  };
  for (int i = 0; i < 16; ++i) add();
  // nginx counts a connection once it has read the request's head, which may take some time on a busy
  // machine. If nginx reads our request before the last client's, it refuses that client, and another client
  // must take its place.
  std::string answer;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (answer.find(" 429 ") == std::string::npos && std::chrono::steady_clock::now() < end) {
    for (const auto& client : slow) client->Send("x");  // keep the connections open: nginx closes idle ones
    answer = Ask("127.0.0.3", Head("GET", "/"));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    if (answer.find(" 200 ") != std::string::npos) add();
  }
  EXPECT_THAT(answer, HasSubstr("HTTP/1.1 429"));
  EXPECT_THAT(answer, HasSubstr("application/problem+json"));
  EXPECT_THAT(Ask("127.0.0.2", Head("GET", "/")), HasSubstr("HTTP/1.1 200"));
}

TEST_F(Front, HealthAndMetricsStayInside) {
  for (const char* path : {"/healthz", "/readyz", "/metrics"}) {
    const std::string answer = Ask("127.0.0.2", Head("GET", path));
    EXPECT_THAT(answer, HasSubstr("HTTP/1.1 404")) << path;
    EXPECT_THAT(answer, HasSubstr("application/problem+json")) << path;
  }
}

TEST_F(Front, WhatIsTooLargeNeverReachesTheService) {
  const std::string answer = Ask("127.0.0.2", Head("POST", "/v1/models?name=large.step", 2 << 20));
  EXPECT_THAT(answer, HasSubstr("HTTP/1.1 413"));
  EXPECT_THAT(answer, HasSubstr("urn:facetless:problem:payload-too-large"));
}

TEST_F(Front, AServiceThatIsGoneIsAProblemDocument) {
  server_->Stop(SIGTERM);
  const std::string answer = Ask("127.0.0.2", Head("GET", "/"));
  EXPECT_THAT(answer, HasSubstr("HTTP/1.1 503"));
  EXPECT_THAT(answer, HasSubstr("urn:facetless:problem:unavailable"));
}

}  // namespace
}  // namespace facetless

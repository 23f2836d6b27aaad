// Mutants of requests, byte by byte, against a running service. Each must get an HTTP response or a closed
// connection, and the service must answer the next client.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>

#include "tests/system/http/live_server.h"
#include "tests/unit/server/support.h"
#include "tests/verify/mutations/mutate.h"

namespace facetless {
namespace {

// Sends everything, shuts down its side, and reads to the end.
std::string Exchange(int port, const std::string& bytes) {
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const timeval patience = {20, 0};
  setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  std::string answer;
  if (connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0) {
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t sent = send(fd, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
      if (sent <= 0) break;
      done += static_cast<std::size_t>(sent);
    }
    shutdown(fd, SHUT_WR);
    char buffer[1 << 14];
    ssize_t got = 0;
    while ((got = recv(fd, buffer, sizeof buffer, 0)) > 0)
      answer.append(buffer, static_cast<std::size_t>(got));
    EXPECT_FALSE(got < 0 && errno == EAGAIN)
        << "the server neither answered nor closed the connection within twenty seconds";
  }
  close(fd);
  return answer;
}

TEST(Requests, MutatedGetAnAnswerOrAnEnd) {
  LiveServer server({"--max-upload", "1"}, Program("facetless-fake-importer"));
  const std::string form =
      "--b\r\nContent-Disposition: form-data; name=\"file\"; filename=\"a.step\"\r\nContent-Type: "
      "application/octet-stream"
      "\r\n\r\nok\r\n--b\r\nContent-Disposition: form-data; "
      "name=\"options\"\r\n\r\n{\"views\":[\"iso\"]}\r\n--b--\r\n";
  const std::string json = R"({"model":"0123456789abcdef","views":["iso"],"size":"32x32"})";
  const std::string seeds[] = {
      "GET /v1/models/0123456789abcdef?x=%41&y=z HTTP/1.1\r\nHost: a\r\nRange: "
      "bytes=0-1,5-\r\nAccept-Encoding: gzip\r\n\r\n",
      "GET / HTTP/1.1\r\nHost: a\r\nIf-None-Match: \"x\"\r\nConnection: close\r\n\r\n",
      "POST /v1/models HTTP/1.1\r\nHost: a\r\nContent-Type: multipart/form-data; "
      "boundary=b\r\nContent-Length: " +
          std::to_string(form.size()) + "\r\n\r\n" + form,
      "POST /v1/render HTTP/1.1\r\nHost: a\r\nContent-Type: application/json\r\nContent-Length: " +
          std::to_string(json.size()) + "\r\n\r\n" + json,
      "POST /v1/models?name=a.step HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\nContent-Type: "
      "application/octet-stream\r\n\r\n2\r\nok\r\n0\r\n\r\n"};
  constexpr std::uint64_t kSeed = 20261122;
  for (std::uint64_t index = 0; index < 100; ++index) {
    for (std::size_t i = 0; i < std::size(seeds); ++i) {
      const Mutant mutant = MakeMutant(seeds[i], kSeed, index);
      const std::string answer = Exchange(server.port(), mutant.bytes);
      EXPECT_TRUE(answer.empty() || answer.starts_with("HTTP/1.1 "))
          << "seed " << kSeed << ", request " << i << ", index " << index << ": " << mutant.what << "\n"
          << answer.substr(0, 200);
      if (answer.starts_with("HTTP/1.1 500"))
        ADD_FAILURE() << "seed " << kSeed << ", request " << i << ", index " << index << ": " << mutant.what
                      << "\n"
                      << mutant.bytes << "\n"
                      << answer.substr(0, 600);
    }
    ASSERT_TRUE(server.Running()) << "seed " << kSeed << ", index " << index;
  }
  EXPECT_EQ(server.Get("/healthz").status, 200);
}

}  // namespace
}  // namespace facetless

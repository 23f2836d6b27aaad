#include "tests/system/http/live_server.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "tests/unit/server/support.h"

namespace facetless {
namespace {

Reply Parsed(const std::string& bytes) {
  Reply reply;
  // Skip interim answers (100 Continue), which come first.
  std::size_t begin = 0;
  while (bytes.compare(begin, 12, "HTTP/1.1 100") == 0) begin = bytes.find("\r\n\r\n", begin) + 4;
  const std::size_t end = bytes.find("\r\n\r\n", begin);
  if (end == std::string::npos || bytes.size() < begin + 12) return reply;
  reply.status = std::atoi(bytes.c_str() + begin + 9);
  for (std::size_t line = bytes.find("\r\n", begin) + 2; line < end;) {
    const std::size_t next = bytes.find("\r\n", line);
    const std::size_t colon = bytes.find(':', line);
    std::string name = bytes.substr(line, colon - line);
    for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    reply.headers[name] = bytes.substr(colon + 2, next - colon - 2);
    line = next + 2;
  }
  reply.body = bytes.substr(end + 4);
  return reply;
}

LiveServer::Headers WithWait(LiveServer::Headers headers, const std::string& content_type) {
  const bool given = std::any_of(headers.begin(), headers.end(),
                                 [](const auto& header) { return header.first == "Prefer"; });
  if (!given) headers.emplace_back("Prefer", "wait=300");
  headers.emplace_back("Content-Type", content_type);
  return headers;
}

}  // namespace

std::string Reply::Problem() const {
  const auto type = headers.find("content-type");
  if (type == headers.end() || type->second != "application/problem+json") return "";
  const nlohmann::json json = Json();
  if (!json.is_object() || json.value("status", 0) != status || !json.contains("title") ||
      !json.contains("detail"))
    return "";
  const std::string prefix = "urn:facetless:problem:";
  const std::string name = json.value("type", "");
  return name.starts_with(prefix) ? name.substr(prefix.size()) : "";
}

LiveServer::LiveServer(const std::vector<std::string>& arguments, const std::string& importer)
    : directory_(TempDir::Create().value()), data_(directory_.File("data")), importer_(importer) {
  command_ = {Program("facetless"), "serve", "--data", data_};
  if (std::find(arguments.begin(), arguments.end(), "--listen") == arguments.end())
    command_.insert(command_.end(), {"--listen", "127.0.0.1:0"});
  command_.insert(command_.end(), arguments.begin(), arguments.end());
  Start();
}

void LiveServer::Start(const std::vector<std::string>& more) {
  command_.insert(command_.end(), more.begin(), more.end());
  std::vector<char*> argv;
  for (std::string& word : command_) argv.push_back(word.data());
  argv.push_back(nullptr);
  int out[2];
  if (pipe(out) != 0) return;
  if (!importer_.empty()) setenv("FACETLESS_IMPORTER", importer_.c_str(), 1);
  pid_ = fork();
  if (pid_ == 0) {
    dup2(out[1], 1);
    if (!log_.empty()) dup2(open(log_.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600), 2);
    close(out[0]);
    execv(argv[0], argv.data());
    _exit(127);
  }
  unsetenv("FACETLESS_IMPORTER");
  close(out[1]);
  // The first line is the server's address.
  std::string line;
  for (char c = 0; read(out[0], &c, 1) == 1 && c != '\n';) line += c;
  close(out[0]);
  port_ = std::atoi(line.c_str() + line.rfind(':') + 1);
  EXPECT_GT(port_, 0) << "the server did not start: " << line;
}

LiveServer::~LiveServer() {
  if (pid_ <= 0) return;
  const bool running = Running();
  EXPECT_TRUE(running) << "the server ended unexpectedly";
  if (running) Stop(SIGKILL);
}

bool LiveServer::Running() {
  return pid_ > 0 && waitpid(pid_, nullptr, WNOHANG) == 0;
}

int LiveServer::Stop(int signal) {
  kill(pid_, signal);
  int status = 0;
  for (int i = 0; i < 1000; ++i) {
    if (waitpid(pid_, &status, WNOHANG) == pid_) {
      pid_ = 0;
      return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  kill(pid_, SIGKILL);
  waitpid(pid_, &status, 0);
  pid_ = 0;
  return -1;
}

Reply LiveServer::RawInPieces(const std::vector<std::string>& pieces, double pause_s, int port) {
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port > 0 ? port : port_.load()));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::string reply;
  if (connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0) {
    for (const std::string& bytes : pieces) {
      if (&bytes != &pieces.front()) std::this_thread::sleep_for(std::chrono::duration<double>(pause_s));
      for (std::size_t done = 0; done < bytes.size();) {
        const ssize_t sent = send(fd, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
        if (sent <= 0) break;
        done += static_cast<std::size_t>(sent);
      }
    }
    char buffer[1 << 16];
    for (ssize_t got = 0; (got = recv(fd, buffer, sizeof buffer, 0)) > 0;)
      reply.append(buffer, static_cast<std::size_t>(got));
  }
  close(fd);
  return Parsed(reply);
}

Reply LiveServer::Request(const std::string& method, const std::string& path, const Headers& headers,
                          const std::string& body) {
  std::string bytes = method + " " + path + " HTTP/1.1\r\nHost: localhost\r\n";
  for (const auto& [name, value] : headers) bytes += name + ": " + value + "\r\n";
  if (method == "POST" || !body.empty()) bytes += "Content-Length: " + std::to_string(body.size()) + "\r\n";
  return Raw(bytes + "\r\n" + body);
}

nlohmann::json LiveServer::JobAtItsEnd(const std::string& id) {
  for (int i = 0; i < 1200; ++i) {
    const nlohmann::json job = Get("/v1/jobs/" + id).Json();
    const std::string state = job.is_object() ? job.value("state", "") : "";
    if (state == "done" || state == "failed" || state == "cancelled") return job;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return nullptr;
}

Reply LiveServer::PostJson(const std::string& path, const nlohmann::json& json, const Headers& headers) {
  return Request("POST", path, WithWait(headers, "application/json"), json.dump());
}

Reply LiveServer::PostForm(const std::string& path, const std::vector<FormPart>& parts,
                           const Headers& headers) {
  const std::string boundary = "facetless-test-boundary";
  std::string body;
  for (const FormPart& part : parts) {
    body += "--" + boundary + "\r\nContent-Disposition: form-data; name=\"" + part.name + "\"";
    if (!part.file_name.empty())
      body += "; filename=\"" + part.file_name + "\"\r\nContent-Type: application/octet-stream";
    body += "\r\n\r\n" + part.content + "\r\n";
  }
  body += "--" + boundary + "--\r\n";
  return Request("POST", path, WithWait(headers, "multipart/form-data; boundary=" + boundary), body);
}

int FreePort() {
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  const bool bound = bind(fd, reinterpret_cast<sockaddr*>(&address), size) == 0 &&
                     getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  close(fd);
  return bound ? ntohs(address.sin_port) : 0;
}

}  // namespace facetless

#include "tests/verify/mutations/judge.h"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>

#include "render/baseline/mesh_file.h"
#include "render/model/model_file.h"
#include "server/base/temp_dir.h"
#include "server/importer/import_process.h"
#include "tests/verify/mutations/mutate.h"

namespace facetless {
namespace {

using Clock = std::chrono::steady_clock;

// A sentence for a person must not be longer.
constexpr std::size_t kLongestMessage = 4096;

double MillisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

std::string Read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void Write(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

// Returns what is wrong with an error as an answer.
std::string OffenceOf(const Error& error) {
  if (error.code == ErrorCode::kInternal) return "an internal error";
  if (error.message.empty()) return "an error without a sentence";
  if (error.message.size() > kLongestMessage)
    return "a message of " + std::to_string(error.message.size()) + " bytes";
  return "";
}

Verdict VerdictOf(const Error& error, Clock::time_point start) {
  return {ErrorCodeName(error.code), error.message, OffenceOf(error), MillisecondsSince(start)};
}

// Returns the resident bytes of a process; 0 if they cannot be read.
std::uint64_t ResidentBytes(int pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/statm");
  std::uint64_t total = 0, resident = 0;
  file >> total >> resident;
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

// Sends the request, and receives until the other side closes or the time is over.
std::string Exchange(const std::string& host, int port, const std::string& request, double seconds) {
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  inet_pton(AF_INET, host.c_str(), &address.sin_addr);
  timeval patience = {static_cast<time_t>(seconds), 0};
  setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
  std::string answer;
  if (connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0) {
    for (std::size_t done = 0; done < request.size();) {
      const ssize_t sent = send(fd, request.data() + done, request.size() - done, MSG_NOSIGNAL);
      if (sent <= 0) break;
      done += static_cast<std::size_t>(sent);
    }
    char buffer[1 << 16];
    for (ssize_t got = 0; (got = recv(fd, buffer, sizeof buffer, 0)) > 0;)
      answer.append(buffer, static_cast<std::size_t>(got));
  }
  close(fd);
  return answer;
}

}  // namespace

Verdict JudgeImport(const std::string& path, const JudgeLimits& limits) {
  const auto start = Clock::now();
  try {
    ImportRequest request;
    request.input = path;
    request.meshes = {{.deflection = 1e-2}};
    request.limits.timeout_s = limits.timeout_s;
    request.limits.memory_mb = limits.memory_mb;
    auto files = RunImporter(request);
    if (!files) return VerdictOf(files.error(), start);
    Verdict verdict{"ok", "", "", MillisecondsSince(start)};
    if (auto model = ReadModel(files.value().model_path); !model)
      verdict.offence = "a model that can't be read: " + model.error().message;
    // If no face of a model can be meshed, its mesh is empty, and the answer must say so.
    if (auto mesh = LoadMesh(files.value().mesh_paths[0], {}, nullptr);
        !mesh && mesh.error().code != ErrorCode::kNothingUsable)
      verdict.offence = "a mesh that can't be read: " + mesh.error().message;
    return verdict;
  } catch (const std::exception& exception) {
    return {"exception", exception.what(), "an exception", MillisecondsSince(start)};
  }
}

Verdict JudgeMesh(const std::string& path) {
  const auto start = Clock::now();
  try {
    MeshLoadOptions options;
    options.max_memory_bytes = std::uint64_t{1} << 30;
    auto mesh = LoadMesh(path, options, nullptr);
    if (!mesh) return VerdictOf(mesh.error(), start);
    return {"ok", "", "", MillisecondsSince(start)};
  } catch (const std::exception& exception) {
    return {"exception", exception.what(), "an exception", MillisecondsSince(start)};
  }
}

Verdict JudgeFile(const std::string& path, const JudgeLimits& limits) {
  const std::string extension = std::filesystem::path(path).extension();
  return extension == ".glb" || extension == ".stl" ? JudgeMesh(path) : JudgeImport(path, limits);
}

// A service that stops a job at its limit answers a little later.
constexpr double kAnswerSeconds = 10;

Verdict JudgePost(const std::string& host, int port, const std::string& file_name, const std::string& bytes,
                  const std::string& options, const JudgeLimits& limits) {
  const auto start = Clock::now();
  const std::string boundary = "facetless-mutation-boundary";
  const auto part = [&](const std::string& disposition, const std::string& content) {
    return "--" + boundary + "\r\nContent-Disposition: form-data; " + disposition +
           "\r\nContent-Type: application/octet-stream\r\n\r\n" + content + "\r\n";
  };
  const std::string body = part("name=\"file\"; filename=\"" + file_name + "\"", bytes) +
                           (options.empty() ? "" : part("name=\"options\"", options)) + "--" + boundary +
                           "--\r\n";
  const std::string answer = Exchange(
      host, port,
      (options.empty() ? "POST /v1/models" : "POST /v1/comparisons") + std::string(" HTTP/1.1\r\nHost: ") +
          host + "\r\nPrefer: wait=60\r\nConnection: close\r\nContent-Type: multipart/form-data; boundary=" +
          boundary + "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body,
      limits.timeout_s + kAnswerSeconds);
  Verdict verdict;
  verdict.wall_ms = MillisecondsSince(start);
  const std::size_t head = answer.find("\r\n\r\n");
  if (!answer.starts_with("HTTP/1.1 ") || head == std::string::npos) {
    verdict.status = "none";
    verdict.offence = "no answer";
    return verdict;
  }
  verdict.status = answer.substr(9, 3);
  if (verdict.status[0] == '2') return verdict;
  const auto json = nlohmann::json::parse(answer.substr(head + 4), nullptr, false);
  const std::string type = json.is_object() ? json.value("type", "") : "";
  verdict.status += " " + type.substr(type.rfind(':') + 1);
  verdict.message = json.is_object() ? json.value("detail", "") : "";
  if (answer.find("application/problem+json") > head || verdict.message.empty()) {
    verdict.offence = "no problem document";
  } else if (verdict.status.starts_with("500")) {
    verdict.offence = "an internal error";
  }
  return verdict;
}

nlohmann::json RunMutations(const MutationRun& run) {
  const TempDir scratch = TempDir::Create().value();
  std::map<std::string, std::uint64_t> statuses;
  nlohmann::json offences = nlohmann::json::array(), crashes = nlohmann::json::array();
  nlohmann::json slowest = {{"wall_ms", 0}};
  const std::uint64_t before = ResidentBytes(run.server_pid > 0 ? run.server_pid : getpid());
  std::uint64_t mutants = 0;
  if (!run.offenders.empty()) std::filesystem::create_directories(run.offenders);
  for (const std::string& file : run.files) {
    const std::filesystem::path path = file;
    const std::string original = Read(file);
    for (std::uint64_t index = run.first; index < run.first + run.count; ++index, ++mutants) {
      const Mutant mutant = MakeMutant(original, run.seed, index);
      const std::string name = path.stem().string() + "-" + std::to_string(run.seed) + "-" +
                               std::to_string(index) + path.extension().string();
      // The file is written before the test, so that it remains if this process crashes.
      const std::string at = (run.offenders.empty() ? scratch.path() : run.offenders) + "/" + name;
      Write(at, mutant.bytes);
      const Verdict verdict =
          run.host.empty() ? JudgeFile(at, run.limits)
                           : JudgePost(run.host, run.port, name, mutant.bytes, run.options, run.limits);
      ++statuses[verdict.status];
      const nlohmann::json record = {{"file", file},
                                     {"seed", run.seed},
                                     {"index", index},
                                     {"what", mutant.what},
                                     {"status", verdict.status},
                                     {"message", verdict.message},
                                     {"offence", verdict.offence},
                                     {"wall_ms", verdict.wall_ms}};
      const bool crashed =
          verdict.status.ends_with("importer-crashed") || verdict.status.ends_with("limit-exceeded");
      if (!verdict.offence.empty()) offences.push_back(record);
      if (crashed) crashes.push_back(record);
      if (verdict.wall_ms > slowest["wall_ms"]) slowest = record;
      if (verdict.offence.empty() && !crashed) std::filesystem::remove(at);
    }
  }
  nlohmann::json report = {{"mutants", mutants},   {"seed", run.seed},     {"statuses", statuses},
                           {"offences", offences}, {"contained", crashes}, {"slowest", slowest}};
  report["resident_bytes"] = {{"of", run.server_pid > 0 ? "service" : "this process"},
                              {"before", before},
                              {"after", ResidentBytes(run.server_pid > 0 ? run.server_pid : getpid())}};
  return report;
}

}  // namespace facetless

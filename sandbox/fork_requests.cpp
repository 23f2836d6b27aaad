#include "sandbox/fork_requests.h"

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

namespace facetless {
namespace {

using Json = nlohmann::json;

// The largest request. Its paths and arguments are a few kilobytes.
constexpr std::size_t kMaxRequest = std::size_t{128} << 10;
constexpr std::size_t kStreams = 4;

// ---- The text of a request ----

Json LimitsJson(const ChildLimits& limits) {
  return {limits.memory_bytes, limits.cpu_seconds, limits.file_bytes, limits.open_files, limits.threads};
}

// The parent watches the other limits.
ChildLimits LimitsFromJson(const Json& json) {
  ChildLimits limits;
  limits.memory_bytes = json.at(0);
  limits.cpu_seconds = json.at(1);
  limits.file_bytes = json.at(2);
  limits.open_files = json.at(3);
  limits.threads = json.at(4);
  return limits;
}

// CBOR keeps paths of any bytes.
std::vector<std::uint8_t> RequestBytes(const ForkRequest& request) {
  const Confinement& confinement = request.confinement;
  Json filter = Json::array();
  for (const sock_filter& step : confinement.syscall_filter)
    filter.push_back({step.code, step.jt, step.jf, step.k});
  const FileAccess& files = confinement.file_access;
  const Json json = {{"arguments", request.arguments},
                     {"environment", request.environment},
                     {"directory", confinement.working_directory},
                     {"limits", LimitsJson(confinement.limits)},
                     {"filter", std::move(filter)},
                     {"files", {files.readable, files.runnable, files.writable, files.opened}},
                     {"tasks_before", confinement.tasks_before},
                     {"parent", confinement.parent}};
  return Json::to_cbor(json);
}

ForkRequest RequestFromBytes(const char* bytes, std::size_t size) {
  const Json json = Json::from_cbor(bytes, bytes + size);
  ForkRequest request;
  request.arguments = json.at("arguments").get<std::vector<std::string>>();
  request.environment = json.at("environment").get<std::vector<std::string>>();
  Confinement& confinement = request.confinement;
  confinement.working_directory = json.at("directory").get<std::string>();
  confinement.limits = LimitsFromJson(json.at("limits"));
  for (const Json& step : json.at("filter"))
    confinement.syscall_filter.push_back({step.at(0).get<std::uint16_t>(), step.at(1).get<std::uint8_t>(),
                                          step.at(2).get<std::uint8_t>(), step.at(3).get<std::uint32_t>()});
  const auto paths = [&](std::size_t i) { return json.at("files").at(i).get<std::vector<std::string>>(); };
  confinement.file_access = {paths(0), paths(1), paths(2), paths(3)};
  confinement.tasks_before = json.at("tasks_before").get<std::uint64_t>();
  confinement.parent = json.at("parent").get<pid_t>();
  return request;
}

// ---- Messages with descriptors ----

union Control {
  cmsghdr header;
  char bytes[CMSG_SPACE(kStreams * sizeof(int))];
};

struct Received {
  std::size_t size = 0;
  int streams[kStreams] = {-1, -1, -1, -1};
  bool whole = false;  // the message was not cut off, and has all descriptors
};

// Receives a message into `buffer`. False at the end of the stream.
bool Receive(int socket, std::vector<char>& buffer, Received& received) {
  iovec data = {buffer.data(), buffer.size()};
  Control control = {};
  msghdr message = {};
  message.msg_iov = &data;
  message.msg_iovlen = 1;
  message.msg_control = &control;
  message.msg_controllen = sizeof control;
  ssize_t got = -1;
  do got = recvmsg(socket, &message, MSG_CMSG_CLOEXEC);
  while (got < 0 && errno == EINTR);
  if (got <= 0) return false;
  received.size = static_cast<std::size_t>(got);
  const cmsghdr* header = CMSG_FIRSTHDR(&message);
  const bool has_streams = header != nullptr && header->cmsg_level == SOL_SOCKET &&
                           header->cmsg_type == SCM_RIGHTS &&
                           header->cmsg_len == CMSG_LEN(sizeof received.streams);
  if (has_streams) std::memcpy(received.streams, CMSG_DATA(header), sizeof received.streams);
  received.whole = has_streams && (message.msg_flags & (MSG_TRUNC | MSG_CTRUNC)) == 0;
  return true;
}

// ---- Forking ----

bool HasOneThread() {
  struct stat info = {};
  // The directory has a link for itself, one for its name, and one for each thread.
  return stat("/proc/self/task", &info) == 0 && info.st_nlink == 3;
}

// Forks a child of this process's own parent. Like fork, it keeps what the C library knows of the thread's id up
// to date, for which it asks the kernel where that is. It does not use clone3, which containers often forbid.
pid_t ForkSibling() {
  long flags = CLONE_PARENT | SIGCHLD;
  std::uint64_t own_id = 0;
  if (prctl(PR_GET_TID_ADDRESS, &own_id, 0, 0, 0) == 0) flags |= CLONE_CHILD_SETTID | CLONE_CHILD_CLEARTID;
  // The last two arguments are the address of the id and the thread's storage, which stays as it is. Their order
  // depends on the processor.
  return static_cast<pid_t>(syscall(SYS_clone, flags, 0, 0, own_id, own_id));
}

// In the child: becomes what the request asks for, and returns its arguments.
std::vector<std::string> BecomeRequested(const std::vector<char>& buffer, const Received& received) {
  const auto& [in, out, error, report] = received.streams;
  const pid_t self = getpid();
  if (write(report, &self, sizeof self) != sizeof self) _exit(127);
  ForkRequest request;
  try {
    request = RequestFromBytes(buffer.data(), received.size);
  } catch (const Json::exception&) {
    errno = EBADMSG;
    EndUnconfined(report);
  }
  clearenv();
  for (const std::string& variable : request.environment) {
    const std::size_t equals = variable.find('=');
    if (equals != std::string::npos)
      setenv(variable.substr(0, equals).c_str(), variable.c_str() + equals + 1, 1);
  }
  ConfineChild(request.confinement, {in, out, error, report});
  close(kReportDescriptor);
  return std::move(request.arguments);
}

}  // namespace

bool SendForkRequest(int socket, const ForkRequest& request, const ChildStreams& streams) {
  std::vector<std::uint8_t> bytes = RequestBytes(request);
  if (bytes.size() > kMaxRequest) return false;
  iovec data = {bytes.data(), bytes.size()};
  const int descriptors[kStreams] = {streams.in, streams.out, streams.error, streams.report};
  Control control = {};
  msghdr message = {};
  message.msg_iov = &data;
  message.msg_iovlen = 1;
  message.msg_control = &control;
  message.msg_controllen = sizeof control;
  cmsghdr* header = CMSG_FIRSTHDR(&message);
  header->cmsg_level = SOL_SOCKET;
  header->cmsg_type = SCM_RIGHTS;
  header->cmsg_len = CMSG_LEN(sizeof descriptors);
  std::memcpy(CMSG_DATA(header), descriptors, sizeof descriptors);
  ssize_t sent = -1;
  do sent = sendmsg(socket, &message, MSG_NOSIGNAL);
  while (sent < 0 && errno == EINTR);
  return sent == static_cast<ssize_t>(bytes.size());
}

int ServeForkRequests(int socket, const std::function<int(const std::vector<std::string>& arguments)>& run) {
  if (fcntl(socket, F_SETFD, FD_CLOEXEC) != 0 || write(socket, &kForkServerReady, 1) != 1) return 1;
  std::vector<char> buffer(kMaxRequest);
  for (Received received; Receive(socket, buffer, received); received = {}) {
    // The parent takes a request as refused when all copies of its `report` are closed.
    if (received.whole && HasOneThread() && ForkSibling() == 0) return run(BecomeRequested(buffer, received));
    for (const int stream : received.streams)
      if (stream >= 0) close(stream);
  }
  return 0;
}

}  // namespace facetless

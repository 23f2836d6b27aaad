// An importer that has loaded its libraries once and forks a child for each file (sandbox/fork_requests.h).
//
//     ForkServer server(ImporterForkServer());
//     request.fork_server = &server;   // RunImporter
//
//  1. The process is started in the background, by a thread that lives as long as the ForkServer: the process and
//     its children die with that thread, and so with the caller's process.
//  2. A process that ends is replaced, at most once a second. One that never becomes ready is given up after three
//     attempts. While there is none, Start returns nothing, and the caller starts the program itself.
//  3. Children are children of the caller's process. They do not end with the process that forked them.
//  4. The functions may be called from many threads.
#pragma once

#include <sys/types.h>

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "sandbox/fork_requests.h"
#include "server/importer/descriptor.h"

namespace facetless {

struct ForkServerSettings {
  std::string program;                   // path; it gets the argument kServeForks
  std::vector<std::string> environment;  // NAME=value
  double answer_seconds = 5;             // a process that has not forked after this time is replaced
  // Called on the thread of the ForkServer with a sentence for the log. May be empty.
  std::function<void(const std::string& sentence)> log;
};

class ForkServer {
 public:
  explicit ForkServer(ForkServerSettings settings);
  // Ends the process.
  ~ForkServer();
  ForkServer(const ForkServer&) = delete;
  ForkServer& operator=(const ForkServer&) = delete;

  const std::string& program() const { return settings_.program; }
  // Forks a child with the given standard streams. `report` receives the end of a pipe that is closed when the
  // child runs, or has errno if it cannot be confined. Nothing if there is no process, or if it does not answer.
  std::optional<pid_t> Start(const ForkRequest& request, const ChildStreams& streams, Descriptor& report);
  // Waits until there is a process, and returns its id; 0 if there is none after so many seconds.
  pid_t WaitForProcess(double seconds);

 private:
  void Run();
  bool Launch();
  bool BecomesReady();
  // Returns when the process has ended or is to be replaced, or at the end of the ForkServer; then it reaps it.
  void WatchToItsEnd();
  bool PauseUnlessStopping(double seconds);
  void Log(const std::string& sentence) const;

  const ForkServerSettings settings_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false, replacing_ = false;
  pid_t ready_ = 0;    // the process, once it is ready
  pid_t process_ = 0;  // only the thread below uses it
  // To the process. A shared pointer, so that a caller that sends is not cut off by a replacement.
  std::shared_ptr<Descriptor> socket_;
  Pipe wake_;  // wakes the thread
  std::thread thread_;
};

}  // namespace facetless

// A process that has prepared itself forks a confined child for each request, which saves the child the time of
// linking and initialisation.
//
//     // The process that forks (facetless-import --serve-forks):
//     Prepare();
//     return ServeForkRequests(kForkSocket, [](const std::vector<std::string>& arguments) { return Run(arguments); });
//
//     // The process that asks:
//     SendForkRequest(socket, request, streams);
//     pid_t child;  // read from the other end of streams.report, then errno if the child could not be confined
//
//  1. The child is a child of the process that asks, not of the one that forks (CLONE_PARENT). The one that asks
//     waits for it and kills it as any of its children, and the end of the process that forks does not affect it.
//  2. Before anything else the child writes its id to `report`. Then it is confined (confinement.h), and closes
//     `report`.
//  3. The process that forks has one thread. It reads requests into a buffer of a fixed size, and only the child
//     examines them, so that its memory does not grow. It keeps no descriptor of a request.
//  4. The process that forks ends when the socket is closed. It dies with the process that started it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sandbox/confinement.h"

namespace facetless {

struct ForkRequest {
  std::vector<std::string> arguments;    // with the program's name
  std::vector<std::string> environment;  // NAME=value; the child has no other
  Confinement confinement;
};

// The descriptor of the socket in the process that forks: SOCK_SEQPACKET, connected.
constexpr int kForkSocket = 3;
// The argument that makes a program such a process.
constexpr char kServeForks[] = "--serve-forks";
// The process that forks writes this byte when it is ready.
constexpr char kForkServerReady = 'r';

// Sends a request. Returns false if it cannot be sent, or is too long.
bool SendForkRequest(int socket, const ForkRequest& request, const ChildStreams& streams);

// Answers requests until the socket is closed; then it returns 0. In each child it returns what `run` returns.
int ServeForkRequests(int socket, const std::function<int(const std::vector<std::string>& arguments)>& run);

}  // namespace facetless
